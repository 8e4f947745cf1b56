/// What a Runtime is made of: the state of a run and the steps that change it. runtime.cpp runs a graph from its start to its
/// end; stepping.cpp lets an application run it bit by bit and put messages in.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "runtime/event_queue.hpp"
#include "runtime/message_check.hpp"
#include "runtime/runtime.hpp"
#include "runtime/snapshot.hpp"
#include "runtime/stage_runner.hpp"

namespace pelorus::runtime {

using Time = std::int64_t;  // ns

/// What can happen next.
struct Outlook {
    bool something = false;
    bool emission = false;  ///< of source key.node; otherwise the queue's next message
    EventKey key;
    Time announced = 0;        ///< the arrival that the source named
    std::optional<Time> wait;  ///< wall-clock time until which some source has nothing
};

/// Until a wall-clock time, in slices, so that a stop is noticed soon; a millisecond at least, so that a source that keeps
/// waiting for the past does not burn a core.
void sleep_until(Time wall_clock, const std::function<bool()>& stopped);

struct Runtime::Implementation {
    enum class Phase { ready, running, over, broken };
    struct SourceState {
        bool ended = false;
        bool live = false;  // has answered PLR_NEXT_WAIT
        std::optional<Time> last_emitted;
    };

    explicit Implementation(Wiring given);

    Outlook look_ahead();
    void check_announcement(std::size_t node, Time arrival) const;
    void handle(const Outlook& outlook);
    void handle_message();
    void deliver(std::size_t edge, const MessageRef& message);
    bool deliver_feedback(std::size_t node);
    void commit(std::size_t node);
    Outcome loop(const RunOptions& options);
    bool handle_before(const EventKey& key, const MayGoOn& may_go_on);
    Step advance(Time until, const MayGoOn& may_go_on);
    Step play(const MayGoOn& may_go_on);
    Delivery deliver_from_outside(const Address& to, const plr_message& given, const MayGoOn& may_go_on);
    const plr_external& admit(const Address& to, const plr_message& message);
    void count(std::size_t node, const char* counter) const;
    /// Throws Error where nothing can happen any more.
    void require_alive() const;
    /// Does a part of the run. What fails ends it: all sinks are finished nevertheless.
    template <class Work> auto alive(Work work) {
        phase = Phase::running;
        std::string failure;
        try {
            return work();
        } catch (const BadMessage&) {
            throw;  // a message from outside that was refused: nothing has happened
        } catch (const std::exception& problem) {
            failure = problem.what();
        }
        phase = Phase::over;
        throw Error(Exit::run_failed, failure + finish_sinks_after_failure(failure));
    }
    void drain(Time last);
    void finish_all();
    std::string finish_sinks_after_failure(const std::string& failure);
    Snapshot take_snapshot() const;
    void restore(Snapshot snapshot);

    MessagePool pool;  // outlives every message below
    Wiring wiring;
    Scratch scratch;
    std::vector<std::unique_ptr<StageRunner>> runners;           // [nodes]
    using EdgesOfPorts = std::vector<std::vector<std::size_t>>;  // [out ports] edges
    std::vector<EdgesOfPorts> forward, backward;                 // [nodes] receivers in file order; feedback edges
    std::vector<std::uint32_t> edge_numbers;                     // [edges] among those that end at the same in port
    std::vector<std::uint32_t> deliveries_to_check;              // [edges] how many more
    std::vector<bool> has_forward_input;                         // [nodes]
    std::vector<EventQueue> feedback;              // [nodes] what waits at the feedback edges that end there
    std::vector<SourceState> sources;              // [nodes]
    std::vector<bool> finished;                    // [nodes]
    std::vector<std::vector<Observer>> observers;  // [nodes] [out ports]; empty: nobody
    CheckMemory check_memory;                      // of messages from outside
    EventQueue queue;
    std::uint64_t sequence = 0;
    std::optional<Time> now;  // arrival of the event handled last
    ResultCollector results;
    Phase phase = Phase::ready;
};

}  // namespace pelorus::runtime
