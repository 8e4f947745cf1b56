/// Process noise of white acceleration upon positions and velocities.
/// Source: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley 2001,
/// 6.2.2 (continuous) and 6.3.2 (constant over the step).
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

namespace kinematics {

/// Q = [T^3/3 T^2/2; T^2/2 T] (m2, m2/s, m2/s2), T = |dt|, of white acceleration of spectral density 1 m2/s3.
inline pelorus::Matrix<2> white_acceleration(double dt) {
    const double span = std::fabs(dt);
    pelorus::Matrix<2> q;
    q << span * span * span / 3.0, span * span / 2.0, span * span / 2.0, span;
    return q;
}

/// Adds Q on every axis to a covariance that begins with D positions and D velocities. `unit` is Q of one axis for intensity 1.
template <int D, int N>
void add_per_axis(const pelorus::Matrix<2>& unit, const pelorus::Vector<D>& intensity, pelorus::Matrix<N>& out) {
    for (int row = 0; row < 2; ++row)
        for (int col = 0; col < 2; ++col)
            for (int axis = 0; axis < D; ++axis)
                out(row * D + axis, col * D + axis) += unit(row, col) * intensity(axis);
}

/// The noise of a step backward, F Q F': that of the state as it was, given the state as it is; F = F(dt), Q = Q(-dt).
template <int N> pelorus::Matrix<N> carried_back(const pelorus::Matrix<N>& f, const pelorus::Matrix<N>& q) {
    pelorus::Matrix<N> out;
    pelorus::small::symmetric_product(f, q, out);
    return out;
}

}  // namespace kinematics
