#include "fault_handler.hpp"

#include <signal.h>
#include <ucontext.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "guarded_memory.hpp"
#include "watch.hpp"

namespace pelorus::conformance {

const void* instruction_of(void* context) noexcept {
#if defined(__x86_64__)
    return reinterpret_cast<const void*>(static_cast<const ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]);
#elif defined(__aarch64__)
    return reinterpret_cast<const void*>(static_cast<const ucontext_t*>(context)->uc_mcontext.pc);
#else
    (void)context;
    return nullptr;
#endif
}

namespace {

int report_to = -1;
const char* subject_title = "";
const char* call_title = "";
alignas(64) unsigned char signal_stack[1 << 16];

bool was_write(void* context) noexcept {
#if defined(__x86_64__)
    return (static_cast<const ucontext_t*>(context)->uc_mcontext.gregs[REG_ERR] & 2) != 0;
#else
    (void)context;
    return true;
#endif
}

const char* signal_words(int signal) noexcept {
    switch (signal) {
        case SIGSEGV:
            return "SIGSEGV (an address that is not its own)";
        case SIGBUS:
            return "SIGBUS";
        case SIGFPE:
            return "SIGFPE (an arithmetic fault)";
        case SIGILL:
            return "SIGILL (an instruction that this processor does not have)";
        case SIGXCPU:
            return "it was still under way";
        case SIGABRT:
            return "SIGABRT (abort, an assertion, or an exception that nobody caught)";
        default:
            return "a signal";
    }
}

void describe_hit(const ZoneHit& hit, bool is_write, char* text, std::size_t size) noexcept {
    const char* const verb = is_write ? "wrote" : "read";
    if (hit.is_taken_back)
        std::snprintf(text, size, "%s `%s`, which was lent for a call of %s that is over; copy what is to be kept",
                      verb, hit.array, hit.function);
    else if (hit.is_read_only)
        std::snprintf(text, size, "%s wrote to its input `%s`", hit.function, hit.array);
    else if (hit.bytes >= 0)
        std::snprintf(text, size, "%s %s past the end of `%s`, %lld bytes behind its last element", hit.function, verb,
                      hit.array, static_cast<long long>(hit.bytes));
    else
        std::snprintf(text, size, "%s %s before the beginning of `%s`, %lld bytes ahead of its first element",
                      hit.function, verb, hit.array, static_cast<long long>(-hit.bytes));
}

/// The process ends here, so allocating is allowed for as long as it works: a second fault ends it at once.
void handle(int signal, siginfo_t* info, void* context) {
    struct sigaction plain {};
    plain.sa_handler = SIG_DFL;
    for (const int each : {SIGSEGV, SIGBUS, SIGABRT}) sigaction(each, &plain, nullptr);
    char what[512];
    ZoneHit hit{};
    const bool is_hit = signal == SIGSEGV && find_zone(info->si_addr, hit);
    if (is_hit)
        describe_hit(hit, was_write(context), what, sizeof what);
    else
        std::snprintf(what, sizeof what, "%s", signal_words(signal));
    std::string place = signal == SIGABRT ? place_of_caller() : place_of(instruction_of(context));
    if (place.empty() || place.find(".so") == std::string::npos) {
        const std::string caller = place_of_caller();
        if (!caller.empty()) place = caller;
    }
    std::string text = what;
    if (call_title[0] != 0) text = std::string("a call of ") + call_title + ": " + text;
    if (subject_title[0] != 0) text = std::string("with {") + subject_title + "}: " + text;
    if (!place.empty()) text += "; at " + place;
    std::string json = std::string("{\"verdict\": \"") +
                       (is_hit              ? "fail"
                        : signal == SIGXCPU ? "hang"
                                            : "crash") +
                       "\", \"messages\": [\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') json += '\\';
        json += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    json += "\"]}\n";
    if (write(report_to, json.data(), json.size()) < 0) _exit(2);
    _exit(1);
}

}  // namespace

void install_fault_handler(int descriptor) {
    report_to = descriptor;
    stack_t stack{};
    stack.ss_sp = signal_stack;
    stack.ss_size = sizeof signal_stack;
    sigaltstack(&stack, nullptr);
    struct sigaction action {};
    action.sa_sigaction = &handle;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU}) sigaction(signal, &action, nullptr);
}

void set_subject_of_fault(const char* title) noexcept { subject_title = title; }
void set_call_of_fault(const char* function) noexcept { call_title = function; }

}  // namespace pelorus::conformance
