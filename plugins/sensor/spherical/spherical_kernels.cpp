#include "spherical_kernels.hpp"

namespace spherical_kernels {

// spherical_lanes.cpp, once for each instruction set.
namespace baseline {
extern const Kernels kernels;
}
#if defined(__x86_64__)
namespace avx2 {
extern const Kernels kernels;
}
namespace avx512 {
extern const Kernels kernels;
}
#endif

const Kernels& kernels([[maybe_unused]] lanes::InstructionSet set) noexcept {
#if defined(__x86_64__)
    if (set == lanes::InstructionSet::avx512) return avx512::kernels;
    if (set == lanes::InstructionSet::avx2) return avx2::kernels;
#endif
    return baseline::kernels;
}

}  // namespace spherical_kernels
