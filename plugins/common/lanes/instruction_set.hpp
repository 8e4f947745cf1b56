/// For which instruction set a kernel over lanes is taken. Results do not depend on it (see pack.hpp), times do.
#pragma once

#include <array>

namespace lanes {

enum class InstructionSet { baseline, avx2, avx512 };

constexpr std::array<InstructionSet, 3> instruction_sets{InstructionSet::baseline, InstructionSet::avx2,
                                                         InstructionSet::avx512};

/// True where this build has kernels of a set and this processor knows it.
inline bool is_supported(InstructionSet set) noexcept {
#if defined(__x86_64__)
    if (set == InstructionSet::avx512) return __builtin_cpu_supports("avx512f") != 0;
    if (set == InstructionSet::avx2) return __builtin_cpu_supports("avx2") != 0;
#endif
    return set == InstructionSet::baseline;
}

/// The widest set that this processor knows.
inline InstructionSet best_instruction_set() noexcept {
    InstructionSet best = InstructionSet::baseline;
    for (const InstructionSet set : instruction_sets)
        if (is_supported(set)) best = set;
    return best;
}

/// A kernel for few items and one for many: where there are hardly any to fill the lanes, narrow ones take less time.
template <class Kernel> struct ByItems {
    Kernel few, many;

    /// For as many items as a call has. The baseline has two lanes on every processor.
    Kernel operator()(long long items) const noexcept { return items <= 2 ? few : many; }
};

}  // namespace lanes
