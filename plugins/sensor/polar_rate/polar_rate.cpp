// sensor.polar_rate: measures range, range rate and azimuth in the plane. See README.md.
#include "../../common/sensing/angles.hpp"
#include "../../common/sensing/mounted_sensor.hpp"
#include "../../common/sensing/polar_model.hpp"

namespace {

using pelorus::Matrix;
using pelorus::Vector;

struct PolarRate : sensing::MountedSensor<PolarRate, 3, 2, true> {
    static constexpr std::uint32_t flags = sensing::mounted_flags | PLR_SENSOR_CAN_INVERT;

    pelorus::ConversionMoments moments = pelorus::ConversionMoments::exact;

    static void describe(pelorus::Describe<PolarRate>& plugin) {
        plugin.title("Range, range rate and azimuth")
            .purpose(
                "A Doppler radar or sonar in the plane. Its noise may follow signal-to-noise ratio, range and the "
                "waveform in force. Single measurements are converted to points without bias.")
            .equation(
                "p = R' (position - m), v = R' (velocity - u), R = R(yaw); range = |p|, range_rate = p'v / |p|, "
                "azimuth "
                "= atan2(p_y, p_x); bias and noise are added")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "Wiley 2001, 10.3; H. Zhang et al., Acta Electronica Sinica 47(3), 560-567, 2019 (noise by range)");
        sensing::describe_moments(plugin, &PolarRate::moments);
        describe_common(plugin, "m, m/s, rad", "[10 m, 1 m/s, 1 mrad]", "range, range rate and azimuth");
    }

    pelorus::Space measurement_space() const {
        return pelorus::Space(
            {sensing::range_component(), sensing::range_rate_component(), sensing::azimuth_component()});
    }
    Measurement seen(const Cartesian& local) const {
        const Vector<2> p = local.head<2>(), z = polar::from_cartesian(p);
        return {z(0), sensing::range_rate<2>(p, local.tail<2>()), z(1)};
    }
    Jacobian slope(const Cartesian& local) const {
        const Vector<2> p = local.head<2>();
        const Matrix<2> along = polar::jacobian(p);
        Jacobian out = Jacobian::Zero();
        out.block<1, 2>(0, 0) = along.row(0);
        out.row(1) = sensing::range_rate_slope<2>(p, local.tail<2>());
        out.block<1, 2>(2, 0) = along.row(1);
        return out;
    }
    Inverse converted(const Measurement& z, const Noise& noise) const {
        Matrix<2> errors;
        errors << noise(0, 0), noise(0, 2), noise(2, 0), noise(2, 2);
        const auto point = pelorus::unbiased_point(Vector<2>(z(0), z(2)), errors, moments);
        return {point.mean, point.covariance};
    }
};

}  // namespace

PELORUS_PLUGIN(PolarRate, "sensor.polar_rate");
