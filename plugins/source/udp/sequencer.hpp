/// Datagrams in the order of their senders: held back while one is missing, given up after a while, told once.
///
/// Knows no clock and no socket: the caller says what time it is. Memory is bounded by the settings: what waits for a
/// missing datagram or part by `maximum_waiting`; what is ready, by the caller, who stops pushing.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "../../common/wire/frame.hpp"

namespace source_udp {

enum class Late { drop, keep, stop };
enum class Lost { count, stop };
enum class Duplicates { drop, keep };

struct OrderSettings {
    std::int64_t reorder_time = 0;      ///< ns that a later datagram waits for a missing one
    std::size_t reorder_datagrams = 0;  ///< later datagrams of a sender that wait for it
    std::size_t maximum_senders = 1;
    std::size_t maximum_measurements = 1;  ///< of a scan put together from parts
    std::size_t maximum_waiting = 1;       ///< bytes of datagrams held back and of parts, of all senders
    Late late = Late::drop;
    Lost lost = Lost::count;
    Duplicates duplicates = Duplicates::drop;
    bool own_clock = false;  ///< arrivals are of a clock here: one that lies back says nothing of the frame
};

/// What came of it all, so far.
struct OrderCounts {
    std::uint64_t lost = 0, late = 0, duplicate = 0, incomplete = 0, ignored = 0;
    template <class Archive> void state(Archive& archive) { archive(lost, late, duplicate, incomplete, ignored); }
};

class Sequencer {
public:
    /// `warn` is told what policies did; what cannot go on, or must not by policy, is thrown as pelorus::DataError.
    Sequencer(const OrderSettings& settings, std::function<void(const std::string&)> warn)
        : settings_(settings), warn_(std::move(warn)) {}

    /// Takes a datagram; `now` is any clock that only goes forward, ns. False: refused, because there are too many senders.
    bool push(wire::Datagram datagram, std::int64_t now);
    /// Gives up what has been waited for long enough.
    void expire(std::int64_t now);
    /// Gives up all that is missing.
    void flush();

    /// Frames in order, complete, of kind scan or truth; arrivals never fall.
    const std::deque<wire::Frame>& ready() const noexcept { return ready_; }
    std::size_t ready_bytes() const noexcept { return ready_bytes_; }
    /// What is held back and what has been put together of frames that lack parts; after a push, within the settings.
    std::size_t waiting_bytes() const noexcept { return waiting_bytes_; }
    wire::Frame take();

    /// Senders that have told their end.
    std::size_t ended() const noexcept { return ended_; }
    const OrderCounts& counts() const noexcept { return counts_; }

    template <class Archive> void state(Archive& archive) {
        archive(flows_, ready_, counts_, ended_, heard_, newest_);
        if constexpr (Archive::reading) {
            ready_bytes_ = 0;
            for (const wire::Frame& frame : ready_) ready_bytes_ += frame.bytes();
            waiting_bytes_ = 0;
            for (const auto& [key, flow] : flows_) waiting_bytes_ += flow.bytes();
        }
    }

private:
    /// One sender, from its start to its end.
    struct Flow {
        std::optional<std::uint64_t> next;  // sequence number that is due
        std::map<std::uint64_t, wire::Datagram> held;
        std::map<std::uint64_t, std::uint64_t> given_up;  // ranges: first, last
        std::size_t held_bytes = 0;
        std::optional<wire::Frame> whole;  // parts so far
        std::size_t whole_bytes = 0;
        std::optional<std::int64_t> broken;  // time of the frame last left out
        std::optional<std::uint64_t> end;    // sequence number of its end
        bool ended = false;
        std::uint64_t heard = 0;                    // count of datagrams at its last one
        std::optional<std::int64_t> waiting_since;  // clocks do not outlive a process: not saved
        template <class Archive> void state(Archive& archive) {
            archive(next, held, given_up, whole, broken, end, ended, heard);
            if constexpr (Archive::reading) {
                waiting_since.reset();
                held_bytes = 0;
                for (const auto& [sequence, datagram] : held) held_bytes += datagram.bytes();
                whole_bytes = whole ? whole->bytes() : 0;
            }
        }
        std::size_t bytes() const noexcept { return held_bytes + whole_bytes; }
    };
    using Key = std::pair<std::string, std::uint64_t>;  // sender, session

    Flow* flow_of(const Key& key);
    void order(const Key& key, Flow& flow, wire::Datagram datagram, std::int64_t now);
    void past(const Key& key, Flow& flow, const wire::Datagram& datagram, std::uint64_t sequence);
    void duplicate(const Key& key, std::uint64_t sequence, const char* outcome);
    void make_room();
    bool hold(Flow& flow, std::uint64_t sequence, wire::Datagram datagram);
    wire::Datagram take_held(Flow& flow);
    void give_up_next(const Key& key, Flow& flow);
    void advance(const Key& key, Flow& flow);
    void release(const Key& key, Flow& flow, const wire::Datagram& datagram, bool known_late);
    void release(const Key& key, Flow& flow, const wire::Frame& frame, bool known_late);
    void put_together(const Key& key, Flow& flow, const wire::Frame& part);
    void forget_whole(Flow& flow);
    void incomplete(const Key& key, Flow& flow, const char* before = "");
    void enqueue(const Key& key, wire::Frame frame, bool known_late);

    OrderSettings settings_;
    std::function<void(const std::string&)> warn_;
    std::map<Key, Flow> flows_;
    std::deque<wire::Frame> ready_;
    std::size_t ready_bytes_ = 0, waiting_bytes_ = 0;
    OrderCounts counts_;
    std::uint64_t ended_ = 0, heard_ = 0;
    std::optional<std::int64_t> newest_;  // arrival of what became ready last
};

}  // namespace source_udp
