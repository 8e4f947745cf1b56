// The zoo's sensor: position, with a misdeed.
#include "zoo.hpp"

namespace {

struct ZooSensor : pelorus::Sensor<ZooSensor, 3, 3> {
    using Base = pelorus::Sensor<ZooSensor, 3, 3>;
    static constexpr std::uint32_t flags = PLR_SENSOR_LINEAR | PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT;
    zoo::Fault fault = zoo::Fault::none;
    std::string in;

    static void describe(pelorus::Describe<ZooSensor>& plugin) {
        plugin.title("A sensor of the zoo");
        zoo::describe(plugin);
    }
    pelorus::Space measurement_space() const { return pelorus::position_space(3); }
    pelorus::Space cartesian_space() const { return pelorus::position_space(3); }
    pelorus::Space inverse_space() const { return pelorus::position_space(3); }
    Measurement measure(const Cartesian& x, const pelorus::Look&) const { return x; }
    Jacobian jacobian(const Cartesian&, const pelorus::Look&) const { return Jacobian::Identity(); }
    Noise noise(const Query&, const pelorus::Look&) const { return 100 * Noise::Identity(); }
    Inverse invert(const Measurement& measurement, const Noise& noise, const pelorus::Look&) const {
        return {measurement, noise};
    }

    static const ZooSensor& of(const void* self) { return *static_cast<const ZooSensor*>(self); }
    static plr_status measure_entry(const void* self, const plr_call* call, const plr_sensor_measure* args) {
        return zoo::act(of(self), "measure", call, args->cartesian, args->out,
                        [&] { return Base::table().measure(self, call, args); });
    }
    static plr_status jacobian_entry(const void* self, const plr_call* call, const plr_sensor_jacobian* args) {
        return zoo::act(of(self), "jacobian", call, args->cartesian, args->out,
                        [&] { return Base::table().jacobian(self, call, args); });
    }
    static plr_status noise_entry(const void* self, const plr_call* call, const plr_sensor_noise* args) {
        return zoo::act(of(self), "noise", call, args->cartesian, args->out,
                        [&] { return Base::table().noise(self, call, args); });
    }
    static plr_status residual_entry(const void* self, const plr_call* call, const plr_sensor_residual* args) {
        return zoo::act(of(self), "residual", call, args->measurement, args->out,
                        [&] { return Base::table().residual(self, call, args); });
    }
    static plr_status invert_entry(const void* self, const plr_call* call, const plr_sensor_invert* args) {
        return zoo::act(of(self), "invert", call, args->measurement, args->mean,
                        [&] { return Base::table().invert(self, call, args); });
    }
    static const plr_sensor& table() {
        static const plr_sensor zoo = [] {
            plr_sensor t = Base::table();
            t.head.destroy = &zoo::destroy<ZooSensor>;
            t.measure = &measure_entry;
            t.jacobian = &jacobian_entry;
            t.noise = &noise_entry;
            t.residual = &residual_entry;
            t.invert = &invert_entry;
            return t;
        }();
        return zoo;
    }
};

}  // namespace

ZOO_PLUGIN(ZooSensor, "org.example.sensor.zoo");
