/// What the guard found wrong with a model, kept until the host asks: a holder may well tolerate a part that fails, but a broken
/// contract has to end the run with its own words.
#pragma once

#include <atomic>
#include <mutex>
#include <string>

namespace pelorus::host {

/// One for each stage and the tree of parts below it. [any thread]
class FaultLatch {
public:
    FaultLatch() = default;
    FaultLatch(const FaultLatch&) = delete;
    FaultLatch& operator=(const FaultLatch&) = delete;

    /// Keeps the first line; later ones are consequences.
    void set(const std::string& line) noexcept;
    bool is_set() const noexcept { return set_.load(std::memory_order_acquire); }
    /// The line; "" if there is none.
    std::string line() const;

private:
    std::atomic<bool> set_{false};
    mutable std::mutex mutex_;
    std::string line_;
};

}  // namespace pelorus::host
