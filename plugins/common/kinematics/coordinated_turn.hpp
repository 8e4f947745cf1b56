/// A turn in the x-y plane at a constant rate w (rad/s, positive from x to y) and constant speed, the height (if any) moving
/// at a constant rate. State (positions, velocities[, turn rate]) [m, m/s, rad/s].
/// Source: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley 2001, 11.7
/// (nearly constant turn, known and estimated rate).
#pragma once

#include "sinc.hpp"

#include <pelorus/matrix.hpp>

namespace coordinated_turn {

using pelorus::Matrix;
using pelorus::Vector;

/// F of positions and velocities for a known turn rate, D = 2 or 3 axes; dt of any sign.
template <int D> Matrix<2 * D> transition(double turn_rate, double dt) {
    const double angle = turn_rate * dt, cosine = std::cos(angle), sine = std::sin(angle);
    const kinematics::Arc arc(angle);
    Matrix<2 * D> f = Matrix<2 * D>::Identity();
    f(0, D) = f(1, D + 1) = dt * arc.along;
    f(1, D) = dt * arc.across;
    f(0, D + 1) = -dt * arc.across;
    f(D, D) = f(D + 1, D + 1) = cosine;
    f(D + 1, D) = sine;
    f(D, D + 1) = -sine;
    if (D == 3) f(2, 5) = dt;
    return f;
}

/// d F x / d turn rate: how positions and velocities after the step change with the rate.
template <int D> Vector<2 * D> rate_derivative(const Vector<2 * D>& x, double turn_rate, double dt) {
    const double angle = turn_rate * dt, cosine = std::cos(angle), sine = std::sin(angle);
    const kinematics::Arc arc(angle);
    const double vx = x(D), vy = x(D + 1);
    Vector<2 * D> g = Vector<2 * D>::Zero();
    g(0) = dt * dt * (arc.along_slope * vx - arc.across_slope * vy);
    g(1) = dt * dt * (arc.across_slope * vx + arc.along_slope * vy);
    g(D) = dt * (-sine * vx - cosine * vy);
    g(D + 1) = dt * (cosine * vx - sine * vy);
    return g;
}

}  // namespace coordinated_turn
