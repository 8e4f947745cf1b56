/// Pelorus in an application, in C++17: handles that close themselves, results instead of error codes. Header-only over the C
/// functions of <pelorus/embed.h>, so that no type of a standard library crosses into libpelorus: any compiler, with or without
/// exceptions. What is said there of threads and errors holds here; docs/embedding.md is the guide.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pelorus/embed.h>

namespace pelorus {

/// How a call ended.
class [[nodiscard]] Status {
public:
    Status() = default;
    Status(plr_status code, std::string text, std::int64_t item = -1)
        : code_(code), item_(item), text_(std::move(text)) {}
    /// Of a call that was just made.
    static Status of(plr_status code, const plr_error& error) {
        return code == PLR_OK ? Status() : Status(code, pelorus_error_text(), error.item);
    }

    bool ok() const noexcept { return code_ == PLR_OK; }
    explicit operator bool() const noexcept { return ok(); }
    /// A plr_status or PELORUS_E_...
    plr_status code() const noexcept { return code_; }
    /// The entry of the message that is wrong, or -1.
    std::int64_t item() const noexcept { return item_; }
    /// One line, or several where a config is refused.
    const std::string& text() const noexcept { return text_; }

private:
    plr_status code_ = PLR_OK;
    std::int64_t item_ = -1;
    std::string text_;
};

/// A value, or why there is none. Look before you take it.
template <class T> class [[nodiscard]] Result {
public:
    Result(T value) : value_(std::move(value)) {}
    Result(Status failure) : status_(std::move(failure)) {}

    bool ok() const noexcept { return value_.has_value(); }
    explicit operator bool() const noexcept { return ok(); }
    const Status& status() const noexcept { return status_; }
    T& operator*() noexcept { return *value_; }
    const T& operator*() const noexcept { return *value_; }
    T* operator->() noexcept { return &*value_; }
    const T* operator->() const noexcept { return &*value_; }

private:
    Status status_;
    std::optional<T> value_;
};

namespace embed_detail {

inline plr_error new_error() noexcept {
    plr_error error{};
    error.struct_size = sizeof error;
    return error;
}

/// `function(&error)` as a Status.
template <class Function> Status status_of(Function function) {
    plr_error error = new_error();
    const plr_status code = function(&error);
    return Status::of(code, error);
}

/// The same with a struct that is filled in.
template <class Struct, class Function> Result<Struct> filled(Function function) {
    Struct out{};
    out.struct_size = sizeof out;
    Status status = status_of([&](plr_error* error) { return function(&out, error); });
    if (!status) return status;
    return out;
}

/// All structs that a function answers by index.
template <class Struct, class Function> std::vector<Struct> all(Function function) {
    std::vector<Struct> found;
    for (std::uint32_t i = 0;; ++i) {
        Result<Struct> one = filled<Struct>([&](Struct* out, plr_error* error) { return function(i, out, error); });
        if (!one) return found;
        found.push_back(*one);
    }
}

}  // namespace embed_detail

/// See pelorus_options.
struct PipelineOptions {
    std::uint32_t threads = 1;
    std::vector<std::string> plugin_folders;
    std::vector<std::pair<std::string, std::string>> overrides;  ///< address, value
    std::vector<std::pair<std::string, std::string>> variables;
    std::optional<std::uint64_t> seed;
    std::string result_folder;  ///< "" : none
};

/// One scan to be pushed: measurements of one sensor, appended one by one. Of a stream of a port, which says sensor, space and
/// frame and must live as long.
class ScanMessage {
public:
    explicit ScanMessage(const plr_stream& stream) : stream_(stream) {}

    void clear() {
        values_.clear();
        covariances_.clear();
        ids_.clear();
    }
    /// `measurement`: as many numbers as the space has components. `id`: unique among all measurements that are ever
    /// pushed. `covariance`: their square, column by column, for all measurements or for none (then the sensor model's noise
    /// holds).
    void add(std::uint64_t id, const double* measurement, const double* covariance = nullptr) {
        const std::size_t m = stream_.space->size;
        // Not insert(): GCC 12 warns of it at -O3, wrongly, and an application may treat warnings as errors.
        for (std::size_t i = 0; i < m; ++i) values_.push_back(measurement[i]);
        for (std::size_t i = 0; covariance != nullptr && i < m * m; ++i) covariances_.push_back(covariance[i]);
        ids_.push_back(id);
    }
    /// Valid until the scan changes. Times in ns; without an arrival it arrives at its time.
    const plr_message& message(std::int64_t time, std::int64_t arrival = std::numeric_limits<std::int64_t>::min()) {
        const std::int64_t m = stream_.space->size, n = static_cast<std::int64_t>(ids_.size());
        scan_ = plr_scan{};
        scan_.struct_size = sizeof scan_;
        scan_.sensor = stream_.sensor;
        scan_.frame = stream_.frame;
        scan_.space = stream_.space;
        scan_.measurements = {values_.data(), m, 1, n, 1, m, m};
        if (!covariances_.empty()) scan_.covariances = {covariances_.data(), m, m, n, 1, m, m * m};
        scan_.ids = ids_.data();
        message_ = plr_message{};
        message_.struct_size = sizeof message_;
        message_.kind = PLR_MESSAGE_SCAN;
        message_.time = time;
        message_.arrival = arrival;
        message_.body.scan = &scan_;
        return message_;
    }

private:
    plr_stream stream_;
    std::vector<double> values_, covariances_;
    std::vector<std::uint64_t> ids_;
    plr_scan scan_{};
    plr_message message_{};
};

/// Element (row, column) of an item of an array in a message.
inline double number(const plr_const_view& view, std::int64_t item, std::int64_t row,
                     std::int64_t column = 0) noexcept {
    return view.data[item * view.item_stride + column * view.col_stride + row * view.row_stride];
}

/// What an out port publishes. Belongs to its pipeline and ends with it; may be copied.
class Subscription {
public:
    explicit Subscription(pelorus_subscription* raw) noexcept : raw_(raw) {}

