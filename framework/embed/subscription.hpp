/// Messages that wait for the application: a queue with a bound.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>

#include "runtime/message_block.hpp"
#include "runtime/runtime.hpp"

namespace pelorus::embed {

class Subscription {
public:
    Subscription(runtime::Address port, std::size_t capacity, bool drops_oldest)
        : port_(port), capacity_(capacity), drops_oldest_(drops_oldest) {}

    const runtime::Address& port() const noexcept { return port_; }
    bool is_full() const noexcept { return !drops_oldest_ && waiting_.size() >= capacity_; }
    std::size_t waiting() const noexcept { return waiting_.size(); }
    std::uint64_t dropped() const noexcept { return dropped_; }

    void take(const runtime::MessageRef& message) {
        if (drops_oldest_ && waiting_.size() >= capacity_) {
            waiting_.pop_front();
            ++dropped_;
        }
        waiting_.push_back(message);
    }
    /// Valid until the next one; nullptr: none waits.
    const plr_message* pull() {
        lent_ = runtime::MessageRef();
        if (waiting_.empty()) return nullptr;
        lent_ = std::move(waiting_.front());
        waiting_.pop_front();
        return &*lent_;
    }

private:
    runtime::Address port_;
    std::size_t capacity_;
    bool drops_oldest_;
    std::deque<runtime::MessageRef> waiting_;
    runtime::MessageRef lent_;
    std::uint64_t dropped_ = 0;
};

}  // namespace pelorus::embed
