// sensor.spherical_rate: measures range, range rate and two angles. See README.md.
#include "../../common/sensing/angles.hpp"
#include "../../common/sensing/mounted_sensor.hpp"
#include "../../common/sensing/polar_model.hpp"

namespace {

using pelorus::Matrix;
using pelorus::Vector;
using sensing::Angle;

struct SphericalRate : sensing::MountedSensor<SphericalRate, 4, 3, true> {
    static constexpr std::uint32_t flags = sensing::mounted_flags | PLR_SENSOR_CAN_INVERT;
    /// Where range, azimuth and the angle stand in the measurement.
    static constexpr int located[] = {0, 2, 3};

    Angle angle = Angle::elevation;
    pelorus::ConversionMoments moments = pelorus::ConversionMoments::exact;

    static void describe(pelorus::Describe<SphericalRate>& plugin) {
        plugin.title("Range, range rate, azimuth and elevation or zenith")
            .purpose(
                "A Doppler radar or sonar that measures range, its rate and two angles from its mount. Single "
                "measurements are converted to Cartesian points without bias.")
            .equation(
                "p = R' (position - m), v = R' (velocity - u), R = Rz(yaw) Ry(pitch) Rx(roll); range = |p|, range_rate "
                "= p'v / |p|, azimuth = atan2(p_y, p_x), elevation = atan2(p_z, sqrt(p_x^2 + p_y^2)), zenith = pi/2 - "
                "elevation; bias and noise are added")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "Wiley 2001, 10.3; L. Mo, X. Song, Y. Zhou, Z. K. Sun, Y. Bar-Shalom, Unbiased converted measurements "
                "for tracking, IEEE Transactions on Aerospace and Electronic Systems 34(3), 1023-1027, 1998");
        sensing::describe_angle(plugin, &SphericalRate::angle);
        sensing::describe_moments(plugin, &SphericalRate::moments);
        describe_common(plugin, "m, m/s, rad, rad", "[10 m, 1 m/s, 1 mrad, 1 mrad]",
                        "range, range rate, azimuth and elevation or zenith");
    }

    pelorus::Space measurement_space() const {
        return pelorus::Space({sensing::range_component(), sensing::range_rate_component(),
                               sensing::azimuth_component(), sensing::angle_component(angle)});
    }
    Measurement seen(const Cartesian& local) const {
        const Vector<3> p = local.head<3>(), z = sensing::seen(p, angle);
        return {z(0), sensing::range_rate<3>(p, local.tail<3>()), z(1), z(2)};
    }
    Jacobian slope(const Cartesian& local) const {
        const Vector<3> p = local.head<3>();
        const Matrix<3> along = sensing::slope(p, angle);
        Jacobian out = Jacobian::Zero();
        for (int row = 0; row < 3; ++row) out.block<1, 3>(located[row], 0) = along.row(row);
        out.row(1) = sensing::range_rate_slope<3>(p, local.tail<3>());
        return out;
    }
    Inverse converted(const Measurement& z, const Noise& errors) const {
        Matrix<3> kept;
        for (int row = 0; row < 3; ++row)
            for (int col = 0; col < 3; ++col) kept(row, col) = errors(located[row], located[col]);
        const auto point = sensing::unbiased({z(0), z(2), z(3)}, kept, angle, moments);
        return {point.mean, point.covariance};
    }
};

}  // namespace

PELORUS_PLUGIN(SphericalRate, "sensor.spherical_rate");
