/// The functions that turns are made of, regular where the angle vanishes and accurate on both sides of it.
#pragma once

#include <cmath>

namespace kinematics {

/// sin(x) / x, x in rad.
inline double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(x) / x; }

/// sinc'(x) / x = (x cos x - sin x) / x^3, which is -1/3 at 0. The printed form loses x^-2 of its digits, so that below 1 the
/// series sum over k >= 1 of (-1)^k 2k x^(2k - 2) / (2k + 1)! stands for it.
inline double sinc_slope_ratio(double x) {
    const double square = x * x;
    if (square > 1.0) return (x * std::cos(x) - std::sin(x)) / (square * x);
    double term = -1.0 / 6.0, sum = 0.0;  // (-1)^k x^(2k - 2) / (2k + 1)!
    for (int k = 1; k < 12; ++k) {
        sum += 2.0 * k * term;
        term *= -square / ((2.0 * k + 2.0) * (2.0 * k + 3.0));
    }
    return sum;
}

/// Where a point is after a turn by `angle` (rad), as parts of the length of its way: `along` the first direction and
/// `across`, towards which it turns; and how both change with the angle.
struct Arc {
    explicit Arc(double angle) {
        const double half = sinc(angle / 2.0);
        along = sinc(angle);
        across = angle / 2.0 * half * half;  // (1 - cos angle) / angle without the difference
        along_slope = angle * sinc_slope_ratio(angle);
        across_slope = along - half * half / 2.0;
    }
    double along, across, along_slope, across_slope;
};

}  // namespace kinematics
