/// One axis of the (nearly) constant-velocity model, state (position, velocity) [m, m/s].
/// Source: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley 2001:
/// 6.2.2 (continuous white noise acceleration), 6.3.2 (piecewise constant white acceleration).
///
/// For dt < 0 the noise is that of the state as it was, given the state as it is: F(dt) Q(-dt) F(dt)'.
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>

namespace constant_velocity {

using pelorus::Matrix;
using pelorus::Vector;

/// F = [1 T; 0 1], dt in s.
inline Matrix<2> transition(double dt) {
    Matrix<2> f;
    f << 1.0, dt, 0.0, 1.0;
    return f;
}

/// Q = [T^3/3 T^2/2; T^2/2 T] of white acceleration of spectral density 1 m2/s3.
inline Matrix<2> continuous_noise(double dt) {
    const double span = std::fabs(dt);
    Matrix<2> q;
    q << span * dt * dt / 3.0, span * dt / 2.0, span * dt / 2.0, span;
    return q;
}

/// g = [T^2/2; T]: Q = g g' of an acceleration that is constant over the step, deviation 1 m/s2.
inline Vector<2> discrete_factor(double dt) { return {std::fabs(dt) * dt / 2.0, std::fabs(dt)}; }

}  // namespace constant_velocity
