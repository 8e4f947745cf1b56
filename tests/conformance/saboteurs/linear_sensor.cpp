// Position in space, measured directly, with what a linear sensor may do wrong.
#include <cmath>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

struct Saboteur : pelorus::Sensor<Saboteur, 3, 3> {
    using Base = pelorus::Sensor<Saboteur, 3, 3>;
    using Look = pelorus::Look;
    static constexpr std::uint32_t flags = PLR_SENSOR_LINEAR | PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT;
    double deviation = 0;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A position sensor with a defect")
            .purpose("Position on three axes, for the proof that the conformance suites can fail.")
            .equation("z = p + w")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "2001, section 5.2");
        plugin.parameter("noise", &Saboteur::deviation)
            .unit("m")
            .initially("10 m")
            .above(0)
            .doc("deviation of each axis");
    }
    pelorus::Space measurement_space() const { return pelorus::position_space(3); }
    pelorus::Space cartesian_space() const { return pelorus::position_space(3); }
    pelorus::Space inverse_space() const { return pelorus::position_space(3); }

    Measurement measure(const Cartesian& x, const Look&) const { return x; }
    Jacobian jacobian(const Cartesian& x, const Look&) const {
        Jacobian h = Jacobian::Identity();
        if (NEAR_MISS("sensor-linear-means-linear") && x(0) > 0) h(0, 0) += 1e-13;
        return h;
    }
    Noise noise(const Query&, const Look&) const { return deviation * deviation * Noise::Identity(); }
    Inverse invert(const Measurement& z, const Noise& noise, const Look&) const { return {z, noise}; }

    static const plr_sensor& table() noexcept {
        static const plr_sensor made = [] {
            plr_sensor table = Base::table();
            table.noise = &noise_entry;
            return table;
        }();
        return made;
    }

private:
    static plr_status noise_entry(const void* self, const plr_call* call, const plr_sensor_noise* args) noexcept {
        const plr_status status = Base::table().noise(self, call, args);
        const bool is_bad = DEFECT("sensor-constant-noise-is-constant");
        if (!(is_bad || NEAR_MISS("sensor-constant-noise-is-constant")) || args->cartesian.data == nullptr)
            return status;
        for (std::int64_t i = 0; i < args->out.count; ++i) {
            const double reach = std::abs(args->cartesian.data[i * args->cartesian.item_stride]);
            const Noise r = pelorus::load<3, 3>(pelorus::as_const(args->out), i);
            if (!std::isfinite(reach)) continue;
            const Noise grown = (1 + (is_bad ? 1e-5 : 1e-18) * reach) * r;
            pelorus::store<3, 3>(args->out, i, grown);
        }
        return status;
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.sensor.linear_saboteur");
