#include "runtime/runtime.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <stdexcept>
#include <thread>
#include <utility>

#include "runtime/implementation.hpp"
#include "runtime/time_text.hpp"

namespace pelorus::runtime {
namespace {

constexpr std::uint32_t checked_at_start = 16;  // deliveries of each edge

bool is_set(const std::atomic<bool>* flag) { return flag && flag->load(std::memory_order_relaxed); }

}  // namespace

void sleep_until(Time wall_clock, const std::function<bool()>& stopped) {
    constexpr auto slice = std::chrono::milliseconds(20);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    while (!stopped()) {
        const Time now =
            std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
                .count();
        if (now >= wall_clock) return;
        std::this_thread::sleep_for(
            std::min<std::chrono::nanoseconds>(slice, std::chrono::nanoseconds(wall_clock - now)));
    }
}

Runtime::Implementation::Implementation(Wiring given) : wiring(std::move(given)) {
    const std::size_t count = wiring.nodes.size();
    std::vector<bool> receives(count, false);
    forward.resize(count), backward.resize(count), feedback.resize(count), sources.resize(count);
    has_forward_input.resize(count, false), finished.resize(count, false), observers.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        forward[i].resize(wiring.nodes[i].out_ports.size());
        backward[i].resize(wiring.nodes[i].out_ports.size());
        observers[i].resize(wiring.nodes[i].out_ports.size());
    }
    std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> edges_at;  // (node, in port)
    for (std::size_t i = 0; i < wiring.edges.size(); ++i) {
        const graph::Edge& edge = wiring.edges[i];
        deliveries_to_check.push_back(wiring.guard == host::GuardMode::off ? 0 : checked_at_start);
        edge_numbers.push_back(edges_at[{edge.to, edge.to_port}]++);
        receives[edge.to] = true;
        if (!edge.previous) has_forward_input[edge.to] = true;
        (edge.previous ? backward : forward)[edge.from][edge.from_port].push_back(i);
    }
    for (EdgesOfPorts& ports : forward)
        for (auto& edges : ports)
            std::stable_sort(edges.begin(), edges.end(),
                             [this](std::size_t a, std::size_t b) { return wiring.edges[a].to < wiring.edges[b].to; });
    for (std::size_t i = 0; i < count; ++i)
        runners.push_back(std::make_unique<StageRunner>(wiring.nodes[i], receives[i], pool, scratch));
}

void Runtime::Implementation::check_announcement(std::size_t node, Time arrival) const {
    const auto refuse = [&](const std::string& text) {
        throw runners[node]->error("next at " + seconds_text(now.value_or(0)),
                                   "announces an event at " + seconds_text(arrival) + ", " + text);
    };
    const std::optional<Time>& last = sources[node].last_emitted;
    if (last && arrival < *last) refuse("before the one that it emitted at " + seconds_text(*last));
    if (now && arrival < *now && !sources[node].live) refuse("but the run has come to " + seconds_text(*now));
}

Outlook Runtime::Implementation::look_ahead() {
    Outlook outlook;
    for (std::size_t node = 0; node < runners.size(); ++node) {
        if (!runners[node]->is_source() || sources[node].ended) continue;
        const plr_next next = runners[node]->next(now.value_or(0));
        if (next.what == PLR_NEXT_END) {
            sources[node].ended = true;
            if (!has_forward_input[node]) feedback[node].clear();
        } else if (next.what == PLR_NEXT_WAIT) {
            sources[node].live = true;
            outlook.wait = std::min(outlook.wait.value_or(next.arrival), next.arrival);
        } else {
            check_announcement(node, next.arrival);
            // What a live source stamped while another one's later event was handled has reached the run only now.
            const Time arrival = now ? std::max(next.arrival, *now) : next.arrival;
            const EventKey key{arrival, next.time, node, std::numeric_limits<std::uint64_t>::max()};
            if (!outlook.something || key < outlook.key) outlook.key = key, outlook.announced = next.arrival;
            outlook.something = outlook.emission = true;
        }
    }
    if (!queue.empty() && (!outlook.something || queue.next() < outlook.key)) {
        outlook.something = true;
        outlook.emission = false;
        outlook.key = queue.next();
    }
    return outlook;
}

