/// Memory between pages that nobody may touch: the first byte read or written past its end stops the plugin there and then, and
/// the report names the array, the function, and the plugin's line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace pelorus::conformance {

/// What a guarded zone is called in a report.
struct ZoneName {
    std::string function, array;
};

class GuardedMemory {
public:
    /// `doubles` of them, ending at the guard page, filled with the pattern.
    GuardedMemory(std::size_t doubles, const ZoneName& name);
    ~GuardedMemory();
    GuardedMemory(GuardedMemory&& other) noexcept;
    GuardedMemory& operator=(GuardedMemory&&) = delete;

    double* data() noexcept { return data_; }
    const double* data() const noexcept { return data_; }
    std::size_t size() const noexcept { return doubles_; }
    /// From now on a write stops the plugin.
    void make_read_only();
    /// From now on whoever touches any of it is stopped: it was lent for a call that is over.
    void take_back();
    /// Whether the bytes before the first double still hold the pattern.
    bool is_intact_before() const noexcept;

    /// The pattern, as a double (a NaN of a bit pattern that no computation yields).
    static double pattern() noexcept;
    static bool is_pattern(double value) noexcept;

private:
    unsigned char* mapping_ = nullptr;
    std::size_t mapped_ = 0, doubles_ = 0;
    double* data_ = nullptr;
    int zone_ = -1;
    bool is_read_only_ = false;
};

/// What stands at an address that a plugin must not touch.
struct ZoneHit {
    const char* function;
    const char* array;
    std::int64_t bytes;  ///< past the end; negative: before the beginning; within the array itself: 0 (it is read-only)
    bool is_read_only;   ///< the array's own memory
    bool is_taken_back;  ///< lent for a call that is over
};
/// For the handler of SIGSEGV: async-signal-safe.
bool find_zone(const void* address, ZoneHit& hit) noexcept;

}  // namespace pelorus::conformance
