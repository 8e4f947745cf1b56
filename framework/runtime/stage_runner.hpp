/// Calls one stage and takes what it publishes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/services.hpp"
#include "runtime/message_block.hpp"
#include "runtime/message_check.hpp"
#include "runtime/wiring.hpp"

namespace pelorus::runtime {

/// Scratch memory that stages use one after the other.
class Scratch {
public:
    Scratch();
    /// All of it, empty.
    plr_scratch* cleared() noexcept;

private:
    struct Free {
        void operator()(unsigned char* memory) const noexcept;
    };
    std::unique_ptr<unsigned char[], Free> memory_;
    plr_scratch scratch_{};
};

/// What a stage published in a call.
struct Publication {
    std::uint32_t port = 0;
    MessageRef message;
};

/// One stage at work. Every failing call throws Error (Exit::run_failed) whose line names the node, its plugin, the
/// call, the port and the time; an exception that escapes from a plugin becomes such an error too. Calls are not
/// reentrant.
class StageRunner final : public host::Publisher {
public:
    /// Connects the publish service. `node`, `pool` and `scratch` must outlive the runner. Throws Error when the stage
    /// lacks a function that its place in the graph needs (`receives`: an edge ends here).
    StageRunner(const Wiring::Node& node, bool receives, MessagePool& pool, Scratch& scratch);
    ~StageRunner() override;
    StageRunner(const StageRunner&) = delete;
    StageRunner& operator=(const StageRunner&) = delete;

    const Wiring::Node& node() const noexcept { return node_; }
    bool is_source() const noexcept { return is_source_; }
    bool is_sink() const noexcept { return node_.kind == "sink"; }

    /// What a source says comes next; `now` is the arrival handled last.
    plr_next next(std::int64_t now);
    void emit(std::int64_t arrival);
    /// False: the stage refused the message (PLR_E_DATA); that is counted and logged, and what it published meanwhile
    /// is dropped.
    bool receive(std::int64_t arrival, std::uint32_t port, const plr_message& message);
    void finish(std::int64_t arrival);
    /// Nothing when the stage has no state to save.
    std::optional<std::vector<unsigned char>> save();
    void load(const std::vector<unsigned char>& state);

    /// What the last call published, in order. The caller empties it.
    std::vector<Publication>& outbox() noexcept { return outbox_; }
    /// An error of this node in words: "node tracker (tracker.point_target), WHAT: TEXT".
    Error error(const std::string& what, const std::string& text) const;

    std::uint64_t calls() const noexcept { return calls_; }
    double seconds() const noexcept { return seconds_; }
    double longest_seconds() const noexcept { return longest_seconds_; }

private:
    plr_status publish(std::uint32_t port, const plr_message& message, plr_error* error) override;
    MessageRef take(std::uint32_t port, const plr_message& message);
    template <class Function>
    plr_status guarded(const char* name, std::int64_t time, bool publishes, Function function,
                       const char* port = nullptr);
    void expect_ok(plr_status status, const std::string& what) const;
    std::string told(plr_status status) const;
    void count_refusal() const;
    void log_refusal(const std::string& line);

    const Wiring::Node& node_;
    MessagePool& pool_;
    Scratch& scratch_;
    plr_stage stage_{};
    bool is_source_ = false;
    CheckMemory check_memory_;
    plr_error error_{};
    std::vector<Publication> outbox_;
    bool publishing_ = false;          // within emit, receive or finish
    std::int64_t arrival_ = 0;         // of the event that is handled
    std::string refused_publication_;  // of the call under way
    std::string fault_;                // what the guard has found in the node's models during it, or ""
    std::uint64_t refused_ = 0;
    std::uint64_t calls_ = 0;
    double seconds_ = 0, longest_seconds_ = 0;
};

}  // namespace pelorus::runtime
