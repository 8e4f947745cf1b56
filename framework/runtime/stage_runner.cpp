#include "runtime/stage_runner.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "host/breadcrumb.hpp"
#include "host/kinds.hpp"
#include "host/plugin_error.hpp"
#include "host/scratch.hpp"
#include "runtime/message_copy.hpp"
#include "runtime/time_text.hpp"

namespace pelorus::runtime {
namespace {

constexpr std::uint64_t logged_refusals = 10;  // a broken sensor must not fill the log; all are counted

plr_status append(void* context, const void* bytes, std::uint64_t size, plr_error* error) {
    return host::answer(error, [&](plr_error&) {
        auto& state = *static_cast<std::vector<unsigned char>*>(context);
        const auto* first = static_cast<const unsigned char*>(bytes);
        if (size) state.insert(state.end(), first, first + size);
        return PLR_OK;
    });
}

}  // namespace

Scratch::Scratch() : memory_(static_cast<unsigned char*>(::operator new (host::scratch_bytes, std::align_val_t{64}))) {}

void Scratch::Free::operator()(unsigned char* memory) const noexcept {
    ::operator delete (memory, std::align_val_t{64});
}

plr_scratch* Scratch::cleared() noexcept {
    scratch_ = {memory_.get(), host::scratch_bytes, 0};
    return &scratch_;
}

StageRunner::StageRunner(const Wiring::Node& node, bool receives, MessagePool& pool, Scratch& scratch)
    : node_(node),
      pool_(pool),
      scratch_(scratch),
      stage_(stage_functions(node.instance)),
      is_source_(node.kind == "source") {
    if (is_source_ && !(stage_.next && stage_.emit))
        throw error("setting up", "a source needs the functions next and emit");
    if (receives && !stage_.receive)
        throw error("setting up", "an edge ends here, but the stage has no function receive");
    node_.host->connect(this);
}

StageRunner::~StageRunner() { node_.host->connect(nullptr); }

template <class Function>
plr_status StageRunner::guarded(const char* name, std::int64_t time, bool publishes, Function function,
                                const char* port) {
    error_.struct_size = sizeof error_;
    error_.code = PLR_OK;
    error_.item = -1;
    error_.where[0] = error_.message[0] = '\0';
    plr_call call{};
    call.struct_size = sizeof call;
    call.time = time;
    call.scratch = scratch_.cleared();
    call.error = &error_;
    call.log = node_.host->log();
    outbox_.clear();
    refused_publication_.clear();
    fault_.clear();
    publishing_ = publishes;
    arrival_ = time;
    const host::Breadcrumb crumb({node_.name.c_str(), node_.plugin.c_str(), name, port, time, true});
    const auto start = std::chrono::steady_clock::now();
    plr_status status = host::guarded(error_, [&] { return function(call); });
    const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    seconds_ += taken;
    longest_seconds_ = std::max(longest_seconds_, taken);
    ++calls_;
    publishing_ = false;
    if (status == PLR_OK && !refused_publication_.empty()) {
        // A stage that goes on as if a refused message had been sent would let it vanish.
        error_.code = PLR_OK;
        status = host::tell(&error_, PLR_E_ARGUMENT, refused_publication_);
    }
    if (const host::FaultLatch* faults = node_.host->faults(); faults != nullptr && faults->is_set()) {
        // Whatever the stage made of it: what a model that breaks its contract answers is not worth going on with.
        fault_ = faults->line();
        status = PLR_E_PART;
    } else if (status > PLR_ITEMS_FAILED || status < PLR_E_EXCEPTION) {
        fault_ = fmt::format("answered status {}, expected PLR_OK or PLR_E_... (0 or {} to {})", status,
                             static_cast<int>(PLR_E_ARGUMENT), static_cast<int>(PLR_E_EXCEPTION));
    }
    if (status != PLR_OK) outbox_.clear();
    return status;
}

std::string StageRunner::told(plr_status status) const {
    if (!fault_.empty()) return fault_;
    const std::string text = host::error_text(status, error_);
    return error_.item >= 0 ? fmt::format("{} (item {})", text, error_.item) : text;
}

Error StageRunner::error(const std::string& what, const std::string& text) const {
    return {Exit::run_failed, fmt::format("node {} ({}), {}: {}", node_.name, node_.plugin, what, text)};
}

void StageRunner::expect_ok(plr_status status, const std::string& what) const {
    if (status != PLR_OK) throw error(what, told(status));
}

plr_next StageRunner::next(std::int64_t now) {
    plr_next answer{};
    answer.struct_size = sizeof answer;
    const plr_status status = guarded(
        "next", now, false, [&](const plr_call& call) { return stage_.next(node_.instance.self, &call, &answer); });
    if (status != PLR_OK) expect_ok(status, "next at " + seconds_text(now));
    if (answer.what < PLR_NEXT_DATA || answer.what > PLR_NEXT_END)
        throw error("next at " + seconds_text(now), fmt::format("answered {}, expected PLR_NEXT_DATA, PLR_NEXT_WAIT or "
                                                                "PLR_NEXT_END (1 to 3)",
                                                                answer.what));
    return answer;
}

void StageRunner::emit(std::int64_t arrival) {
    const plr_status status =
        guarded("emit", arrival, true, [&](const plr_call& call) { return stage_.emit(node_.instance.self, &call); });
    if (status != PLR_OK) expect_ok(status, "emit at " + seconds_text(arrival));
}

bool StageRunner::receive(std::int64_t arrival, std::uint32_t port, const plr_message& message) {
    const plr_status status = guarded(
        "receive", arrival, true,
        [&](const plr_call& call) { return stage_.receive(node_.instance.self, &call, port, &message); },
        node_.in_ports[port].name.c_str());
    if (status == PLR_OK) return true;
    const std::string what = fmt::format("receive {} at {}", node_.in_ports[port].name, seconds_text(arrival));
    if (status != PLR_E_DATA) expect_ok(status, what);
    log_refusal(fmt::format("refused a message: {}: {}", what, told(status)));
    return false;
}

void StageRunner::log_refusal(const std::string& line) {
    count_refusal();
    const plr_log* log = node_.host->log();
    if (++refused_ > logged_refusals || log->level > PLR_LOG_WARNING) return;
    log->write(log->context, PLR_LOG_WARNING, line.c_str());
    if (refused_ == logged_refusals)
        log->write(log->context, PLR_LOG_WARNING, "further refused messages are only counted (counter `refused`)");
}

void StageRunner::finish(std::int64_t arrival) {
    if (!stage_.finish) return;
    const plr_status status = guarded("finish", arrival, true,
                                      [&](const plr_call& call) { return stage_.finish(node_.instance.self, &call); });
    if (status != PLR_OK) expect_ok(status, "finish at " + seconds_text(arrival));
}

std::optional<std::vector<unsigned char>> StageRunner::save() {
    if (!stage_.save) return std::nullopt;
    std::vector<unsigned char> state;
    plr_writer writer{};
    writer.struct_size = sizeof writer;
    writer.context = &state;
    writer.write = append;
    const plr_status status = guarded(
        "save", 0, false, [&](const plr_call& call) { return stage_.save(node_.instance.self, &writer, call.error); });
    expect_ok(status, "save");
    return state;
}

void StageRunner::load(const std::vector<unsigned char>& state) {
    if (!stage_.load) throw error("load", "the snapshot holds state for it, but the stage has no function load");
    const plr_status status = guarded("load", 0, false, [&](const plr_call& call) {
        return stage_.load(node_.instance.self, state.data(), state.size(), call.error);
    });
    expect_ok(status, "load");
}

MessageRef StageRunner::take(std::uint32_t port, const plr_message& message) {
    if (!publishing_) throw BadMessage("publishing is possible only within emit, receive and finish of the same stage");
    if (port >= node_.out_ports.size())
        throw BadMessage(fmt::format("there is no out port {}; the plugin has {}", port, node_.out_ports.size()));
    const Wiring::Port& out = node_.out_ports[port];
    check_message(message, check_memory_);
    if (message.kind != out.message)
        throw BadMessage(fmt::format("the port carries {}, not {}", host::message_kind_name(out.message),
                                     host::message_kind_name(message.kind)));
    check_stream(message, out.streams);
    const std::int64_t arrival = message.arrival == INT64_MIN ? arrival_ : message.arrival;
    if (!is_source_ && arrival != arrival_)
        throw BadMessage(
            fmt::format("message.arrival is {}, but only a source may set another than that of the event at hand, {}",
                        seconds_text(arrival), seconds_text(arrival_)));
    if (arrival < arrival_)
        throw BadMessage(fmt::format("message.arrival is {}, before the event at hand, {}", seconds_text(arrival),
                                     seconds_text(arrival_)));
    MessageRef copy = copy_message(pool_, message);
    copy.writable().arrival = arrival;
    return copy;
}

plr_status StageRunner::publish(std::uint32_t port, const plr_message& message, plr_error* error) {
    const auto refuse = [&](plr_status code, const std::string& text, std::int64_t item) {
        const std::string where = port < node_.out_ports.size() ? node_.out_ports[port].name : std::string();
        if (error && error->code == PLR_OK) error->item = item;
        if (refused_publication_.empty()) refused_publication_ = where.empty() ? text : where + ": " + text;
        return host::tell(error, code, text, where);
    };
    try {
        outbox_.push_back({port, take(port, message)});
        return PLR_OK;
    } catch (const BadMessage& problem) {
        return refuse(PLR_E_ARGUMENT, std::string("publish: ") + problem.what(), problem.item());
    } catch (const std::bad_alloc&) {
        return refuse(PLR_E_MEMORY, "publish: no memory for the message", -1);
    }
}

void StageRunner::count_refusal() const {
    const plr_host* host = node_.host->host();
    const auto* service = static_cast<const plr_diagnostics*>(host->service(host, PLR_SERVICE_DIAGNOSTICS));
    service->count(service->context, "refused", 1);
}

}  // namespace pelorus::runtime
