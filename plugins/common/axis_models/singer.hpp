/// One axis of Singer's manoeuvre model: an acceleration that is a first-order Markov process of rate alpha (1/s) and
/// stationary deviation sigma (m/s2); state (position, velocity, acceleration) [m, m/s, m/s2].
/// Source: R. A. Singer, Estimating optimal tracking filter performance for manned maneuvering targets, IEEE Transactions on
/// Aerospace and Electronic Systems AES-6(4), 473-483, 1970.
///
/// Written with a = alpha T as powers of T times functions of a that are regular at a = 0, where the printed forms cancel
/// all digits (they divide 1e-15 by 1e-25 at a = 1e-5); those are used for |a| > 1 only.
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>

namespace singer {

using pelorus::Matrix;
using pelorus::Vector;

namespace detail {

/// sum over k >= first of (-1)^k weight(2^k, k) / k! a^(k - first), for |a| <= 1: the exponentials' series without the terms
/// that cancel.
template <class Weight> double series(int first, double a, Weight weight) {
    double inverse_factorial = 1.0, sign = 1.0, power_of_two = 1.0, power = 1.0, sum = 0.0;
    for (int k = 0; k < 30; ++k) {
        if (k > 0) {
            inverse_factorial /= k;
            sign = -sign;
            power_of_two *= 2.0;
        }
        if (k < first) continue;
        sum += sign * weight(power_of_two, static_cast<double>(k)) * inverse_factorial * power;
        power *= a;
    }
    return sum;
}

/// (1 - e^-a) / a.
inline double velocity_gain(double a) { return a == 0.0 ? 1.0 : -std::expm1(-a) / a; }

/// (a - 1 + e^-a) / a^2.
inline double position_gain(double a) {
    if (std::fabs(a) > 1.0) return (a + std::expm1(-a)) / (a * a);
    return series(2, a, [](double, double) { return 1.0; });
}

}  // namespace detail

/// F = [1 T (aT - 1 + e^-aT)/a^2; 0 1 (1 - e^-aT)/a; 0 0 e^-aT], with a the rate (1/s) and T = dt (s); exact for any sign of dt.
inline Matrix<3> exact_transition(double rate, double dt) {
    const double a = rate * dt;
    Matrix<3> f;
    f << 1.0, dt, dt * dt * detail::position_gain(a), 0.0, 1.0, dt * detail::velocity_gain(a), 0.0, 0.0, std::exp(-a);
    return f;
}

/// Q = 2 alpha times the integral of the response to unit white noise, for sigma = 1 m/s2.
/// For dt < 0: that of the state as it was, given the state as it is, F(dt) Q(-dt) F(dt)' (which equals -Q(dt)).
inline Matrix<3> exact_noise(double rate, double dt) {
    using detail::series;
    const double a = rate * dt;
    const double once = std::exp(-a), twice = std::exp(-2.0 * a);
    // Bracketed terms of Singer's q11, q12, q13, q22 over a^5, a^4, a^3, a^3.
    double pp, pv, pa, vv;
    if (std::fabs(a) > 1.0) {
        const double a2 = a * a, a3 = a2 * a;
        pp = (1.0 - twice + 2.0 * a + 2.0 * a3 / 3.0 - 2.0 * a2 - 4.0 * a * once) / (a3 * a2);
        pv = (twice + 1.0 - 2.0 * once + 2.0 * a * once - 2.0 * a + a2) / (a2 * a2);
        pa = (1.0 - twice - 2.0 * a * once) / a3;
        vv = (4.0 * once - 3.0 - twice + 2.0 * a) / a3;
    } else {
        pp = series(5, a, [](double two_to_k, double k) { return 4.0 * k - two_to_k; });
        pv = series(4, a, [](double two_to_k, double k) { return two_to_k - 2.0 - 2.0 * k; });
        pa = series(3, a, [](double two_to_k, double k) { return 2.0 * k - two_to_k; });
        vv = series(3, a, [](double two_to_k, double) { return 4.0 - two_to_k; });
    }
    const double va = detail::velocity_gain(a) * detail::velocity_gain(a), aa = 2.0 * detail::velocity_gain(2.0 * a);
    const double span = std::fabs(dt), square = dt * dt, odd = span * dt;
    Matrix<3> q;
    q << span * square * square * pp, odd * square * pv, span * square * pa,  //
        odd * square * pv, span * square * vv, odd * va,                      //
        span * square * pa, odd * va, span * aa;
    return rate * q;
}

/// F = [1 T T^2/2; 0 1 T; 0 0 e^-aT]: the constant-acceleration model whose acceleration fades; dt >= 0.
inline Matrix<3> truncated_transition(double rate, double dt) {
    Matrix<3> f;
    f << 1.0, dt, dt * dt / 2.0, 0.0, 1.0, dt, 0.0, 0.0, std::exp(-rate * dt);
    return f;
}

/// g = [T^2/2; T; 1]: Q = g g' for sigma = 1 m/s2; dt >= 0.
inline Vector<3> truncated_factor(double dt) { return {dt * dt / 2.0, dt, 1.0}; }

}  // namespace singer
