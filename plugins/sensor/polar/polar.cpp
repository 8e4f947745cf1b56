// sensor.polar: measures range and azimuth in the plane. See README.md.
#include "../../common/sensing/angles.hpp"
#include "../../common/sensing/mounted_sensor.hpp"
#include "../../common/sensing/polar_model.hpp"

namespace {

struct Polar : sensing::MountedSensor<Polar, 2, 2> {
    static constexpr std::uint32_t flags = sensing::mounted_flags | PLR_SENSOR_CAN_INVERT;

    pelorus::ConversionMoments moments = pelorus::ConversionMoments::exact;

    static void describe(pelorus::Describe<Polar>& plugin) {
        plugin.title("Range and azimuth")
            .purpose(
                "A radar, lidar or sonar in the plane. Its noise may follow signal-to-noise ratio, range and the "
                "waveform in force. Single measurements are converted to points without bias.")
            .equation(
                "p = R' (position - m), R = R(yaw); range = |p|, azimuth = atan2(p_y, p_x); bias and noise are added")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "Wiley 2001, 10.4; L. Mo, X. Song, Y. Zhou, Z. K. Sun, Y. Bar-Shalom, Unbiased converted measurements "
                "for tracking, IEEE Transactions on Aerospace and Electronic Systems 34(3), 1023-1027, 1998; S. "
                "Bordonaro, P. Willett, Y. Bar-Shalom, Decorrelated unbiased converted measurement Kalman filter, "
                "ibid. 50(2), 1431-1444, 2014");
        sensing::describe_moments(plugin, &Polar::moments);
        describe_common(plugin, "m, rad", "[10 m, 1 mrad]", "range and azimuth");
    }

    pelorus::Space measurement_space() const {
        return pelorus::Space({sensing::range_component(), sensing::azimuth_component()});
    }
    Measurement seen(const Cartesian& local) const { return polar::from_cartesian(local); }
    Jacobian slope(const Cartesian& local) const { return polar::jacobian(local); }
    Inverse converted(const Measurement& z, const Noise& errors) const {
        const auto point = pelorus::unbiased_point(z, errors, moments);
        return {point.mean, point.covariance};
    }
};

}  // namespace

PELORUS_PLUGIN(Polar, "sensor.polar");
