// sensor.spherical: measures range and two angles from where and how it is mounted. See README.md.
#include "spherical_model.hpp"

#include <pelorus/sensor.hpp>

namespace {

using pelorus::Look;
using pelorus::Matrix;
using pelorus::Vector;

enum class Angle { elevation, zenith };

struct Spherical : pelorus::Sensor<Spherical, 3, 3> {
    static constexpr std::uint32_t flags = PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT;

    Angle angle = Angle::elevation;
    Vector<3> deviation, position, attitude;

    static void describe(pelorus::Describe<Spherical>& plugin);

    void setup(const pelorus::Setup&) { rotation_ = spherical::rotation(attitude(0), attitude(1), attitude(2)); }
    pelorus::Space measurement_space() const {
        return pelorus::Space({{"range", "m", 0.0, 0.0, false},
                               {"azimuth", "rad", 0.0, 0.0, true},
                               {angle == Angle::elevation ? "elevation" : "zenith", "rad", 0.0, 0.0, true}});
    }
    pelorus::Space cartesian_space() const { return pelorus::position_space(3); }
    pelorus::Space inverse_space() const { return pelorus::position_space(3); }

    Measurement measure(const Cartesian& x, const Look& look) const {
        Vector<3> z = spherical::from_cartesian(along_axes(x));
        if (angle == Angle::zenith) z(2) = spherical::half_pi - z(2);
        z += bias(look);
        z(1) = pelorus::wrap_angle(z(1));
        return z;
    }
    Jacobian jacobian(const Cartesian& x, const Look&) const {
        const Vector<3> p = along_axes(x);
        Matrix<3> along;
        if (!spherical::jacobian(p, along))
            throw pelorus::NumericError(
                p.isZero(0.0) ? "the object is at the sensor's own position, where angles have no derivative"
                              : "the object is on the sensor's vertical axis, where azimuth has no derivative");
        if (angle == Angle::zenith) along.row(2) = -along.row(2);
        Matrix<3> out;
        pelorus::small::multiply_transposed(along, rotation_, out);
        return out;
    }
    Noise noise(const Query&, const Look&) const { return deviation.cwiseAbs2().asDiagonal(); }
    Inverse invert(const Measurement& measurement, const Noise& noise, const Look& look) const {
        Vector<3> z = measurement - bias(look);
        Matrix<3> errors = noise;
        if (angle == Angle::zenith) {
            z(2) = spherical::half_pi - z(2);
            for (const int other : {0, 1}) errors(2, other) = errors(other, 2) = -noise(2, other);
        }
        const spherical::Converted converted = spherical::unbiased(z, errors);
        Inverse out;
        pelorus::small::multiply(rotation_, converted.mean, out.mean);
        out.mean += position;
        pelorus::small::symmetric_product(rotation_, converted.covariance, out.covariance);
        return out;
    }

private:
    Vector<3> along_axes(const Cartesian& x) const {
        const Vector<3> from_sensor = x - position;
        return rotation_.transpose() * from_sensor;
    }
    Vector<3> bias(const Look& look) const { return Eigen::Map<const Vector<3>>(input(look, 0)); }

    Matrix<3> rotation_;  // along the sensor's axes -> along the frame's
};

void Spherical::describe(pelorus::Describe<Spherical>& plugin) {
    plugin.title("Range, azimuth and elevation or zenith")
        .purpose(
            "A radar, lidar or sonar that measures range and two angles from its mount. Single measurements are "
            "converted to Cartesian points without bias, with the exact second moments of their errors.")
        .equation(
            "(x, y, z) = R' (p - position), R = Rz(yaw) Ry(pitch) Rx(roll); range = sqrt(x^2 + y^2 + z^2), azimuth = "
            "atan2(y, x), elevation = atan2(z, sqrt(x^2 + y^2)), zenith = pi/2 - elevation; bias and noise are added")
        .source(
            "L. Mo, X. Song, Y. Zhou, Z. K. Sun, Y. Bar-Shalom, Unbiased converted measurements for tracking, IEEE "
            "Transactions on Aerospace and Electronic Systems 34(3), 1023-1027, 1998; S. Bordonaro, P. Willett, Y. "
            "Bar-Shalom, Decorrelated unbiased converted measurement Kalman filter, ibid. 50(2), 1431-1444, 2014");
    plugin.parameter("angle", &Spherical::angle)
        .initially("elevation")
        .choices({{"elevation", "from the sensor's x-y plane up, in -pi/2 .. pi/2"},
                  {"zenith", "from the sensor's z axis down, in 0 .. pi"}})
        .doc("which angle is measured besides azimuth");
    plugin.parameter("noise", &Spherical::deviation)
        .unit("m, rad, rad")
        .initially("[10 m, 1 mrad, 1 mrad]")
        .above(0.0)
        .doc("deviations of range, azimuth and elevation or zenith; for scans that carry no covariances");
    plugin.parameter("position", &Spherical::position)
        .unit("m")
        .initially("[0 m, 0 m, 0 m]")
        .doc("where the sensor stands");
    plugin.parameter("attitude", &Spherical::attitude)
        .unit("rad")
        .initially("[0 rad, 0 rad, 0 rad]")
        .doc(
            "roll, pitch and yaw of its mount: it is turned about its x axis, then about the frame's y axis, then "
            "about the frame's z axis, right-handed");
    plugin.input("bias", "m, rad, rad", {0.0, 0.0, 0.0},
                 "what is added to range, azimuth and elevation or zenith, systematically");
}

}  // namespace

PELORUS_PLUGIN(Spherical, "sensor.spherical");
