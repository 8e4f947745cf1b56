#include "watch.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <link.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "fault_handler.hpp"
#include "watched_functions.hpp"

namespace pelorus::conformance {

namespace {

struct Range {
    std::uintptr_t first = 0, end = 0, base = 0;
    char path[4096] = {};
};
Range watched_range;

int find_range(dl_phdr_info* info, std::size_t, void* symbol) {
    for (int i = 0; i < info->dlpi_phnum; ++i) {
        const auto& header = info->dlpi_phdr[i];
        if (header.p_type != PT_LOAD) continue;
        const std::uintptr_t first = info->dlpi_addr + header.p_vaddr, end = first + header.p_memsz;
        const auto at = reinterpret_cast<std::uintptr_t>(symbol);
        if (at < first || at >= end) continue;
        watched_range.base = info->dlpi_addr;
        watched_range.first = UINTPTR_MAX;
        watched_range.end = 0;
        for (int k = 0; k < info->dlpi_phnum; ++k) {
            const auto& each = info->dlpi_phdr[k];
            if (each.p_type != PT_LOAD || (each.p_flags & PF_X) == 0) continue;
            watched_range.first = std::min<std::uintptr_t>(watched_range.first, info->dlpi_addr + each.p_vaddr);
            watched_range.end =
                std::max<std::uintptr_t>(watched_range.end, info->dlpi_addr + each.p_vaddr + each.p_memsz);
        }
        return 1;
    }
    return 0;
}

std::string mark(std::uintptr_t offset, const char* path) {
    char text[4200];
    std::snprintf(text, sizeof text, "<<%s+0x%zx>>", path, static_cast<std::size_t>(offset));
    return text;
}

}  // namespace

void set_watched_library(const std::string& path, const void* symbol) noexcept {
    std::snprintf(watched_range.path, sizeof watched_range.path, "%s", path.c_str());
    dl_iterate_phdr(&find_range, const_cast<void*>(symbol));
    void* frames[2];
    backtrace(frames, 2);  // loads the unwinder, which must not happen while something is watched
}

std::string place_of(const void* address) {
    const auto at = reinterpret_cast<std::uintptr_t>(address);
    if (at >= watched_range.first && at < watched_range.end) return mark(at - watched_range.base, watched_range.path);
    Dl_info info{};
    if (dladdr(address, &info) == 0 || info.dli_fname == nullptr) return {};
    return mark(at - reinterpret_cast<std::uintptr_t>(info.dli_fbase), info.dli_fname);
}

std::string place_of_caller() {
    void* frames[64];
    const int depth = backtrace(frames, 64);
    for (int i = 0; i < depth; ++i) {
        const auto at = reinterpret_cast<std::uintptr_t>(frames[i]);
        // One byte back: a return address is behind the call.
        if (at >= watched_range.first && at < watched_range.end)
            return mark(at - 1 - watched_range.base, watched_range.path);
    }
    return {};
}

namespace {

int tell_static_write = -1;

/// The writable segments of the library under test, without what the loader has made read-only already.
int protect_writable(dl_phdr_info* info, std::size_t, void*) {
    if (info->dlpi_addr != watched_range.base) return 0;
    std::uintptr_t relocated_end = 0;
    for (int i = 0; i < info->dlpi_phnum; ++i) {
        const auto& header = info->dlpi_phdr[i];
        if (header.p_type == PT_GNU_RELRO) relocated_end = info->dlpi_addr + header.p_vaddr + header.p_memsz;
    }
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    for (int i = 0; i < info->dlpi_phnum; ++i) {
        const auto& header = info->dlpi_phdr[i];
        if (header.p_type != PT_LOAD || (header.p_flags & PF_W) == 0) continue;
        const std::uintptr_t first = info->dlpi_addr + header.p_vaddr, end = first + header.p_memsz;
        const std::uintptr_t from = std::max(first, std::min(relocated_end, end)) / page * page;
        if (from < end) mprotect(reinterpret_cast<void*>(from), end - from, PROT_READ);
    }
    return 1;
}

void tell_place_of_write(int, siginfo_t*, void* context) {
    const std::string place = place_of(instruction_of(context));
    if (write(tell_static_write, place.data(), place.size()) < 0) _exit(2);
    _exit(1);
}

}  // namespace

std::string place_of_static_write(const std::function<void()>& body) {
    int ends[2];
    if (pipe(ends) != 0) return {};
    const pid_t process = fork();
    if (process == 0) {
        tell_static_write = ends[1];
        struct sigaction action {};
        action.sa_sigaction = &tell_place_of_write;
        action.sa_flags = SA_SIGINFO | SA_ONSTACK;
        sigaction(SIGSEGV, &action, nullptr);
        dl_iterate_phdr(&protect_writable, nullptr);
        body();
        _exit(0);
    }
    close(ends[1]);
    char text[4300];
    const ssize_t got = process < 0 ? 0 : read(ends[0], text, sizeof text);
    close(ends[0]);
    if (process > 0) waitpid(process, nullptr, 0);
    return got <= 0 ? std::string() : std::string(text, static_cast<std::size_t>(got));
}

namespace watch {

namespace {
thread_local unsigned watching = 0;
thread_local Offence* seen = nullptr;
thread_local Offence first_seen;
}  // namespace

void observe(Concern concern, const char* function) noexcept {
    if ((watching & static_cast<unsigned>(concern)) == 0) return;
    const unsigned kept = watching;
    watching = 0;  // what follows allocates
    Offence& offence = *seen;
    ++offence.count;
    if (offence.function == nullptr) {
        offence.function = function;
        offence.place = place_of_caller();
    }
    watching = kept;
}

void Offence::add(const Offence& later) {
    if (function == nullptr) function = later.function, place = later.place;
    count += later.count;
}

void report(const Offence& offence) {
    if (seen != nullptr) seen->add(offence);
}

Guard::Guard(unsigned concerns) noexcept {
    first_seen = Offence();
    seen = &first_seen;
    watching = concerns;
}

unsigned pause() noexcept {
    const unsigned kept = watching;
    watching = 0;
    return kept;
}
void resume(unsigned concerns) noexcept { watching = concerns; }

Guard::~Guard() {
    if (!ended_) watching = 0;
}

HostWork::HostWork() noexcept : watching_(watching), until_failure_(fail_allocation(-1)) { watching = 0; }

HostWork::~HostWork() {
    watching = watching_;
    fail_allocation(until_failure_);
}

Offence Guard::end() {
    watching = 0;
    ended_ = true;
    return first_seen;
}

}  // namespace watch

}  // namespace pelorus::conformance