    /// The oldest message that waits, or nullptr; borrowed until the next pull.
    const plr_message* pull() noexcept {
        const plr_message* message = nullptr;
        pelorus_pull(raw_, &message, nullptr);
        return message;
    }
    Result<pelorus_subscription_info> state() const {
        return embed_detail::filled<pelorus_subscription_info>([&](pelorus_subscription_info* out, plr_error* error) {
            return pelorus_subscription_state(raw_, out, error);
        });
    }
    /// No copy may be used after it.
    void end() noexcept { pelorus_unsubscribe(std::exchange(raw_, nullptr)); }

private:
    pelorus_subscription* raw_;
};

class Pipeline {
public:
    static Result<Pipeline> open(const std::string& file, const PipelineOptions& options = {}) {
        return opened(options, [&](const pelorus_options* raw, pelorus_pipeline** out, plr_error* error) {
            return pelorus_open(file.c_str(), raw, out, error);
        });
    }
    /// `name` stands for the file in messages, `base` is the folder that its paths are relative to.
    static Result<Pipeline> open_text(const std::string& text, const std::string& name, const std::string& base,
                                      const PipelineOptions& options = {}) {
        return opened(options, [&](const pelorus_options* raw, pelorus_pipeline** out, plr_error* error) {
            return pelorus_open_text(text.c_str(), name.c_str(), base.c_str(), raw, out, error);
        });
    }
    Pipeline(Pipeline&& other) noexcept : raw_(std::exchange(other.raw_, nullptr)) {}
    Pipeline& operator=(Pipeline&& other) noexcept {
        if (this != &other) {
            pelorus_close(raw_);
            raw_ = std::exchange(other.raw_, nullptr);
        }
        return *this;
    }
    ~Pipeline() { pelorus_close(raw_); }

    std::vector<pelorus_node_info> nodes() const {
        return embed_detail::all<pelorus_node_info>([&](std::uint32_t i, pelorus_node_info* out, plr_error* error) {
            return pelorus_node(raw_, i, out, error);
        });
    }
    std::vector<pelorus_port_info> ports() const {
        return embed_detail::all<pelorus_port_info>([&](std::uint32_t i, pelorus_port_info* out, plr_error* error) {
            return pelorus_port(raw_, i, out, error);
        });
    }
    /// What the in port "radar.scans" takes from that sensor. Lives as long as the pipeline.
    Result<plr_stream> stream(const std::string& in_port, const std::string& sensor) const {
        for (const pelorus_port_info& port : ports()) {
            if (port.is_output || std::string(port.node) + "." + port.port != in_port) continue;
            const char* at = reinterpret_cast<const char*>(port.streams);
            for (std::uint32_t i = 0; i < port.stream_count; ++i, at += port.streams->struct_size) {
                const plr_stream& found = *reinterpret_cast<const plr_stream*>(at);
                if (found.sensor && found.space && found.frame && sensor == found.sensor) return found;
            }
        }
        return Status(PELORUS_E_NOT_FOUND, "no in port '" + in_port + "' takes scans of a sensor '" + sensor + "'");
    }

    Status push(const char* port, const plr_message& message) {
        return embed_detail::status_of([&](plr_error* error) { return pelorus_push(raw_, port, &message, error); });
    }
    Status advance(std::int64_t until) {
        return embed_detail::status_of([&](plr_error* error) { return pelorus_advance(raw_, until, error); });
    }
    Status play() {
        return embed_detail::status_of([&](plr_error* error) { return pelorus_play(raw_, error); });
    }
    /// From any thread.
    void stop() noexcept { pelorus_stop(raw_); }
    Status finish() {
        return embed_detail::status_of([&](plr_error* error) { return pelorus_finish(raw_, error); });
    }
    /// The arrival of the event handled last, ns.
    std::optional<std::int64_t> now() const {
        std::int64_t time = std::numeric_limits<std::int64_t>::min();
        pelorus_now(raw_, &time, nullptr);
        if (time == std::numeric_limits<std::int64_t>::min()) return std::nullopt;
        return time;
    }

