// sensor.azimuth: measures the bearing of an object in the plane. See README.md.
#include "../../common/sensing/angles.hpp"
#include "../../common/sensing/mounted_sensor.hpp"
#include "../../common/sensing/polar_model.hpp"

namespace {

struct Azimuth : sensing::MountedSensor<Azimuth, 1, 2> {
    static constexpr std::uint32_t flags = sensing::mounted_flags;

    static void describe(pelorus::Describe<Azimuth>& plugin) {
        plugin.title("Bearing in the plane")
            .purpose(
                "A passive sonar, direction finder or camera line in the plane: azimuth alone. A single measurement "
                "tells no position, so that tracks begin with another sensor or at given states.")
            .equation("p = R' (position - m), R = R(yaw); azimuth = atan2(p_y, p_x); bias and noise are added")
            .source(
                "V. J. Aidala, Kalman filter behavior in bearings-only tracking applications, IEEE Transactions on "
                "Aerospace and Electronic Systems 15(1), 29-39, 1979");
        describe_common(plugin, "rad", "[1 mrad]", "azimuth");
    }

    pelorus::Space measurement_space() const { return pelorus::Space({sensing::azimuth_component()}); }
    Measurement seen(const Cartesian& local) const { return polar::from_cartesian(local).tail<1>(); }
    Jacobian slope(const Cartesian& local) const { return polar::jacobian(local).row(1); }
};

}  // namespace

PELORUS_PLUGIN(Azimuth, "sensor.azimuth");
