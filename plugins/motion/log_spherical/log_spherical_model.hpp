/// Logarithmic spherical coordinates: the logarithm of the range, two angles, and the velocity over the range along the three
/// directions that they have; and level turns in them. Everything in three dimensions; the plane is elevation 0.
///
/// With r = exp(lambda), azimuth b (from +x to +y), elevation e (from the x-y plane up):
///
///     u_r = (cos e cos b, cos e sin b, sin e),  u_b = (-sin b, cos b, 0),  u_e = (-sin e cos b, -sin e sin b, cos e)
///     p = r u_r,   v = r (rho u_r + omega u_b + eta u_e),   rho = r'/r, omega = b' cos e, eta = e'
///
/// Sources: V. J. Aidala, S. E. Hammel, Utilization of modified polar coordinates for bearings-only tracking, IEEE Transactions on
/// Automatic Control 28(3), 283-294, 1983 (the plane); M. Mallick, M. Morelande, L. Mihaylova, S. Arulampalam, Y. Yan,
/// Angle-only filtering in three dimensions, in: M. Mallick, V. Krishnamurthy, B.-N. Vo (eds.), Integrated Tracking,
/// Classification, and Sensor Management, Wiley 2012, chapter 1 (log spherical coordinates).
#pragma once

#include "../../common/kinematics/coordinated_turn.hpp"
#include "../../common/kinematics/white_acceleration.hpp"

#include <cmath>

#include <pelorus/failure.hpp>
#include <pelorus/matrix.hpp>
#include <pelorus/sensor.hpp>
#include <pelorus/small_matrix.hpp>

