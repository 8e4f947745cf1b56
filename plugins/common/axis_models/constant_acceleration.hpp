/// One axis of the (nearly) constant-acceleration model, state (position, velocity, acceleration) [m, m/s, m/s2].
/// Source: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley 2001:
/// 6.2.3 (continuous white noise jerk, the Wiener-process acceleration), 6.3.3 (piecewise constant increments of it).
///
/// For dt < 0 the noise is that of the state as it was, given the state as it is: F(dt) Q(-dt) F(dt)'.
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>

namespace constant_acceleration {

using pelorus::Matrix;
using pelorus::Vector;

/// F = [1 T T^2/2; 0 1 T; 0 0 1], dt in s.
inline Matrix<3> transition(double dt) {
    Matrix<3> f;
    f << 1.0, dt, dt * dt / 2.0, 0.0, 1.0, dt, 0.0, 0.0, 1.0;
    return f;
}

/// Q = [T^5/20 T^4/8 T^3/6; . T^3/3 T^2/2; . . T] of white jerk of spectral density 1 m2/s5.
inline Matrix<3> continuous_noise(double dt) {
    const double span = std::fabs(dt), square = dt * dt;
    const double pv = span * dt * square / 8.0, pa = span * square / 6.0, va = span * dt / 2.0;
    Matrix<3> q;
    q << span * square * square / 20.0, pv, pa, pv, span * square / 3.0, va, pa, va, span;
    return q;
}

/// g = [T^2/2; T; 1]: Q = g g' of an increment of the acceleration that holds from the start of the step on, deviation
/// 1 m/s2. Backward, what was added at the start of the step is taken off the acceleration alone.
inline Vector<3> discrete_factor(double dt) {
    if (dt < 0.0) return {0.0, 0.0, 1.0};
    return {dt * dt / 2.0, dt, 1.0};
}

}  // namespace constant_acceleration
