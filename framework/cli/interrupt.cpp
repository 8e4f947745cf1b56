#include "cli/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <initializer_list>

namespace pelorus::cli {

namespace {

std::atomic<bool> stop_requested{false};
std::atomic<int> received{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler must not lock");

extern "C" void note_signal(int number) {
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
    action.sa_flags = SA_RESETHAND;  // and no SA_RESTART: a source that waits is woken
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
