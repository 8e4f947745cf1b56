/// Spherical coordinates seen from a mounted sensor: range, azimuth (from +x to +y), elevation (from the x-y plane to +z) or
/// zenith angle (from +z down); lengths in m, angles in rad.
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>

namespace spherical {

using pelorus::Matrix;
using pelorus::Vector;

constexpr double half_pi = 1.57079632679489661923;

/// The rotation that takes coordinates along the sensor's axes to those of its frame: Rz(yaw) Ry(pitch) Rx(roll), right-handed.
/// A positive yaw turns the sensor from +x to +y, a positive pitch turns its x axis down (towards -z).
inline Matrix<3> rotation(double roll, double pitch, double yaw) {
    const double cr = std::cos(roll), sr = std::sin(roll), cp = std::cos(pitch), sp = std::sin(pitch);
    const double cy = std::cos(yaw), sy = std::sin(yaw);
    Matrix<3> r;
    r << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
        sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
        -sp, cp * sr, cp * cr;
    return r;
}

/// (range, azimuth, elevation) of a point given along the sensor's axes; at the sensor itself all are 0.
inline Vector<3> from_cartesian(const Vector<3>& p) {
    const double ground = std::hypot(p(0), p(1));
    return {std::hypot(ground, p(2)), std::atan2(p(1), p(0)), std::atan2(p(2), ground)};
}

/// d (range, azimuth, elevation) / d p. False at the sensor's position and on its vertical axis (a ground distance below 1e-9
/// of the range), where azimuth has no derivative.
[[nodiscard]] inline bool jacobian(const Vector<3>& p, Matrix<3>& out) {
    const double ground = std::hypot(p(0), p(1)), range = std::hypot(ground, p(2));
    if (!(ground > 1e-9 * range)) return false;
    const double rise = p(2) / range / ground / range;
    out << p(0) / range, p(1) / range, p(2) / range,           //
        -p(1) / ground / ground, p(0) / ground / ground, 0.0,  //
        -p(0) * rise, -p(1) * rise, ground / range / range;
    return true;
}

}  // namespace spherical
