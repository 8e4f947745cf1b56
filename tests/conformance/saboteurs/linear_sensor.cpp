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
        const plr_status checked = pelorus::guarded(
            call->error, [&] { pelorus::expect(args->cartesian, 3, 1, args->out.count, "cartesian"); });
        if (status < 0 || checked != PLR_OK) return status < 0 ? status : checked;
        return pelorus::for_items(*call, args->out.count, [&](std::int64_t i) {
            const pelorus::Vector<3> x = pelorus::load<3, 1>(args->cartesian, i);
            if (!x.allFinite()) throw pelorus::NumericError("the object is nowhere");
            const double reach = std::abs(x(0));
            const Noise r = pelorus::load<3, 3>(pelorus::as_const(args->out), i);
            const Noise grown = (1 + (is_bad ? 1e-5 : 1e-18) * reach) * r;
            pelorus::store<3, 3>(args->out, i, grown);
        });
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.sensor.linear_saboteur");
