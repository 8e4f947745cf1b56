/// Runs a graph: events in (arrival, time, node order, sequence) order, snapshots, results.
///
/// An event is a message on its way to all edges of its port, or a source's next emission; an emission comes after
/// messages of the same arrival, time and node. A message's receivers follow each other in file order.
///
/// Feedback: before a node handles an event at arrival a, it receives what waits at its feedback edges with an arrival
/// strictly before a, oldest first (all its feedback edges merged in the order of events). plr_call.time is then a;
/// plr_message.arrival remains the one at which it was published. When feedback reaches a source before its emission,
/// the source is asked anew what comes next. What is published after a node's last event is not delivered to it.
///
/// A live source that has nothing yet answers PLR_NEXT_WAIT with a wall-clock time (ns since 1970): the run sleeps till
/// then, but handles events that arrive before it. A live source may announce an arrival that the run has passed
/// meanwhile (not one before its own last one); it is handled at once, with the run's arrival. A source that has
/// answered PLR_NEXT_END is not asked again.
///
/// An application may run a graph bit by bit instead (advance, play, finish) and put messages into in ports of nodes that
/// offer PLR_EXTERNAL (deliver). Such a message is an event like a source's emission: it comes after messages of the same
/// arrival, time and node.
///
/// A message that a stage refuses (PLR_E_DATA from receive) is counted (`refused`) and logged, and what the stage
/// published in that call is dropped; every other failure ends the run. A refused publication that the stage passes
/// over is such a failure.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graph/graph.hpp"
#include "runtime/message_block.hpp"
#include "runtime/message_check.hpp"
#include "runtime/result.hpp"
#include "runtime/wiring.hpp"

namespace pelorus::runtime {

/// Wall time that a node has taken.
struct NodeTiming {
    std::string node;
    std::uint64_t calls = 0;
    double seconds = 0;          ///< in all calls
    double longest_seconds = 0;  ///< in the longest of them
    double mean_seconds() const noexcept { return calls > 0 ? seconds / static_cast<double>(calls) : 0; }
};

struct RunOptions {
    /// ns: snapshot before the first event that arrives after it (or, if none does, before stages finish), then go on.
    std::optional<std::int64_t> snapshot_at;
    std::function<void(const std::vector<unsigned char>& bytes)> on_snapshot;
    /// Set from a signal handler: handles what has arrived with the present event, drops what arrives later, finishes
    /// all stages.
    const std::atomic<bool>* stop = nullptr;
    std::function<void(std::int64_t arrival)> on_progress;  ///< after each event
};

enum class Outcome { completed, stopped };

/// How a step of a run ended.
enum class Step { done, halted };
/// What became of a message from outside: `halted` and `dropped` ones have not reached the graph.
enum class Delivery { delivered, halted, dropped };

/// A port of a node, by index.
struct Address {
    std::size_t node = 0, port = 0;
};

/// Asked before every event; false: the step ends there, and what waits is handled by a later one.
using MayGoOn = std::function<bool()>;
/// Sees what an out port publishes, when it is published. Must not call the runtime.
using Observer = std::function<void(const MessageRef&)>;

/// A message from outside arrives before an event that was handled, and its node does not take late ones.
struct LateMessage : BadMessage {
    using BadMessage::BadMessage;
};

/// What a node offers to whoever pushes messages into it; nullptr: nothing can be pushed.
const plr_external* external_of(const Wiring::Node& node);

class Runtime {
public:
    /// Connects the publish services of the graph's stages. The graph must outlive the runtime.
    explicit Runtime(graph::Graph& graph);
    /// The same for a graph told in plain structs, whose instances and hosts must outlive the runtime.
    explicit Runtime(Wiring wiring);
    ~Runtime();
    Runtime(const Runtime&) = delete;
    Runtime& operator=(const Runtime&) = delete;

    /// Runs until every source has ended and the queue is empty, then finishes all stages in graph order. Throws Error
    /// (Exit::run_failed) naming node, plugin, call, time and the plugin's message; what stages have written and
    /// results() stay, and all sinks are finished nevertheless (what fails then follows in the same line). Runs once.
    Outcome run(const RunOptions& options);

    /// Handles everything that arrives up to `until` (ns) and is there now: a live source that has nothing yet is not
    /// waited for. Throws like run(); nothing can happen any more then.
    Step advance(std::int64_t until, const MayGoOn& may_go_on = nullptr);
    /// Handles everything until all sources have ended and nothing waits; waits for live sources.
    Step play(const MayGoOn& may_go_on = nullptr);
    /// Handles what comes before the message, then gives the message to the in port; what the node publishes then waits
    /// for the next step. An arrival of INT64_MIN is the message's time. Throws BadMessage, LateMessage: the message is
    /// refused and counted (`refused`, `late_refused`), the graph is as before; and like run().
    Delivery deliver(const Address& in_port, const plr_message& message, const MayGoOn& may_go_on = nullptr);
    /// Finishes all stages in graph order, after steps instead of run(). Throws like run().
    void finish();
    /// One observer an out port; nullptr: none.
    void observe(const Address& out_port, Observer observer);
    /// The arrival of the event handled last, ns.
    std::optional<std::int64_t> now() const noexcept;
    /// Messages that are still to be handled.
    std::size_t waiting() const noexcept;
    const Wiring& wiring() const noexcept;

    /// The whole graph: every stage's state, queue, feedback values, counters, results so far. Between events: before
    /// run(), after it, or from on_snapshot. Throws Error when a stage cannot save.
    std::vector<unsigned char> snapshot() const;
    /// Before run(). Throws Error: truncated, damaged, another config, another plugin version; nothing is changed then.
    /// When a stage does not take its state, the graph is half restored: the error names the stage, and run() is
    /// refused from then on.
    void restore(const std::vector<unsigned char>& bytes);
    /// Whether restore() left the graph half restored.
    bool is_broken() const noexcept;

    /// Tables and scalars published by any node so far, by node in file order, then by name.
    const Results& results() const noexcept;
    /// By node in file order. A node's time includes the copying of what it publishes.
    std::vector<NodeTiming> timing() const;

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace pelorus::runtime
