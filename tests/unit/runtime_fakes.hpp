/// Stages that live in the test itself, and a graph of them without any config.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/services.hpp"
#include "runtime/bytes.hpp"
#include "runtime/runtime.hpp"
#include "runtime/wiring.hpp"

namespace fakes {

constexpr std::int64_t second = 1'000'000'000;

/// A stage in C++. What it does not override, its table does not have either (port_type, save, load, finish), or does
/// nothing.
class Stage {
public:
    virtual ~Stage() = default;
    virtual plr_status next(const plr_call&, plr_next& out) {
        out.what = PLR_NEXT_END;
        return PLR_OK;
    }
    virtual plr_status emit(const plr_call&) { return PLR_OK; }
    virtual plr_status receive(const plr_call&, std::uint32_t, const plr_message&) { return PLR_OK; }
    virtual plr_status finish(const plr_call&) { return PLR_OK; }
    virtual void save(pelorus::runtime::ByteWriter&) const {}
    virtual void load(pelorus::runtime::ByteReader&) {}

    const plr_publish* publisher = nullptr;
    plr_status publish(const plr_call& call, std::uint32_t port, const plr_message& message) const;
};

/// Fills call.error as a plugin does.
plr_status fail(const plr_call& call, plr_status status, const char* message, const char* where = "",
                std::int64_t item = -1);

plr_space position_space(std::uint32_t size = 1);
plr_const_view view(const double* data, std::int64_t rows, std::int64_t cols, std::int64_t count);

/// A scan of `values.size()` one-dimensional measurements.
struct Scan {
    explicit Scan(std::vector<double> values, std::string sensor = "radar");
    Scan(const Scan&) = delete;
    Scan& operator=(const Scan&) = delete;
    std::string sensor;
    std::vector<double> values, variances;
    std::vector<std::uint64_t> ids;
    plr_space space;
    plr_scan body{};
    plr_message message(std::int64_t time, std::int64_t arrival = INT64_MIN) const;
};

/// One quantity named `value`.
struct Command {
    explicit Command(double value);
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;
    double number;
    plr_quantity quantity{};
    plr_values body{};
    plr_message message(std::int64_t time) const;
};

/// A table with the column `time` (key) and `error` (root mean square), and the scalar `rmse` of it.
struct Table {
    Table(const char* name, std::vector<double> rows);
    Table(const Table&) = delete;
    Table& operator=(const Table&) = delete;
    std::vector<double> rows;
    plr_column columns[2]{};
    plr_scalar scalar{};
    plr_table body{};
    plr_message message(std::int64_t time) const;
};

struct PortOf {
    const char* name;
    std::uint32_t message;
};

/// Nodes in file order, edges by name. Keeps stages and hosts alive.
class Graph {
public:
    /// The plugin's id is KIND.fake, its version `version`.
    void add(const std::string& name, const std::string& kind, std::shared_ptr<Stage> stage,
             std::vector<PortOf> in = {}, std::vector<PortOf> out = {});
    /// "world.scans" -> "tracker.scans".
    void connect(const std::string& from, const std::string& to, bool previous = false);
    pelorus::runtime::Wiring wiring() const { return wiring_; }
    pelorus::runtime::Wiring& editable() { return wiring_; }
    pelorus::host::InstanceHost& host(const std::string& name);
    std::string version = "1.0.0";

private:
    std::size_t index(const std::string& name) const;
    pelorus::runtime::Wiring wiring_;
    std::vector<std::shared_ptr<Stage>> stages_;
    std::vector<std::unique_ptr<pelorus::host::InstanceHost>> hosts_;
};

/// A source of scans at first + k x period, k = 0 .. count - 1; the stamp is `delay` before the arrival. Measurement:
/// k, or the last command that came in (port 0).
class Ticker : public Stage {
public:
    Ticker(std::int64_t period, int count, std::int64_t first = 0, std::int64_t delay = 0, std::string sensor = "radar")
        : period_(period), first_(first), delay_(delay), count_(count), sensor_(std::move(sensor)) {}
    plr_status next(const plr_call&, plr_next& out) override;
    plr_status emit(const plr_call& call) override;
    plr_status receive(const plr_call& call, std::uint32_t port, const plr_message& message) override;
    void save(pelorus::runtime::ByteWriter& writer) const override;
    void load(pelorus::runtime::ByteReader& reader) override;
    std::vector<std::string> commands;  ///< "VALUE of ARRIVAL at CALL.TIME"

private:
    std::int64_t period_, first_, delay_;
    int count_, done_ = 0;
    std::string sensor_;
    double command_ = -1;
    bool commanded_ = false;
};

/// Writes down what it receives, as "NAME PORT TIME ARRIVAL VALUE" in seconds, and runs a function.
class Recorder : public Stage {
public:
    using Reaction = std::function<plr_status(Recorder&, const plr_call&, std::uint32_t, const plr_message&)>;
    explicit Recorder(std::string name, std::vector<std::string>* log = nullptr, Reaction reaction = nullptr)
        : name_(std::move(name)), log_(log ? log : &lines), reaction_(std::move(reaction)) {}
    plr_status receive(const plr_call& call, std::uint32_t port, const plr_message& message) override;
    plr_status finish(const plr_call& call) override;
    void save(pelorus::runtime::ByteWriter& writer) const override;
    void load(pelorus::runtime::ByteReader& reader) override;
    std::vector<std::string> lines;
    bool finished = false;
    std::function<plr_status(Recorder&, const plr_call&)> at_finish;
    double sum = 0;  ///< of the first numbers of all messages

private:
    std::string name_;
    std::vector<std::string>* log_;
    Reaction reaction_;
};

/// The first number in a scan, values or table.
double first_number(const plr_message& message);

}  // namespace fakes
