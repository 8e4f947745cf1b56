/// Spherical coordinates seen from a mounted sensor: range, azimuth (from +x to +y), elevation (from the x-y plane to +z) or
/// zenith angle (from +z down); lengths in m, angles in rad.
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

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

/// d p / d (range, azimuth, elevation).
inline Matrix<3> cartesian_jacobian(const Vector<3>& z) {
    const double r = z(0), ca = std::cos(z(1)), sa = std::sin(z(1)), ce = std::cos(z(2)), se = std::sin(z(2));
    Matrix<3> out;
    out << ce * ca, -r * ce * sa, -r * se * ca,  //
        ce * sa, r * ce * ca, -r * se * sa,      //
        se, 0.0, r * ce;
    return out;
}

struct Converted {
    Vector<3> mean;
    Matrix<3> covariance;
};

/// The unbiased Cartesian point of a measurement (range, azimuth, elevation) with independent normal errors, along the
/// sensor's axes, and the exact second moments of its error, evaluated at the measurement.
///
/// Averaged over the errors, cos and sin of an angle shrink by exp(-variance / 2): the mean is divided by that. Second moments
/// follow from E cos^2 = (1 + exp(-2 variance) cos 2 angle) / 2 and its like. Correlations of the errors (off the diagonal of
/// `noise`) enter to first order.
/// Source: L. Mo, X. Song, Y. Zhou, Z. K. Sun, Y. Bar-Shalom, Unbiased converted measurements for tracking, IEEE Transactions
/// on Aerospace and Electronic Systems 34(3), 1023-1027, 1998 (the multiplicative correction). The second moments are those of
/// the corrected value given the true position, without that paper's nested conditioning, which S. Bordonaro, P. Willett,
/// Y. Bar-Shalom, Decorrelated unbiased converted measurement Kalman filter, ibid. 50(2), 1431-1444, 2014, discuss.
inline Converted unbiased(const Vector<3>& z, const Matrix<3>& noise) {
    const double azimuth_variance = noise(1, 1), elevation_variance = noise(2, 2);
    const double ca = std::cos(z(1)), sa = std::sin(z(1)), ce = std::cos(z(2)), se = std::sin(z(2));
    const double x = z(0) * ce * ca, y = z(0) * ce * sa, h = z(0) * se;
    const double ke = std::exp(elevation_variance / 2.0), ka = std::exp(azimuth_variance / 2.0);
    const double square = (z(0) * z(0) + noise(0, 0)) * ke * ke;
    const double fade_a = std::exp(-2.0 * azimuth_variance), fade_e = std::exp(-2.0 * elevation_variance);
    const double cos_2a = fade_a * (ca * ca - sa * sa), cos_2e = fade_e * (ce * ce - se * se);
    const double c2a = (1.0 + cos_2a) / 2.0, s2a = (1.0 - cos_2a) / 2.0, sca = fade_a * sa * ca;
    const double c2e = (1.0 + cos_2e) / 2.0, s2e = (1.0 - cos_2e) / 2.0, sce = fade_e * se * ce;

    Converted out;
    out.mean << x * ke * ka, y * ke * ka, h * ke;
    const double xx = square * ka * ka * c2e * c2a - x * x, yy = square * ka * ka * c2e * s2a - y * y;
    const double xy = square * ka * ka * c2e * sca - x * y, hh = square * s2e - h * h;
    const double xh = square * sce * ca - x * h, yh = square * sce * sa - y * h;
    out.covariance << xx, xy, xh, xy, yy, yh, xh, yh, hh;

    Matrix<3> correlated = noise;
    correlated.diagonal().setZero();
    if (!correlated.isZero(0.0)) {
        Matrix<3> share;
        pelorus::small::symmetric_product(cartesian_jacobian(z), correlated, share);
        out.covariance += share;
    }
    return out;
}

}  // namespace spherical
