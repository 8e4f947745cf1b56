#include "watch.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <link.h>

#include <cstdio>
#include <cstring>

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

Guard::Guard(unsigned concerns) noexcept {
    first_seen = Offence();
    seen = &first_seen;
    watching = concerns;
}

Guard::~Guard() {
    if (!ended_) watching = 0;
}

Offence Guard::end() {
    watching = 0;
    ended_ = true;
    return first_seen;
}

}  // namespace watch

}  // namespace pelorus::conformance
