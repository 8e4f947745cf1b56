/// A turn at rate w (rad/s) for T seconds, as functions of a = w T that are regular at a = 0: with S = sin(a)/a and
/// C = (1 - cos(a))/a a velocity (vx, vy) moves the position by T (S vx - C vy, C vx + S vy).
#pragma once

#include <cmath>

struct Turn {
    double sine, cosine;       // of a
    double along, across;      // S, C
    double d_along, d_across;  // dS/da, dC/da
    explicit Turn(double a);
};

namespace turn_detail {

/// Sum of the first terms of coefficient[0] + coefficient[1] a^2 + coefficient[2] a^4 + ...
template <int Terms> double even_series(const double (&coefficient)[Terms], double a) {
    double sum = 0;
    for (int k = Terms - 1; k >= 0; --k) sum = sum * a * a + coefficient[k];
    return sum;
}

}  // namespace turn_detail

inline Turn::Turn(double a) : sine(std::sin(a)), cosine(std::cos(a)) {
    if (std::fabs(a) < 0.25) {
        // The closed forms of the derivatives lose all digits at a = 0: there the series, whose next term is below 1e-17.
        static constexpr double along_terms[] = {1, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800};
        static constexpr double across_terms[] = {1.0 / 2,      -1.0 / 24,     1.0 / 720,
                                                  -1.0 / 40320, 1.0 / 3628800, -1.0 / 479001600};
        static constexpr double d_along_terms[] = {-1.0 / 3,    1.0 / 30,       -1.0 / 840,
                                                   1.0 / 45360, -1.0 / 3991680, 1.0 / 518918400};
        static constexpr double d_across_terms[] = {1.0 / 2,     -1.0 / 8,     1.0 / 144,
                                                    -1.0 / 5760, 1.0 / 403200, -1.0 / 43545600};
        along = turn_detail::even_series(along_terms, a);
        across = a * turn_detail::even_series(across_terms, a);
        d_along = a * turn_detail::even_series(d_along_terms, a);
        d_across = turn_detail::even_series(d_across_terms, a);
    } else {
        const double half = std::sin(a / 2);
        along = sine / a;
        across = 2 * half * half / a;
        d_along = (cosine - along) / a;
        d_across = (sine - across) / a;
    }
}
