/// Arrays out of one block of memory: a partitioner's calls do not allocate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <pelorus/parts.hpp>

namespace partition {

/// Hands out arrays of a block, one behind the other; nothing is given back before the block itself is. [worker, exclusive]
class Memory {
public:
    Memory(void* block, std::size_t bytes) : at_(static_cast<unsigned char*>(block)), end_(at_ + bytes) {}

    /// `count` elements, not initialised. Throws Failure(PLR_E_SCRATCH) where the block is used up.
    template <class T> T* take(std::size_t count) {
        static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= step);
        const std::size_t bytes = (count * sizeof(T) + step - 1) / step * step;
        if (bytes > static_cast<std::size_t>(end_ - at_))
            throw pelorus::Failure(PLR_E_SCRATCH, "needs more scratch memory than its info told");
        T* const array = reinterpret_cast<T*>(at_);
        at_ += bytes;
        return array;
    }

    static constexpr std::size_t step = 16;  ///< and alignment, that of the largest types of the compiler

private:
    unsigned char *at_, *end_;
};

/// What a partitioner's info asks for, and the memory of one call that this comes to. `fixed` covers what alignment takes.
struct Need {
    std::size_t fixed = 0, per_point = 0;  ///< bytes; a prediction counts as a point

    constexpr Need operator+(const Need& other) const noexcept {
        return {fixed + other.fixed, per_point + other.per_point};
    }
    constexpr std::size_t bytes(std::int64_t points) const noexcept {
        return fixed + per_point * static_cast<std::size_t>(points);
    }
};

/// An array of one T for each point and `more` T beside them.
template <class T> constexpr Need array(std::size_t more = 0) noexcept {
    return {more * sizeof(T) + Memory::step, sizeof(T)};
}

/// The scratch memory of one call, given back when the object dies.
class CallMemory {
public:
    CallMemory(const plr_call& call, const Need& need, std::int64_t points)
        : scratch_(call, static_cast<std::int64_t>(need.bytes(points) / sizeof(double) + 1)),
          memory_(scratch_.data(), need.bytes(points) / sizeof(double) * sizeof(double) + sizeof(double)) {}
    operator Memory&() noexcept { return memory_; }

private:
    pelorus::Scratch scratch_;
    Memory memory_;
};

/// Writes into info what CallMemory will take: the need, a rounding, and the alignment of the scratch stack.
template <class Info> void tell(const Need& need, Info& info) noexcept {
    info.scratch_bytes = need.fixed + 64 + sizeof(double);
    info.scratch_bytes_point = need.per_point;
}

}  // namespace partition
