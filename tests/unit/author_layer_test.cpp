// What the C++ author layer says to an author whose class contradicts itself.
#include <catch2/catch.hpp>
#include <string>

#include <pelorus/pelorus.hpp>

namespace {

struct ShortMotion : pelorus::Motion<ShortMotion, 6> {
    static void describe(pelorus::Describe<ShortMotion>& plugin) { plugin.title("six components that are four"); }
    pelorus::Space space() const { return pelorus::kinematic_space(2, {1e3, 10.0}); }
    State propagate(const State& x, const pelorus::Step&) const { return x; }
    Transition jacobian(const State&, const pelorus::Step&) const { return Transition::Identity(); }
    Transition noise(const Posterior&, const pelorus::Step&) const { return Transition::Identity(); }
};

struct LongSensor : pelorus::Sensor<LongSensor, 2, 2> {
    static constexpr std::uint32_t flags = PLR_SENSOR_CONSTANT_NOISE;
    static void describe(pelorus::Describe<LongSensor>& plugin) { plugin.title("two components that are three"); }
    pelorus::Space measurement_space() const { return pelorus::position_space(3); }
    pelorus::Space cartesian_space() const { return pelorus::position_space(2); }
    Measurement measure(const Cartesian& x, const pelorus::Look&) const { return x; }
    Jacobian jacobian(const Cartesian&, const pelorus::Look&) const { return Jacobian::Identity(); }
    Noise noise(const Query&, const pelorus::Look&) const { return Noise::Identity(); }
};

template <class Plugin> std::string refusal() {
    plr_config config{};
    config.struct_size = sizeof config;
    plr_instance instance{};
    plr_error error{};
    error.struct_size = sizeof error;
    CHECK(pelorus::detail::create<Plugin>(&config, &instance, &error) == PLR_E_ARGUMENT);
    CHECK(instance.self == nullptr);
    return error.message;
}

}  // namespace

TEST_CASE("a class whose spaces have other sizes than its vectors is refused when it is created", "[sdk]") {
    CHECK(refusal<ShortMotion>() == "space() has 4 components, the class says 6");
    CHECK(refusal<LongSensor>() == "measurement_space() has 3 components, the class says 2");
}
