/// What is still to happen, in the order in which it happens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "runtime/message_block.hpp"

namespace pelorus::runtime {

/// When an event comes: arrival, then stamp, then the publishing node's place in the file, then the order of
/// publishing.
struct EventKey {
    std::int64_t arrival = 0;  ///< ns
    std::int64_t time = 0;     ///< ns
    std::size_t node = 0;
    std::uint64_t sequence = 0;

    friend bool operator<(const EventKey& a, const EventKey& b) noexcept {
        return std::tie(a.arrival, a.time, a.node, a.sequence) < std::tie(b.arrival, b.time, b.node, b.sequence);
    }
};

/// A published message on its way.
struct Event {
    EventKey key;
    std::uint32_t channel = 0;  ///< in the run's queue: the out port; at a node's feedback edges: the edge
    MessageRef message;

    friend bool operator<(const Event& a, const Event& b) noexcept {
        return a.key < b.key || (!(b.key < a.key) && a.channel < b.channel);
    }
};

/// A binary heap: O(log n) an event, and no order other than the keys'.
class EventQueue {
public:
    void push(Event event);
    /// The key of the first event; there must be one.
    const EventKey& next() const noexcept { return heap_.front().key; }
    Event pop();
    bool empty() const noexcept { return heap_.empty(); }
    std::size_t size() const noexcept { return heap_.size(); }
    void clear() noexcept { heap_.clear(); }
    /// All of it, first event first.
    std::vector<Event> sorted() const;

private:
    std::vector<Event> heap_;
};

}  // namespace pelorus::runtime
