// The sizes for which the kernels are compiled: n in {4, 6, 9} x m in {2, 3}; all others at run-time size.
#include "kalman_kernels.hpp"

namespace kalman {

namespace {

constexpr int any = Eigen::Dynamic;

template <int N> Kernels kernels(int m) noexcept {
    if (m == 2) return {&update<N, 2>, &project<N, 2>};
    if (m == 3) return {&update<N, 3>, &project<N, 3>};
    return {&update<any, any>, &project<any, any>};
}

}  // namespace

PredictBlocks blocks_kernel(int b, int d) noexcept {
    if (b == 2 && d == 2) return &predict_blocks<2, 2>;
    if (b == 2 && d == 3) return &predict_blocks<2, 3>;
    if (b == 3 && d == 2) return &predict_blocks<3, 2>;
    if (b == 3 && d == 3) return &predict_blocks<3, 3>;
    return &predict_blocks<any, any>;
}

PredictFull full_kernel(int n) noexcept {
    if (n == 4) return &predict_full<4>;
    if (n == 6) return &predict_full<6>;
    if (n == 9) return &predict_full<9>;
    return &predict_full<any>;
}

Kernels measurement_kernels(int n, int m) noexcept {
    if (n == 4) return kernels<4>(m);
    if (n == 6) return kernels<6>(m);
    if (n == 9) return kernels<9>(m);
    return {&update<any, any>, &project<any, any>};
}

}  // namespace kalman