    Result<Subscription> subscribe(const std::string& port, std::uint64_t capacity = 0,
                                   std::uint32_t when_full = PELORUS_WHEN_FULL_REFUSE) {
        const pelorus_subscription_options options{sizeof options, when_full, capacity};
        pelorus_subscription* subscription = nullptr;
        Status status = embed_detail::status_of(
            [&](plr_error* error) { return pelorus_subscribe(raw_, port.c_str(), &options, &subscription, error); });
        if (!status) return status;
        return Subscription(subscription);
    }

    std::vector<pelorus_scalar_info> scalars() const {
        return embed_detail::all<pelorus_scalar_info>([&](std::uint32_t i, pelorus_scalar_info* out, plr_error* error) {
            return pelorus_scalar(raw_, i, out, error);
        });
    }
    Result<double> scalar(const std::string& name) const {
        Result<pelorus_scalar_info> found =
            embed_detail::filled<pelorus_scalar_info>([&](pelorus_scalar_info* out, plr_error* error) {
                return pelorus_find_scalar(raw_, name.c_str(), out, error);
            });
        if (!found) return found.status();
        return found->value;
    }
    /// Borrowed until the pipeline moves on.
    std::vector<const plr_table*> tables() const {
        std::vector<const plr_table*> found;
        const plr_table* table = nullptr;
        while (pelorus_table(raw_, static_cast<std::uint32_t>(found.size()), &table, nullptr) == PLR_OK)
            found.push_back(table);
        return found;
    }
    std::vector<pelorus_diagnostic_info> diagnostics() const {
        return embed_detail::all<pelorus_diagnostic_info>(
            [&](std::uint32_t i, pelorus_diagnostic_info* out, plr_error* error) {
                return pelorus_diagnostic(raw_, i, out, error);
            });
    }

    Result<std::vector<unsigned char>> snapshot() const {
        std::vector<unsigned char> bytes;
        plr_writer writer{};
        writer.struct_size = sizeof writer;
        writer.context = &bytes;
        // noexcept: what an allocation throws here must not unwind through the library.
        writer.write = [](void* to, const void* from, std::uint64_t size, plr_error*) noexcept -> plr_status {
            const auto* first = static_cast<const unsigned char*>(from);
            auto& all = *static_cast<std::vector<unsigned char>*>(to);
            all.insert(all.end(), first, first + size);
            return PLR_OK;
        };
        Status status =
            embed_detail::status_of([&](plr_error* error) { return pelorus_snapshot(raw_, &writer, error); });
        if (!status) return status;
        return bytes;
    }
    Status restore(const std::vector<unsigned char>& bytes) {
        return embed_detail::status_of(
            [&](plr_error* error) { return pelorus_restore(raw_, bytes.data(), bytes.size(), error); });
    }

    /// For the C functions.
    pelorus_pipeline* raw() const noexcept { return raw_; }

private:
    explicit Pipeline(pelorus_pipeline* raw) noexcept : raw_(raw) {}

    template <class Open> static Result<Pipeline> opened(const PipelineOptions& options, Open open) {
        if (!pelorus_is_compatible())
            return Status(PELORUS_E_CONFIG, std::string("libpelorus ") + pelorus_version() +
                                                " does not serve an application compiled with other headers");
        std::vector<const char*> folders;
        std::vector<pelorus_setting> overrides, variables;
        for (const std::string& folder : options.plugin_folders) folders.push_back(folder.c_str());
        for (const auto& [address, value] : options.overrides) overrides.push_back({address.c_str(), value.c_str()});
        for (const auto& [name, value] : options.variables) variables.push_back({name.c_str(), value.c_str()});
        pelorus_options raw{};
        raw.struct_size = sizeof raw;
        raw.threads = options.threads;
        raw.plugin_folders = folders.data();
        raw.plugin_folder_count = static_cast<std::uint32_t>(folders.size());
        raw.overrides = overrides.data();
        raw.override_count = static_cast<std::uint32_t>(overrides.size());
        raw.variables = variables.data();
        raw.variable_count = static_cast<std::uint32_t>(variables.size());
        raw.seed = options.seed ? &*options.seed : nullptr;
        raw.result_folder = options.result_folder.empty() ? nullptr : options.result_folder.c_str();
        pelorus_pipeline* pipeline = nullptr;
        Status status = embed_detail::status_of([&](plr_error* error) { return open(&raw, &pipeline, error); });
        if (!status) return status;
        return Pipeline(pipeline);
    }

    pelorus_pipeline* raw_ = nullptr;
};

}  // namespace pelorus
