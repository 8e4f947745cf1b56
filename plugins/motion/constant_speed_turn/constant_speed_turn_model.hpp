/// One axis of a turn at constant speed in any plane: p' = v, v' = a, a' = -w^2 v + white jerk, for a turn rate w (rad/s) that is
/// given as its square u = w^2, of which everything is a smooth function. State (position, velocity, acceleration).
/// Source: X. R. Li, V. P. Jilkov, Survey of maneuvering target tracking, part I: dynamic models, IEEE Transactions on Aerospace
/// and Electronic Systems 39(4), 1333-1364, 2003 (models in three dimensions).
#pragma once

#include "../../common/kinematics/sinc.hpp"

#include <pelorus/matrix.hpp>

namespace constant_speed_turn {

using pelorus::Matrix;
using pelorus::Vector;

/// F = [1 sin(wT)/w (1 - cos(wT))/w^2; 0 cos(wT) sin(wT)/w; 0 -w sin(wT) cos(wT)] and d F / d u; dt of any sign.
struct Transition {
    Transition(double square, double dt) {
        const double angle = std::sqrt(square) * dt, half = kinematics::sinc(angle / 2.0), t2 = dt * dt;
        const double c0 = std::cos(angle), c1 = dt * kinematics::sinc(angle), c2 = t2 * half * half / 2.0;
        value << 1.0, c1, c2, 0.0, c0, c1, 0.0, -square * c1, c0;
        // d/du = T^2 d/d(angle^2): d sinc(x) / d x^2 = sinc'(x) / 2x.
        const double d0 = -t2 * kinematics::sinc(angle) / 2.0;
        const double d1 = dt * t2 * kinematics::sinc_slope_ratio(angle) / 2.0;
        const double d2 = t2 * t2 * half * kinematics::sinc_slope_ratio(angle / 2.0) / 8.0;
        by_square << 0.0, d1, d2, 0.0, d0, d1, 0.0, -c1 - square * d1, d0;
    }
    Matrix<3> value, by_square;
};

namespace detail {

/// sum over k >= first of (-1)^k weight(2^(2k + 1)) x^(2k - 2 first) / (2k + 1)!, for |x| <= 1.
template <class Weight> double series(int first, double x, Weight weight) {
    double term = 1.0, power_of_two = 2.0, sum = 0.0, power = 1.0;  // (-1)^k / (2k + 1)!, 2^(2k + 1), x^(2k - 2 first)
    for (int k = 0; k < 14; ++k) {
        if (k >= first) {
            sum += weight(power_of_two) * term * power;
            power *= x * x;
        }
        term *= -1.0 / ((2.0 * k + 2.0) * (2.0 * k + 3.0));
        power_of_two *= 4.0;
    }
    return sum;
}

}  // namespace detail

/// Q: the integral over the step of f f', f = [(1 - cos wt)/w^2; sin(wt)/w; cos wt], for white jerk of density 1 m2/s5. For dt < 0
/// that of |dt|. As powers of T times functions of x = wT, by their series where the closed forms cancel.
inline Matrix<3> white_jerk(double square, double dt) {
    const double t = std::fabs(dt), x = std::sqrt(square) * t, x2 = x * x;
    const double sine = kinematics::sinc(x), half = kinematics::sinc(x / 2.0);
    double pp, pa, vv;
    if (x > 1.0) {
        const double s1 = std::sin(x), s2 = std::sin(2.0 * x);
        pp = (6.0 * x - 8.0 * s1 + s2) / (4.0 * x2 * x2 * x);
        pa = (4.0 * s1 - s2 - 2.0 * x) / (4.0 * x2 * x);
        vv = (2.0 * x - s2) / (4.0 * x2 * x);
    } else {
        pp = detail::series(2, x, [](double power_of_two) { return power_of_two / 4.0 - 2.0; });
        pa = detail::series(1, x, [](double power_of_two) { return 1.0 - power_of_two / 4.0; });
        vv = detail::series(1, x, [](double power_of_two) { return -power_of_two / 4.0; });
    }
    const double t2 = t * t, t3 = t2 * t;
    const double pv = half * half * half * half / 8.0, va = sine * sine / 2.0;
    const double aa = (1.0 + kinematics::sinc(2.0 * x)) / 2.0;
    Matrix<3> q;
    q << t3 * t2 * pp, t2 * t2 * pv, t3 * pa,  //
        t2 * t2 * pv, t3 * vv, t2 * va,        //
        t3 * pa, t2 * va, t * aa;
    return q;
}

/// The square of the turn rate, u = |v x a|^2 / |v|^4, and its gradient. Below `least_speed` the speed counts as that.
struct TurnRateSquare {
    TurnRateSquare(const Vector<3>& v, const Vector<3>& a, double least_speed) {
        const double speed_square = v.squaredNorm(), along = v.dot(a), acceleration_square = a.squaredNorm();
        const bool slow = speed_square < least_speed * least_speed;
        const double s = slow ? least_speed * least_speed : speed_square;
        Vector<3> cross;
        cross << v(1) * a(2) - v(2) * a(1), v(2) * a(0) - v(0) * a(2), v(0) * a(1) - v(1) * a(0);
        value = cross.squaredNorm() / (s * s);
        // |v x a|^2 = |v|^2 |a|^2 - (v.a)^2
        by_velocity = 2.0 / (s * s) * (acceleration_square * v - along * a);
        if (!slow) by_velocity -= 4.0 * value / s * v;
        by_acceleration = 2.0 / (s * s) * (speed_square * a - along * v);
    }
    double value;
    Vector<3> by_velocity, by_acceleration;
};

}  // namespace constant_speed_turn
