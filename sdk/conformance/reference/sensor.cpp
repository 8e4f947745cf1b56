// Position on three axes, measured directly.
#include <pelorus/sensor.hpp>

#include "reference_parts.hpp"

namespace pelorus::conformance {

namespace {

struct Sensor : pelorus::Sensor<Sensor, 3, 3> {
    static constexpr std::uint32_t flags = PLR_SENSOR_LINEAR | PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT;
    double deviation = 10;  // m

    static void describe(Describe<Sensor>& plugin) {
        plugin.title("Position, three axes");
        plugin.parameter("noise", &Sensor::deviation)
            .unit("m")
            .initially("10 m")
            .above(0)
            .doc("deviation of each axis");
    }
    Space measurement_space() const { return position_space(3); }
    Space cartesian_space() const { return position_space(3); }
    Space inverse_space() const { return position_space(3); }
    Measurement measure(const Cartesian& x, const Look&) const { return x; }
    Jacobian jacobian(const Cartesian&, const Look&) const { return Jacobian::Identity(); }
    Noise noise(const Query&, const Look&) const { return deviation * deviation * Noise::Identity(); }
    Inverse invert(const Measurement& z, const Noise& noise, const Look&) const { return {z, noise}; }
};

}  // namespace

const plr_plugin* reference_sensor() {
    return pelorus::detail::plugin<Sensor>("pelorus.conformance.sensor", "pelorus.conformance.sensor");
}

}  // namespace pelorus::conformance
