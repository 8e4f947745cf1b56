#include "factor_kernels.hpp"

namespace gaussian {

// state_lanes.cpp and its neighbours, once for each instruction set.
namespace baseline {
extern const FactorKernels kernels;
}
#if defined(__x86_64__)
namespace avx2 {
extern const FactorKernels kernels;
}
namespace avx512 {
extern const FactorKernels kernels;
}
#endif

const FactorKernels& factor_kernels([[maybe_unused]] lanes::InstructionSet set) noexcept {
#if defined(__x86_64__)
    if (set == lanes::InstructionSet::avx512) return avx512::kernels;
    if (set == lanes::InstructionSet::avx2) return avx2::kernels;
#endif
    return baseline::kernels;
}

Image image_of(const Points& points, int rows, bool is_linear, double* kept) noexcept {
    Image image{kept, points.size, 0, false};
    if (is_linear) return image;
    const double weight = points.centre_weight;
    image.columns = points.is_star ? points.size + (weight > 0.0 ? 1 : 0) : rows;
    image.has_downdate = weight < 0.0;
    return image;
}

}  // namespace gaussian
