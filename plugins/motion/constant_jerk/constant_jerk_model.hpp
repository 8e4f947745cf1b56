/// One axis of the (nearly) constant-jerk model, state (position, velocity, acceleration, jerk) [m, m/s, m/s2, m/s3].
/// Source: K. Mehrotra, P. R. Mahapatra, A jerk model for tracking highly maneuvering targets, IEEE Transactions on Aerospace and
/// Electronic Systems 33(4), 1094-1105, 1997, in the limit of a jerk that does not fade (a Wiener process); the discrete form
/// after Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley 2001, 6.3.
///
/// For dt < 0 the noise is that of the state as it was, given the state as it is: F(dt) Q(-dt) F(dt)'.
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>

namespace constant_jerk {

using pelorus::Matrix;
using pelorus::Vector;

/// F = [1 T T^2/2 T^3/6; 0 1 T T^2/2; 0 0 1 T; 0 0 0 1], dt in s.
inline Matrix<4> transition(double dt) {
    const double half = dt * dt / 2.0;
    Matrix<4> f;
    f << 1.0, dt, half, half * dt / 3.0, 0.0, 1.0, dt, half, 0.0, 0.0, 1.0, dt, 0.0, 0.0, 0.0, 1.0;
    return f;
}

/// Q_ij = T^(7-i-j) / ((3-i)! (3-j)! (7-i-j)), i, j = 0..3, of white noise of spectral density 1 m2/s7 that drives the jerk.
inline Matrix<4> continuous_noise(double dt) {
    const double factorials[] = {6.0, 2.0, 1.0, 1.0};
    double powers[8] = {1.0};
    for (int k = 1; k < 8; ++k) powers[k] = powers[k - 1] * dt;
    Matrix<4> q;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            const int power = 7 - i - j;
            q(i, j) = powers[power] / (factorials[i] * factorials[j] * power);
        }
    }
    // Backward F(T) Q(-T) F(T)' is -Q(T).
    return dt < 0.0 ? Matrix<4>(-q) : q;
}

/// g = [T^3/6; T^2/2; T; 1]: Q = g g' of an increment of the jerk that holds from the start of the step on, deviation 1 m/s3.
/// Backward, what was added at the start of the step is taken off the jerk alone.
inline Vector<4> discrete_factor(double dt) {
    if (dt < 0.0) return {0.0, 0.0, 0.0, 1.0};
    return transition(dt).col(3);
}

}  // namespace constant_jerk
