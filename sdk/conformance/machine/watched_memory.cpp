// malloc and its kin, seen and counted. Built into the runner unless sanitizers do the same.
#include <atomic>
#include <cerrno>
#include <cstddef>

#include "watched_functions.hpp"

#if defined(PELORUS_CONFORM_WATCHES)

// glibc's own entry points behind the public names.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace {

using pelorus::conformance::watch::Concern;

std::atomic<std::int64_t> in_use{0};
thread_local std::int64_t until_failure = -1;

bool fails() noexcept { return until_failure >= 0 && until_failure-- == 0; }

void* counted(void* block) noexcept {
    if (block != nullptr) in_use.fetch_add(1, std::memory_order_relaxed);
    return block;
}

}  // namespace

namespace pelorus::conformance::watch {
bool is_available() noexcept { return true; }
std::int64_t blocks_in_use() noexcept { return in_use.load(std::memory_order_relaxed); }
std::int64_t fail_allocation(std::int64_t n) noexcept {
    const std::int64_t left = until_failure;
    until_failure = n;
    return left;
}
}  // namespace pelorus::conformance::watch

extern "C" {
void* malloc(std::size_t size) {
    pelorus::conformance::watch::observe(Concern::memory, "malloc");
    return fails() ? nullptr : counted(__libc_malloc(size));
}
void* calloc(std::size_t count, std::size_t size) {
    pelorus::conformance::watch::observe(Concern::memory, "calloc");
    return fails() ? nullptr : counted(__libc_calloc(count, size));
}
void* realloc(void* block, std::size_t size) {
    pelorus::conformance::watch::observe(Concern::memory, "realloc");
    if (fails()) return nullptr;
    void* const moved = __libc_realloc(block, size);
    if (block == nullptr) return counted(moved);
    if (size == 0) in_use.fetch_sub(1, std::memory_order_relaxed);
    return moved;
}
void* memalign(std::size_t alignment, std::size_t size) {
    pelorus::conformance::watch::observe(Concern::memory, "memalign");
    return fails() ? nullptr : counted(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    pelorus::conformance::watch::observe(Concern::memory, "aligned_alloc");
    return fails() ? nullptr : counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
    pelorus::conformance::watch::observe(Concern::memory, "posix_memalign");
    void* const block = fails() ? nullptr : counted(__libc_memalign(alignment, size));
    if (block == nullptr) return ENOMEM;
    *out = block;
    return 0;
}
void free(void* block) {
    if (block == nullptr) return;
    in_use.fetch_sub(1, std::memory_order_relaxed);
    __libc_free(block);
}
}

#else

namespace pelorus::conformance::watch {
bool is_available() noexcept { return false; }
std::int64_t blocks_in_use() noexcept { return 0; }
std::int64_t fail_allocation(std::int64_t) noexcept { return -1; }
}  // namespace pelorus::conformance::watch

#endif
