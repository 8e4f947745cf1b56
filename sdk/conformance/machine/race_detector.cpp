#include "race_detector.hpp"

#include <mutex>

#include "watch.hpp"

#if defined(__SANITIZE_THREAD__)

namespace {

std::mutex mutex;
std::string first;

}  // namespace

// Of ThreadSanitizer's interface for debuggers.
extern "C" {
int __tsan_get_report_data(void* report, const char** description, int* count, int* stack_count, int* access_count,
                           int* place_count, int* mutex_count, int* thread_count, int* unique_count, void** sleep,
                           unsigned long trace_size);
int __tsan_get_report_mop(void* report, unsigned long index, int* thread, void** address, int* size, int* is_write,
                          int* is_atomic, void** trace, unsigned long trace_size);

/// Called by the sanitizer for each report.
void __tsan_on_report(void* report) {
    constexpr unsigned long depth = 16;
    const char* description = "";
    int count = 0, stacks = 0, accesses = 0, places = 0, mutexes = 0, threads = 0, unique = 0;
    void* sleep[depth] = {};
    __tsan_get_report_data(report, &description, &count, &stacks, &accesses, &places, &mutexes, &threads, &unique,
                           sleep, depth);
    std::string text = description;
    for (int access = 0; access < accesses; ++access) {
        int thread = 0, size = 0, is_write = 0, is_atomic = 0;
        void *address = nullptr, *trace[depth] = {};
        __tsan_get_report_mop(report, static_cast<unsigned long>(access), &thread, &address, &size, &is_write,
                              &is_atomic, trace, depth);
        text += access == 0 ? ": " : ", ";
        text += is_write != 0 ? "written at " : "read at ";
        text += pelorus::conformance::place_of(trace[0]);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    if (first.empty()) first = text;
}
}

namespace pelorus::conformance::race_detector {
bool is_available() noexcept { return true; }
void forget() noexcept {
    const std::lock_guard<std::mutex> lock(mutex);
    first.clear();
}
std::string first_race() {
    const std::lock_guard<std::mutex> lock(mutex);
    return first;
}
}  // namespace pelorus::conformance::race_detector

#else

namespace pelorus::conformance::race_detector {
bool is_available() noexcept { return false; }
void forget() noexcept {}
std::string first_race() { return {}; }
}  // namespace pelorus::conformance::race_detector

#endif
