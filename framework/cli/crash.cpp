#include "cli/crash.hpp"

#include <fcntl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>

#include "host/alternate_stack.hpp"
#include "host/breadcrumb.hpp"

// Everything below that runs in a signal handler is async-signal-safe: no memory is taken, no lock, nothing of stdio.

/// Of the sanitizers' runtimes, where one is linked in.
extern "C" void __sanitizer_set_death_callback(void (*callback)()) __attribute__((weak));

namespace pelorus::cli {

namespace {

char folder[4096] = "";        // as the user named it; "" : no run is under way
char last_words[512] = "";     // of the exception that ended in std::terminate
std::atomic<pid_t> teller{0};  // the thread that tells

/// A line that is put together in place.
class Line {
public:
    Line& operator<<(const char* text) noexcept {
        for (; text != nullptr && *text != '\0' && size_ < sizeof text_ - 1; ++text) {
            const auto byte = static_cast<unsigned char>(*text);
            text_[size_++] = byte < 0x20 || byte == 0x7F ? ' ' : *text;
        }
        return *this;
    }
    Line& operator<<(std::uint64_t number) noexcept {
        char digits[24];
        std::size_t at = sizeof digits - 1;
        digits[at] = '\0';
        do digits[--at] = static_cast<char>('0' + number % 10);
        while ((number /= 10) != 0);
        return *this << digits + at;
    }
    /// ns as seconds, as elsewhere in messages.
    Line& seconds(std::int64_t time) noexcept {
        const std::uint64_t size = time < 0 ? 0 - static_cast<std::uint64_t>(time) : static_cast<std::uint64_t>(time);
        char fraction[11] = ".000000000";
        std::uint64_t rest = size % 1'000'000'000u;
        for (std::size_t at = 9; at > 0; --at, rest /= 10) fraction[at] = static_cast<char>('0' + rest % 10);
        std::size_t end = 10;  // no zeros at the end, and no bare point
        while (end > 1 && fraction[end - 1] == '0') --end;
        fraction[end > 1 ? end : 0] = '\0';
        return *this << (time < 0 ? "-" : "") << size / 1'000'000'000u << fraction << " s";
    }
    void write() noexcept {
        text_[size_++] = '\n';
        for (std::size_t done = 0; done < size_;) {
            const ::ssize_t written = ::write(STDERR_FILENO, text_ + done, size_ - done);
            if (written <= 0) return;
            done += static_cast<std::size_t>(written);
        }
    }

private:
    char text_[8192];
    std::size_t size_ = 0;
};

const char* name_of(int number) noexcept {
    switch (number) {
        case SIGSEGV:
            return "SIGSEGV";
        case SIGBUS:
            return "SIGBUS";
        case SIGFPE:
            return "SIGFPE";
        case SIGILL:
            return "SIGILL";
        default:
            return "SIGABRT";
    }
}

/// Whether a fault lies where the stack would have grown to.
bool is_stack_overflow(const siginfo_t* info, const void* context) noexcept {
#if defined(__x86_64__) || defined(__aarch64__)
    if (info == nullptr || context == nullptr) return false;
    const auto& machine = static_cast<const ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
    const auto stack = static_cast<std::uintptr_t>(machine.gregs[REG_RSP]);
#else
    const auto stack = static_cast<std::uintptr_t>(machine.sp);
#endif
    constexpr std::uintptr_t near = 128u << 10;  // a frame with an array may step over the guard page
    const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
    return address + near > stack && address < stack + near;
#else
    (void)info, (void)context;
    return false;
#endif
}

/// Names of the folder's files that end in `.part`, told as `A, B`. Answers how many.
unsigned list_partial_files(Line& line) noexcept {
    struct Entry {  // linux_dirent64
        std::uint64_t inode;
        std::int64_t offset;
        unsigned short size;
        unsigned char type;
        char name[1];
    };
    const int descriptor = ::open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return 0;
    unsigned found = 0;
    alignas(Entry) char buffer[4096];
    for (long size = 0; (size = ::syscall(SYS_getdents64, descriptor, buffer, sizeof buffer)) > 0;)
        for (long at = 0; at < size;) {
            const auto* entry = reinterpret_cast<const Entry*>(buffer + at);
            const std::size_t length = std::strlen(entry->name);
            if (length > 5 && std::memcmp(entry->name + length - 5, ".part", 5) == 0)
                line << (found++ == 0 ? "" : ", ") << entry->name;
            at += entry->size;
        }
    ::close(descriptor);
    return found;
}

/// `tracker.estimator.motion (motion.singer)`
void name_subject(Line& line, const host::CallMark& mark) noexcept {
    line << mark.subject;
    if (mark.plugin != nullptr && *mark.plugin != '\0') line << " (" << mark.plugin << ")";
}

/// The node and its call, where one is at work; answers the call in which it happened, or nullptr.
const host::CallMark* begin_line(Line& line) noexcept {
    const host::CallMark* const innermost = host::innermost_call;
    line << "pelorus: ";
    for (const host::CallMark* mark = innermost; mark != nullptr; mark = mark->outer) {
        if (!mark->is_node) continue;
        line << "node ";
        name_subject(line, *mark);
        line << ", " << mark->call;
        if (mark->port != nullptr) line << " " << mark->port;
        line << " at ";
        line.seconds(mark->time) << ": ";
        break;
    }
    return innermost;
}

void end_line(Line& line, const host::CallMark* innermost) noexcept {
    if (innermost != nullptr) {
        line << " in ";
        if (!innermost->is_node) line << innermost->call << " of ";
        if (innermost->is_node)
            line << innermost->plugin;
        else
            name_subject(line, *innermost);
    }
    if (folder[0] != '\0') {
        line << "; incomplete files in " << folder << ": ";
        if (list_partial_files(line) == 0) line << "none";
    }
    line.write();
}

/// The first thread that crashes tells of it; another one waits until that has ended the process.
void wait_for_turn() noexcept {
    const auto self = static_cast<pid_t>(::syscall(SYS_gettid));
    pid_t first = 0;
    if (teller.compare_exchange_strong(first, self)) return;
    if (first == self) ::_exit(1);  // it crashed while it was told
    for (;;) ::pause();
}

extern "C" void tell_crash(int number, siginfo_t* info, void* context) {
    wait_for_turn();
    Line line;
    const host::CallMark* const innermost = begin_line(line);
    line << "crashed (" << name_of(number);
    if ((number == SIGSEGV || number == SIGBUS) && is_stack_overflow(info, context)) line << ", stack overflow";
    if (number == SIGABRT && last_words[0] != '\0') line << ", " << last_words;
    line << ")";
    end_line(line, innermost);
    ::_exit(1);
}

/// The sanitizer has reported a crash, or leaks at the end of the process; then no call is under way.
void tell_death() {
    if (host::innermost_call == nullptr) return;
    wait_for_turn();
    Line line;
    const host::CallMark* const innermost = begin_line(line);
    line << "crashed (see the sanitizer's report)";
    end_line(line, innermost);
}

void keep_last_words(const char* text, const char* more) noexcept {
    std::strncat(last_words, text, sizeof last_words - 1 - std::strlen(last_words));
    std::strncat(last_words, more, sizeof last_words - 1 - std::strlen(last_words));
}

/// Instead of the C++ library's, which writes lines of its own.
[[noreturn]] void end_by_exception() {
    try {
        if (std::current_exception() != nullptr) throw;
        keep_last_words("std::terminate", "");
    } catch (const std::exception& exception) {
        keep_last_words("exception: ", exception.what());
    } catch (...) {
        keep_last_words("exception of a type that is no std::exception", "");
    }
    std::abort();
}

}  // namespace

void tell_crashes() {
    static const host::AlternateStack stack;
    std::set_terminate(&end_by_exception);
    if (__sanitizer_set_death_callback != nullptr) __sanitizer_set_death_callback(&tell_death);
    struct sigaction action {};
    action.sa_sigaction = &tell_crash;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
        struct sigaction before {};
        sigaction(number, nullptr, &before);
        const bool is_free = (before.sa_flags & SA_SIGINFO) == 0 && before.sa_handler == SIG_DFL;
        if (is_free) sigaction(number, &action, nullptr);
    }
}

CrashFolder::CrashFolder(const std::filesystem::path& path) {
    const std::string name = path.string();
    if (name.size() < sizeof folder) std::memcpy(folder, name.c_str(), name.size() + 1);
}

CrashFolder::~CrashFolder() { folder[0] = '\0'; }

}  // namespace pelorus::cli