namespace log_spherical {

using pelorus::Matrix;
using pelorus::Vector;

/// (log range, azimuth, elevation, rho, omega, eta) and (position, velocity).
using Coordinates = Vector<6>;
using Cartesian = Vector<6>;

/// Columns u_r, u_b, u_e.
inline Matrix<3> directions(const Coordinates& s) {
    const double cb = std::cos(s(1)), sb = std::sin(s(1)), ce = std::cos(s(2)), se = std::sin(s(2));
    Matrix<3> u;
    u << ce * cb, -sb, -se * cb, ce * sb, cb, -se * sb, se, 0.0, ce;
    return u;
}

inline Cartesian to_cartesian(const Coordinates& s) {
    const Matrix<3> u = directions(s);
    const double range = std::exp(s(0));
    Cartesian c;
    c.head<3>() = range * u.col(0);
    c.tail<3>() = range * (u * s.tail<3>());
    return c;
}

/// Elevation in [-pi/2, pi/2]. Throws NumericError at the origin.
inline Coordinates from_cartesian(const Cartesian& c) {
    const double range = c.head<3>().stableNorm();
    if (!(range > 0.0)) throw pelorus::NumericError("the position is the origin, whose direction is not defined");
    Coordinates s;
    s(0) = std::log(range);
    s(1) = std::atan2(c(1), c(0));
    s(2) = std::atan2(c(2), std::hypot(c(0), c(1)));
    s.tail<3>() = directions(s).transpose() * c.tail<3>() / range;
    return s;
}

/// What a change of the coordinates is along the three directions, d p / r and d v / r; `turn` those of the velocity's components
/// because the directions turn with the angles and the range grows:
///     d v / r = (d rho, d omega, d eta) + turn (d lambda, d b, d e).
inline Matrix<3> turn_of(const Coordinates& s) {
    const double ce = std::cos(s(2)), se = std::sin(s(2)), rho = s(3), omega = s(4), eta = s(5);
    Matrix<3> turn;
    turn << rho, -ce * omega, -eta,       //
        omega, ce * rho - se * eta, 0.0,  //
        eta, se * omega, rho;
    return turn;
}

/// d (position, velocity) / d coordinates.
inline Matrix<6> to_cartesian_jacobian(const Coordinates& s) {
    const Matrix<3> scaled = std::exp(s(0)) * directions(s);
    Matrix<6> j = Matrix<6>::Zero();
    j.topLeftCorner<3, 3>() = scaled;
    j.block<3, 1>(0, 1) *= std::cos(s(2));
    j.bottomLeftCorner<3, 3>() = scaled * turn_of(s);
    j.bottomRightCorner<3, 3>() = scaled;
    return j;
}

/// d coordinates / d (position, velocity): the inverse of the former. Throws NumericError straight above or below the origin,
/// where the azimuth has no derivative.
inline Matrix<6> from_cartesian_jacobian(const Coordinates& s) {
    const double cosine = std::cos(s(2));
    if (std::fabs(cosine) < 1e-12)
        throw pelorus::NumericError("the position is straight above or below the origin, where azimuth is not defined");
    const Matrix<3> scaled = std::exp(-s(0)) * directions(s).transpose();
    Matrix<3> angles = scaled;
    angles.row(1) /= cosine;
    Matrix<6> j = Matrix<6>::Zero();
    j.topLeftCorner<3, 3>() = angles;
    j.bottomLeftCorner<3, 3>() = -turn_of(s) * angles;
    j.bottomRightCorner<3, 3>() = scaled;
    return j;
}

/// Flight for dt (s, of any sign) in a level turn at a constant rate (rad/s, positive from x to y), straight where that is 0, the height
/// changing at a constant rate; in closed form: with the range as the unit of length the point starts from u_r with the velocity
/// rho u_r + omega u_b + eta u_e. Throws NumericError where it ends in the origin.
inline Coordinates propagate(const Coordinates& s, double turn_rate, double dt) {
    const double ce = std::cos(s(2)), se = std::sin(s(2));
    // Horizontal (away from the origin), across, and up, in axes turned by the azimuth.
    const kinematics::Arc arc(turn_rate * dt);
    const double v_out = s(3) * ce - s(5) * se, v_across = s(4), v_up = s(3) * se + s(5) * ce;
    const double out = ce + dt * (arc.along * v_out - arc.across * v_across),
                 across = dt * (arc.along * v_across + arc.across * v_out), up = se + dt * v_up;
    // An elevation beyond the zenith is a way to write the point: the answer is written in the same way.
    const double side = ce < 0.0 ? -1.0 : 1.0;
    const double level = std::hypot(out, across), growth = std::hypot(level, up);
    if (!(growth > 0.0)) throw pelorus::NumericError("the way ends in the origin, whose direction is not defined");
    Coordinates y;
    y(0) = s(0) + std::log(growth);
    y(1) = pelorus::wrap_angle(s(1) + std::atan2(side * across, side * out));
    y(2) = std::atan2(up, side * level);
    // The velocity, turned; its components over the range are those along the new directions.
    const double heading = s(1) + turn_rate * dt, cosine = std::cos(heading), sine = std::sin(heading);
    const Vector<3> velocity(cosine * v_out - sine * v_across, sine * v_out + cosine * v_across, v_up);
    y.tail<3>() = directions(y).transpose() * velocity / growth;
    return y;
}

/// What is said of the coordinates (and, with N = 7, of a turn rate that is the same in both) from a matrix of the six.
template <int N> Matrix<N> beside_turn_rate(const Matrix<6>& six) {
    Matrix<N> out = Matrix<N>::Identity();
    out.template topLeftCorner<6, 6>() = six;
    return out;
}

/// d (position, velocity[, turn rate]) after the step / d those before it; N = 6 or, with the turn rate, 7.
template <int N> Matrix<N> cartesian_transition(const Cartesian& c, double turn_rate, double dt) {
    Matrix<N> f = beside_turn_rate<N>(coordinated_turn::transition<3>(turn_rate, dt));
    if constexpr (N > 6) f.template topRightCorner<6, 1>() = coordinated_turn::rate_derivative<3>(c, turn_rate, dt);
    return f;
}

/// F = (d s' / d c') (d c' / d c) (d c / d s), with y the coordinates after the step; N as above.
template <int N> Matrix<N> jacobian(const Coordinates& s, const Coordinates& y, double turn_rate, double dt) {
    // With the range at the start as the unit of length nothing overflows, whatever it is.
    Coordinates from = s, to = y;
    to(0) -= from(0);
    from(0) = 0.0;
    Matrix<N> moved, f;
    pelorus::small::multiply(cartesian_transition<N>(to_cartesian(from), turn_rate, dt),
                             beside_turn_rate<N>(to_cartesian_jacobian(from)), moved);
    pelorus::small::multiply(beside_turn_rate<N>(from_cartesian_jacobian(to)), moved, f);
    return f;
}

/// Of Cartesian white acceleration (densities of the axes, m2/s3) and of a turn rate that wanders (rad2/s3), carried to the coordinates
/// y after the step from s; N as above. dt < 0: that of the state as it was, given the state as it is.
template <int N>
Matrix<N> noise(const Coordinates& s, const Coordinates& y, double turn_rate, double dt, const Vector<3>& density,
                double rate_density) {
    Matrix<N> q = Matrix<N>::Zero(), out;
    kinematics::add_per_axis(kinematics::white_acceleration(std::fabs(dt)), density, q);
    if (N > 6) q(N - 1, N - 1) = rate_density * std::fabs(dt);
    if (dt < 0.0) q = kinematics::carried_back<N>(cartesian_transition<N>(to_cartesian(s), turn_rate, dt), q);
    pelorus::small::symmetric_product(beside_turn_rate<N>(from_cartesian_jacobian(y)), q, out);
    return out;
}

}  // namespace log_spherical
