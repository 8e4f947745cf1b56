// A run bit by bit, and messages from outside.
#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <pelorus/abi/diagnostics.h>
#include <pelorus/abi/external.h>

#include "host/first_size.hpp"
#include "host/kinds.hpp"
#include "runtime/implementation.hpp"
#include "runtime/message_fields.hpp"
#include "runtime/time_text.hpp"

namespace pelorus::runtime {
namespace {

bool says_stop(const MayGoOn& may_go_on) { return may_go_on && !may_go_on(); }

}  // namespace

const plr_external* external_of(const Wiring::Node& node) {
    const plr_table_head& head = *node.instance.table;
    if (!head.extension) return nullptr;
    const auto* external = static_cast<const plr_external*>(head.extension(node.instance.self, PLR_EXTERNAL));
    return external && external->struct_size >= host::first_size<plr_external> ? external : nullptr;
}

void Runtime::Implementation::require_alive() const {
    if (phase == Phase::broken)
        throw Error(Exit::run_failed,
                    "the graph was left half restored by a snapshot that was refused, and cannot run");
    if (phase == Phase::over) throw Error(Exit::run_failed, "the graph has already run: build it anew");
}

void Runtime::Implementation::count(std::size_t node, const char* counter) const {
    const plr_host* host = wiring.nodes[node].host->host();
    const auto* service = static_cast<const plr_diagnostics*>(host->service(host, PLR_SERVICE_DIAGNOSTICS));
    service->count(service->context, counter, 1);
}

bool Runtime::Implementation::handle_before(const EventKey& key, const MayGoOn& may_go_on) {
    while (true) {
        if (says_stop(may_go_on)) return false;
        const Outlook outlook = look_ahead();
        if (!outlook.something || !(outlook.key < key)) return true;
        handle(outlook);
    }
}

Step Runtime::Implementation::advance(Time until, const MayGoOn& may_go_on) {
    const auto last = std::numeric_limits<Time>::max();
    const EventKey after_all{until, last, runners.size(), 0};
    return handle_before(after_all, may_go_on) ? Step::done : Step::halted;
}

Step Runtime::Implementation::play(const MayGoOn& may_go_on) {
    while (true) {
        if (says_stop(may_go_on)) return Step::halted;
        const Outlook outlook = look_ahead();
        if (outlook.wait && (!outlook.something || outlook.key.arrival >= *outlook.wait)) {
            bool stopped = false;  // kept: who is asked a second time may say something else
            sleep_until(*outlook.wait, [&] { return stopped = says_stop(may_go_on); });
            if (stopped) return Step::halted;
            continue;
        }
        if (!outlook.something) return Step::done;
        handle(outlook);
    }
}

/// Differences of times are taken everywhere, and must not leave 64 bits.
void check_time(const char* field, Time time) {
    constexpr Time farthest = Time{1} << 62;
    if (time < -farthest || time > farthest)
        throw BadMessage(fmt::format("message.{} is {} ns, expected at most 2^62 ns before or after 0", field, time));
}

/// Throws BadMessage unless the message may go to that in port.
const plr_external& Runtime::Implementation::admit(const Address& to, const plr_message& message) {
    const Wiring::Node& node = wiring.nodes.at(to.node);
    const Wiring::Port& port = node.in_ports.at(to.port);
    const plr_external* external = external_of(node);
    if (!external)
        throw BadMessage(fmt::format("{} takes nothing from outside; only nodes made for it do (extension {})",
                                     node.plugin, PLR_EXTERNAL));
    const auto ends_here = [&](const graph::Edge& edge) { return edge.to == to.node && edge.to_port == to.port; };
    if (std::any_of(wiring.edges.begin(), wiring.edges.end(), ends_here))
        throw BadMessage("an edge of the graph ends at this port, so nothing can be pushed into it");
    check_message(message, check_memory);
    check_time("time", message.time);
    if (message.arrival != std::numeric_limits<Time>::min()) check_time("arrival", message.arrival);
    if (message.kind != port.message)
        throw BadMessage(fmt::format("the port takes {}, not {}", host::message_kind_name(port.message),
                                     host::message_kind_name(message.kind)));
    check_stream(message, port.streams);
    return *external;
}

Delivery Runtime::Implementation::deliver_from_outside(const Address& to, const plr_message& given,
                                                       const MayGoOn& may_go_on) {
    const std::string place = wiring.nodes.at(to.node).name + "." + wiring.nodes[to.node].in_ports.at(to.port).name;
    const plr_external* external = nullptr;
    try {
        external = &admit(to, given);
    } catch (const BadMessage& problem) {
        count(to.node, "refused");
        throw BadMessage(place + ": " + problem.what(), problem.item());
    }
    plr_message message = known_part(&given);
    if (message.arrival == std::numeric_limits<Time>::min()) message.arrival = message.time;
    const bool is_late = now && message.arrival < *now;
    if (is_late) {
        if (external->late == PLR_LATE_DROP) return count(to.node, "late_dropped"), Delivery::dropped;
        if (external->late != PLR_LATE_KEEP) {
            count(to.node, "late_refused");
            throw LateMessage(fmt::format("{}: the message arrives at {}, but the graph has come to {}", place,
                                          seconds_text(message.arrival), seconds_text(*now)));
        }
        message.arrival = *now;
    }
    const EventKey key{message.arrival, message.time, to.node, std::numeric_limits<std::uint64_t>::max()};
    if (!handle_before(key, may_go_on)) return Delivery::halted;
    if (is_late) count(to.node, "late_kept");
    now = message.arrival;
    message.origin = "application";
    deliver_feedback(to.node);
    const bool taken = runners[to.node]->receive(*now, static_cast<std::uint32_t>(to.port), message);
    commit(to.node);
    if (!taken) throw BadMessage(place + ": the node refused the message; the log says why");
    return Delivery::delivered;
}

Step Runtime::advance(std::int64_t until, const MayGoOn& may_go_on) {
    implementation_->require_alive();
    return implementation_->alive([&] { return implementation_->advance(until, may_go_on); });
}

Step Runtime::play(const MayGoOn& may_go_on) {
    implementation_->require_alive();
    return implementation_->alive([&] { return implementation_->play(may_go_on); });
}

Delivery Runtime::deliver(const Address& in_port, const plr_message& message, const MayGoOn& may_go_on) {
    implementation_->require_alive();
    return implementation_->alive([&] { return implementation_->deliver_from_outside(in_port, message, may_go_on); });
}

void Runtime::finish() {
    Implementation& self = *implementation_;
    self.require_alive();
    self.alive([&] {
        self.drain(std::numeric_limits<Time>::max());
        self.finish_all();
        self.phase = Implementation::Phase::over;
    });
}

void Runtime::observe(const Address& out_port, Observer observer) {
    implementation_->observers.at(out_port.node).at(out_port.port) = std::move(observer);
}

bool Runtime::is_broken() const noexcept { return implementation_->phase == Implementation::Phase::broken; }
std::optional<std::int64_t> Runtime::now() const noexcept { return implementation_->now; }
std::size_t Runtime::waiting() const noexcept { return implementation_->queue.size(); }
const Wiring& Runtime::wiring() const noexcept { return implementation_->wiring; }

}  // namespace pelorus::runtime
