#include "runtime/event_queue.hpp"

#include <algorithm>
#include <utility>

namespace pelorus::runtime {
namespace {

/// The standard heaps put the largest on top.
bool later(const Event& a, const Event& b) noexcept { return b < a; }

}  // namespace

void EventQueue::push(Event event) {
    heap_.push_back(std::move(event));
    std::push_heap(heap_.begin(), heap_.end(), later);
}

Event EventQueue::pop() {
    std::pop_heap(heap_.begin(), heap_.end(), later);
    Event event = std::move(heap_.back());
    heap_.pop_back();
    return event;
}

std::vector<Event> EventQueue::sorted() const {
    std::vector<Event> events = heap_;
    std::sort(events.begin(), events.end());
    return events;
}

}  // namespace pelorus::runtime
