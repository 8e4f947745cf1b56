/// Which call into a plugin is under way on this thread, for the line that a crash leaves behind.
///
/// A mark costs a few stores. Everything that it points to must live as long as the mark, so that a signal handler can read it
/// without asking anybody.
#pragma once

#include <cstdint>
#include <limits>

namespace pelorus::host {

struct CallMark {
    static constexpr std::int64_t no_time = std::numeric_limits<std::int64_t>::min();

    const char* subject;          ///< name of a node, address of a part, or path of a library
    const char* plugin;           ///< id, or nullptr
    const char* call;             ///< `receive`, `propagate`, `create`, ...
    const char* port = nullptr;   ///< or nullptr
    std::int64_t time = no_time;  ///< ns, of the event at hand
    bool is_node = false;         ///< the subject is a node of a running graph
    const CallMark* outer = nullptr;
};

/// The innermost call of the present thread, or nullptr. Initial-exec: reading it in a signal handler must not allocate.
extern __thread const CallMark* innermost_call __attribute__((tls_model("initial-exec")));

/// Marks a call while it lives. [any thread]
class Breadcrumb {
public:
    explicit Breadcrumb(const CallMark& mark) noexcept : mark_(mark) {
        mark_.outer = innermost_call;
        innermost_call = &mark_;
    }
    ~Breadcrumb() { innermost_call = mark_.outer; }
    Breadcrumb(const Breadcrumb&) = delete;
    Breadcrumb& operator=(const Breadcrumb&) = delete;

private:
    CallMark mark_;
};

/// Lets a thread that works for another one carry that one's marks.
class BorrowedBreadcrumb {
public:
    explicit BorrowedBreadcrumb(const CallMark* of_the_other) noexcept : before_(innermost_call) {
        innermost_call = of_the_other;
    }
    ~BorrowedBreadcrumb() { innermost_call = before_; }
    BorrowedBreadcrumb(const BorrowedBreadcrumb&) = delete;
    BorrowedBreadcrumb& operator=(const BorrowedBreadcrumb&) = delete;

private:
    const CallMark* before_;
};

}  // namespace pelorus::host
