// sensor.bearings: measures two angles and no range. See README.md.
#include "../../common/sensing/angles.hpp"
#include "../../common/sensing/mounted_sensor.hpp"

namespace {

using sensing::Angle;

struct Bearings : sensing::MountedSensor<Bearings, 2, 3> {
    static constexpr std::uint32_t flags = sensing::mounted_flags;

    Angle angle = Angle::elevation;

    static void describe(pelorus::Describe<Bearings>& plugin) {
        plugin.title("Azimuth and elevation or zenith")
            .purpose(
                "A camera, an infrared search set, a passive array: two angles and no range. A single measurement "
                "tells no position, so that tracks begin with another sensor or at given states.")
            .equation(
                "p = R' (position - m), R = Rz(yaw) Ry(pitch) Rx(roll); azimuth = atan2(p_y, p_x), elevation = "
                "atan2(p_z, sqrt(p_x^2 + p_y^2)), zenith = pi/2 - elevation; bias and noise are added")
            .source(
                "S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, Artech House 1999, "
                "chapter 5 (passive sensors)");
        sensing::describe_angle(plugin, &Bearings::angle);
        describe_common(plugin, "rad", "[1 mrad, 1 mrad]", "azimuth and elevation or zenith");
    }

    pelorus::Space measurement_space() const {
        return pelorus::Space({sensing::azimuth_component(), sensing::angle_component(angle)});
    }
    Measurement seen(const Cartesian& local) const { return sensing::seen(local, angle).tail<2>(); }
    Jacobian slope(const Cartesian& local) const { return sensing::slope(local, angle).bottomRows<2>(); }
};

}  // namespace

PELORUS_PLUGIN(Bearings, "sensor.bearings");
