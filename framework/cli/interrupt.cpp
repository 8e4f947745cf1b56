#include "cli/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <ctime>
#include <initializer_list>

namespace pelorus::cli {

namespace {

std::atomic<bool> stop_requested{false};
std::atomic<int> received{0};
std::atomic<std::int64_t> received_at{0};  // ms
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<std::int64_t>::is_always_lock_free,
              "a signal handler must not lock");

/// ms since the machine started. Safe in a signal handler.
std::int64_t now_ms() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

/// `timeout`, mpirun and batch systems signal the process and then its group: what comes so soon is the same request.
constexpr std::int64_t same_request_ms = 300;

extern "C" void note_signal(int number) {
    if (received != 0) {
        if (now_ms() - received_at < same_request_ms) return;
        std::signal(number, SIG_DFL);
        std::raise(number);  // delivered when this handler returns
        return;
    }
    received_at = now_ms();
    received = number;
    stop_requested = true;
    // Who sits at a terminal and sees nothing happen, because a plugin takes its time, shall know what to do.
    constexpr char line[] = "\npelorus: stopping; once more ends it at once\n";
    if (::isatty(STDERR_FILENO) == 1 && ::write(STDERR_FILENO, line, sizeof line - 1) < 0) return;
}

}  // namespace

Interrupt::Interrupt() {
    stop_requested = false;
    received = 0;
    struct sigaction action {};
    action.sa_handler = &note_signal;
    action.sa_flags = 0;  // no SA_RESTART: a source that waits is woken
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        sigaction(number, nullptr, &before);
        if (before.sa_handler != SIG_IGN) sigaction(number, &action, nullptr);  // nohup and its like stay in force
    }
}

Interrupt::~Interrupt() {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction now {};
        sigaction(number, nullptr, &now);
        if (now.sa_handler == &note_signal) std::signal(number, SIG_DFL);
    }
}

const std::atomic<bool>& Interrupt::stop() const noexcept { return stop_requested; }
void Interrupt::request() noexcept { stop_requested = true; }
const char* Interrupt::signal() const noexcept {
    switch (received) {
        case SIGINT:
            return "SIGINT";
        case SIGTERM:
            return "SIGTERM";
        case SIGHUP:
            return "SIGHUP";
        default:
            return nullptr;
    }
}

}  // namespace pelorus::cli
