#include "host/guard/fault.hpp"

#include <exception>

namespace pelorus::host {

void FaultLatch::set(const std::string& line) noexcept {
    try {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (set_.load(std::memory_order_relaxed)) return;
        line_ = line;
    } catch (const std::exception&) {
        // No memory for the words: that there is a fault must be known all the same.
    }
    set_.store(true, std::memory_order_release);
}

std::string FaultLatch::line() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return line_.empty() && is_set() ? "a part broke the contract, and there was no memory to say how" : line_;
}

}  // namespace pelorus::host
