/// A stack for signal handlers, so that the overflow of a thread's own one can still be told by whoever installed a handler.
#pragma once

#include <memory>

namespace pelorus::host {

/// The present thread's, while this lives; without effect if the thread has one already or there is no memory for it.
class AlternateStack {
public:
    AlternateStack() noexcept;
    ~AlternateStack();
    AlternateStack(const AlternateStack&) = delete;
    AlternateStack& operator=(const AlternateStack&) = delete;

private:
    std::unique_ptr<unsigned char[]> memory_;
};

}  // namespace pelorus::host