void Runtime::Implementation::commit(std::size_t node) {
    StageRunner& runner = *runners[node];
    for (Publication& publication : runner.outbox()) {
        plr_message& message = publication.message.writable();
        message.sequence = sequence++;
        message.origin = wiring.nodes[node].name.c_str();
        if (message.kind == PLR_MESSAGE_TABLE) {
            try {
                results.collect(node, wiring.nodes[node].name, *message.body.table);
            } catch (const std::invalid_argument& problem) {
                throw runner.error("publish " + wiring.nodes[node].out_ports[publication.port].name + " at " +
                                       seconds_text(message.arrival),
                                   problem.what());
            }
        }
        if (const Observer& observer = observers[node][publication.port]) observer(publication.message);
        const EventKey key{message.arrival, message.time, node, message.sequence};
        for (const std::size_t edge : backward[node][publication.port]) {
            const std::size_t to = wiring.edges[edge].to;
            const bool deaf = sources[to].ended && !has_forward_input[to];  // nothing will happen there any more
            if (!deaf) feedback[to].push({key, static_cast<std::uint32_t>(edge), publication.message});
        }
        if (!forward[node][publication.port].empty())
            queue.push({key, publication.port, std::move(publication.message)});
    }
    runner.outbox().clear();
}

void Runtime::Implementation::deliver(std::size_t edge_index, const MessageRef& message) {
    const graph::Edge& edge = wiring.edges[edge_index];
    plr_message delivered = *message;
    delivered.edge = edge_numbers[edge_index];
    std::uint32_t& to_check = deliveries_to_check[edge_index];
    const bool checked = to_check > 0;
    if (checked && wiring.guard == host::GuardMode::start) --to_check;
    const std::uint64_t before = checked ? message.fingerprint() : 0;
    runners[edge.to]->receive(*now, static_cast<std::uint32_t>(edge.to_port), delivered);
    if (checked && message.fingerprint() != before)
        throw runners[edge.to]->error(
            "receive " + wiring.nodes[edge.to].in_ports[edge.to_port].name + " at " + seconds_text(*now),
            "changed the message that it received; messages are shared by all receivers, and not to be written");
    commit(edge.to);
}

bool Runtime::Implementation::deliver_feedback(std::size_t node) {
    bool delivered = false;
    while (!feedback[node].empty() && feedback[node].next().arrival < *now) {
        const Event event = feedback[node].pop();
        deliver(event.channel, event.message);
        delivered = true;
    }
    return delivered;
}

void Runtime::Implementation::handle_message() {
    const Event event = queue.pop();
    now = event.key.arrival;
    for (const std::size_t edge : forward[event.key.node][event.channel]) {
        deliver_feedback(wiring.edges[edge].to);
        deliver(edge, event.message);
    }
}

void Runtime::Implementation::handle(const Outlook& outlook) {
    if (!outlook.emission) return handle_message();
    const std::size_t node = outlook.key.node;
    now = outlook.key.arrival;
    if (deliver_feedback(node)) return;  // the source may have other plans now: it is asked again
    runners[node]->emit(*now);
    sources[node].last_emitted = outlook.announced;
    commit(node);
}

Outcome Runtime::Implementation::loop(const RunOptions& options) {
    bool snapshot_due = options.snapshot_at && options.on_snapshot;
    const auto give_snapshot = [&] {
        options.on_snapshot(to_bytes(take_snapshot(), wiring));
        snapshot_due = false;
    };
    while (!is_set(options.stop)) {
        const Outlook outlook = look_ahead();
        if (outlook.wait && (!outlook.something || outlook.key.arrival >= *outlook.wait)) {
            sleep_until(*outlook.wait, [&] { return is_set(options.stop); });
            continue;
        }
        if (!outlook.something) {
            if (snapshot_due) give_snapshot();
            return Outcome::completed;
        }
        if (snapshot_due && outlook.key.arrival > *options.snapshot_at) {
            give_snapshot();
            continue;  // whoever takes it may want the run to stop right there
        }
        handle(outlook);
        if (options.on_progress) options.on_progress(*now);
    }
    drain(now.value_or(0));
    queue.clear();
    return Outcome::stopped;
}

