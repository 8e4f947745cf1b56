/// Range and angles as sensors choose: whether the second angle is counted up from the plane or down from the vertical, and which
/// covariance a converted point has.
#pragma once

#include <pelorus/describe.hpp>
#include <pelorus/failure.hpp>
#include <pelorus/space.hpp>
#include <pelorus/unbiased_conversion.hpp>

#include "spherical_model.hpp"

namespace sensing {

enum class Angle { elevation, zenith };

template <class Plugin, class Base> void describe_angle(pelorus::Describe<Plugin>& plugin, Angle Base::*angle) {
    plugin.parameter("angle", angle)
        .initially("elevation")
        .choices({{"elevation", "from the sensor's x-y plane up, in -pi/2 .. pi/2"},
                  {"zenith", "from the sensor's z axis down, in 0 .. pi"}})
        .doc("which angle is measured besides azimuth");
}

template <class Plugin, class Base>
void describe_moments(pelorus::Describe<Plugin>& plugin, pelorus::ConversionMoments Base::*moments) {
    plugin.parameter("moments", moments)
        .initially("exact")
        .choices({{"exact", "of the converted point about a given true place"},
                  {"nested", "of the true place about the converted point, given the measurement (Mo et al.)"}})
        .doc("which second moments the covariance of a measurement that is converted to a point holds");
}

inline pelorus::Component range_component() { return {"range", "m", 0.0, 0.0, false}; }
inline pelorus::Component range_rate_component() { return {"range_rate", "m/s", 0.0, 0.0, false}; }
inline pelorus::Component azimuth_component() { return {"azimuth", "rad", 0.0, 0.0, true}; }
inline pelorus::Component angle_component(Angle angle) {
    return {angle == Angle::elevation ? "elevation" : "zenith", "rad", 0.0, 0.0, true};
}

/// (range, azimuth, angle) of a point along the sensor's axes.
inline pelorus::Vector<3> seen(const pelorus::Vector<3>& p, Angle angle) {
    pelorus::Vector<3> z = spherical::from_cartesian(p);
    if (angle == Angle::zenith) z(2) = spherical::half_pi - z(2);
    return z;
}

/// Throws the NumericError of a point where azimuth has no derivative.
[[noreturn]] inline void refuse_slope(bool at_sensor) {
    throw pelorus::NumericError(at_sensor
                                    ? "the object is at the sensor's own position, where angles have no derivative"
                                    : "the object is on the sensor's vertical axis, where azimuth has no derivative");
}

/// d seen / d p. Throws NumericError where azimuth has no derivative.
inline pelorus::Matrix<3> slope(const pelorus::Vector<3>& p, Angle angle) {
    pelorus::Matrix<3> out;
    if (!spherical::jacobian(p, out)) refuse_slope(p.isZero(0.0));
    if (angle == Angle::zenith) out.row(2) = -out.row(2);
    return out;
}

/// The point of a measurement (range, azimuth, angle) along the sensor's axes; see pelorus::unbiased_point.
inline pelorus::ConvertedPoint<3> unbiased(const pelorus::Vector<3>& measurement, const pelorus::Matrix<3>& noise,
                                           Angle angle, pelorus::ConversionMoments moments) {
    if (angle == Angle::elevation) return pelorus::unbiased_point(measurement, noise, moments);
    const pelorus::Vector<3> z(measurement(0), measurement(1), spherical::half_pi - measurement(2));
    pelorus::Matrix<3> errors = noise;
    for (const int other : {0, 1}) errors(2, other) = errors(other, 2) = -noise(2, other);
    return pelorus::unbiased_point(z, errors, moments);
}

}  // namespace sensing
