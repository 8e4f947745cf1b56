/// Ctrl-C and kill ask a run to end in an orderly way.
#pragma once

#include <atomic>

namespace pelorus::cli {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP is noted instead of ending the process; a later one ends it at once (not one within
/// 0.3 s: who signals a process and its group means one request). One at a time in a process.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Set by the signal, or by request().
    const std::atomic<bool>& stop() const noexcept;
    /// Asks for the same as a signal does.
    void request() noexcept;
    /// The signal's name, or nullptr if none came.
    const char* signal() const noexcept;
};

}  // namespace pelorus::cli
