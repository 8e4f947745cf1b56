/// Polar coordinates in the plane, and the range rate in the plane and in space; lengths in m, angles in rad, rates in m/s.
#pragma once

#include <cmath>

#include <pelorus/failure.hpp>
#include <pelorus/matrix.hpp>

namespace polar {

using pelorus::Matrix;
using pelorus::Vector;

/// (range, azimuth) of a point given along the sensor's axes; at the sensor itself both are 0.
inline Vector<2> from_cartesian(const Vector<2>& p) { return {std::hypot(p(0), p(1)), std::atan2(p(1), p(0))}; }

/// d (range, azimuth) / d p. Throws NumericError at the sensor's position.
inline Matrix<2> jacobian(const Vector<2>& p) {
    const double range = std::hypot(p(0), p(1));
    if (!(range > 0.0))
        throw pelorus::NumericError("the object is at the sensor's own position, where azimuth has no derivative");
    Matrix<2> out;
    out << p(0) / range, p(1) / range, -p(1) / range / range, p(0) / range / range;
    return out;
}

}  // namespace polar

namespace sensing {

/// How fast the range of an object at p with relative velocity v grows; at the sensor itself 0.
template <int D> double range_rate(const pelorus::Vector<D>& p, const pelorus::Vector<D>& v) {
    const double range = p.stableNorm();
    return range == 0.0 ? 0.0 : v.dot(p / range);  // what is no number stays none
}

/// d range_rate / d (p, v). Throws NumericError at the sensor's position.
template <int D>
Eigen::Matrix<double, 1, 2 * D> range_rate_slope(const pelorus::Vector<D>& p, const pelorus::Vector<D>& v) {
    const double range = p.stableNorm();
    if (!(range > 0.0))
        throw pelorus::NumericError("the object is at the sensor's own position, where range rate has no derivative");
    const pelorus::Vector<D> sight = p / range, across = v - v.dot(sight) * sight;
    Eigen::Matrix<double, 1, 2 * D> out;
    out.template head<D>() = (across / range).transpose();
    out.template tail<D>() = sight.transpose();
    return out;
}

}  // namespace sensing