void Runtime::Implementation::drain(Time last) {
    while (!queue.empty() && queue.next().arrival <= last) handle_message();
}

void Runtime::Implementation::finish_all() {
    for (const std::size_t node : wiring.order) {
        finished[node] = true;
        runners[node]->finish(now.value_or(0));
        commit(node);
        drain(std::numeric_limits<Time>::max());
    }
}

std::string Runtime::Implementation::finish_sinks_after_failure(const std::string& failure) {
    std::string failures;
    for (const std::size_t node : wiring.order) {
        if (finished[node] || !runners[node]->is_sink()) continue;
        finished[node] = true;
        try {
            runners[node]->finish(now.value_or(0));
        } catch (const Error& problem) {
            // A full disk that ended the run is met again here.
            const std::string line = problem.what();
            const std::size_t reason = line.find(": ");
            if (reason == std::string::npos || failure.find(line.substr(reason)) == std::string::npos)
                failures += "; then " + line;
        }
    }
    return failures;
}

Snapshot Runtime::Implementation::take_snapshot() const {
    Snapshot snapshot;
    for (std::size_t node = 0; node < runners.size(); ++node) {
        const host::InstanceHost& host = *wiring.nodes[node].host;
        snapshot.nodes.push_back(
            {runners[node]->save(), sources[node].ended, sources[node].last_emitted, host.counters(), host.gauges()});
    }
    snapshot.now = now;
    snapshot.sequence = sequence;
    snapshot.events = queue.sorted();
    for (const EventQueue& waiting : feedback) snapshot.feedback.push_back(waiting.sorted());
    snapshot.results = results;
    return snapshot;
}

void Runtime::Implementation::restore(Snapshot snapshot) {
    for (std::size_t node = 0; node < runners.size(); ++node) {
        if (!snapshot.nodes[node].state) continue;
        try {
            runners[node]->load(*snapshot.nodes[node].state);
        } catch (const Error& problem) {
            phase = Phase::broken;
            throw Error(Exit::run_failed, std::string("snapshot refused: ") + problem.what() +
                                              "; the graph is half restored and cannot run");
        }
    }
    for (std::size_t node = 0; node < runners.size(); ++node) {
        Snapshot::Node& from = snapshot.nodes[node];
        wiring.nodes[node].host->restore(std::move(from.counters), std::move(from.gauges));
        sources[node] = {from.ended, false, from.last_emitted};
    }
    now = snapshot.now;
    sequence = snapshot.sequence;
    queue.clear();
    for (Event& event : snapshot.events) queue.push(std::move(event));
    for (std::size_t node = 0; node < feedback.size(); ++node)
        for (Event& event : snapshot.feedback[node]) feedback[node].push(std::move(event));
    results = std::move(snapshot.results);
}

Runtime::Runtime(graph::Graph& graph) : Runtime(wire(graph)) {}
Runtime::Runtime(Wiring wiring) : implementation_(std::make_unique<Implementation>(std::move(wiring))) {}
Runtime::~Runtime() = default;

Outcome Runtime::run(const RunOptions& options) {
    Implementation& self = *implementation_;
    self.require_alive();
    if (self.phase != Implementation::Phase::ready)
        throw Error(Exit::run_failed, "the graph has already run: build it anew");
    return self.alive([&] {
        const Outcome outcome = self.loop(options);
        self.finish_all();
        self.phase = Implementation::Phase::over;
        return outcome;
    });
}

std::vector<unsigned char> Runtime::snapshot() const {
    return to_bytes(implementation_->take_snapshot(), implementation_->wiring);
}

void Runtime::restore(const std::vector<unsigned char>& bytes) {
    Implementation& self = *implementation_;
    if (self.phase != Implementation::Phase::ready)
        throw Error(Exit::run_failed, "a snapshot can only be restored before the run");
    self.restore(from_bytes(bytes, self.wiring, self.pool));
}

const Results& Runtime::results() const noexcept { return implementation_->results.results(); }

std::vector<NodeTiming> Runtime::timing() const {
    std::vector<NodeTiming> timing;
    for (const auto& runner : implementation_->runners)
        timing.push_back({runner->node().name, runner->calls(), runner->seconds(), runner->longest_seconds()});
    return timing;
}

}  // namespace pelorus::runtime
