// sensor.spherical: measures range and two angles from where and how it is mounted. See README.md.
#include "../../common/sensing/angles.hpp"
#include "../../common/sensing/mounted_sensor.hpp"

namespace {

using sensing::Angle;

struct Spherical : sensing::MountedSensor<Spherical, 3, 3> {
    static constexpr std::uint32_t flags = sensing::mounted_flags | PLR_SENSOR_CAN_INVERT;

    Angle angle = Angle::elevation;

    static void describe(pelorus::Describe<Spherical>& plugin);

    pelorus::Space measurement_space() const {
        return pelorus::Space(
            {sensing::range_component(), sensing::azimuth_component(), sensing::angle_component(angle)});
    }
    Measurement seen(const Cartesian& local) const { return sensing::seen(local, angle); }
    Jacobian slope(const Cartesian& local) const { return sensing::slope(local, angle); }
    Inverse converted(const Measurement& z, const Noise& noise) const {
        const spherical::Converted point = sensing::unbiased(z, noise, angle);
        return {point.mean, point.covariance};
    }
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
    sensing::describe_angle(plugin, &Spherical::angle);
    describe_common(plugin, "m, rad, rad", "[10 m, 1 mrad, 1 mrad]", "range, azimuth and elevation or zenith");
}

}  // namespace

PELORUS_PLUGIN(Spherical, "sensor.spherical");
