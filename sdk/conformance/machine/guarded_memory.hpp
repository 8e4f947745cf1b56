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

/// A guard page, the memory, a guard page; and the memory once more, for its owner, if the plugin only reads it.
struct GuardedMapping {
    unsigned char* begin = nullptr;
    unsigned char* owner = nullptr;  ///< the first byte of the memory where its owner may write it
    std::size_t size = 0;
};

/// What the plugin may do with memory that is lent to it.
enum class Lent { for_writing, for_reading };

class GuardedMemory {
public:
    /// `doubles` of them, ending at the guard page, filled with the pattern.
    GuardedMemory(std::size_t doubles, const ZoneName& name, Lent lent = Lent::for_writing);
    ~GuardedMemory();
    GuardedMemory(GuardedMemory&& other) noexcept;
    GuardedMemory& operator=(GuardedMemory&&) = delete;

    double* data() noexcept { return data_; }
    const double* data() const noexcept { return data_; }
    /// The same memory for its owner, who may write it where the plugin may not.
    double* fill() noexcept { return fill_; }
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
    Lent lent_;
    GuardedMapping mapping_;
    std::size_t doubles_ = 0;
    double *data_ = nullptr, *fill_ = nullptr;
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
