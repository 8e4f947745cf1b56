#include "../../../tests/support/reference.hpp"
#include "../../../tests/support/rotating_waveform.hpp"
#include "../../../tests/support/sensor_checks.hpp"

using namespace test_support;

namespace {

double largest(const Eigen::MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }
const Eigen::Vector4d somewhere(30e3, -40e3, 200.0, 150.0);

/// A polar_rate sensor whose slot `waveform` holds the rotating one.
struct Shaped {
    explicit Shaped(const Values& values)
        : waveform(RotatingWaveform::plugin(), {}, {}, 0),
          sensor("sensor", "polar_rate", values, {{"waveform", "", &waveform}}) {}
    Instance waveform, sensor;
};

}  // namespace

TEST_CASE("polar rate measurement agrees with the reference library", "[sensor]") {
    // Its three-dimensional answers hold in the plane for an object at the height of the sensor.
    const auto answers = reference("models_and_filters.json");
    const nlohmann::json& answer = answers.at("h BR (x,y)");
    const Instance instance("sensor", "polar_rate");
    const SensorUnderTest sensor(instance);
    const Eigen::VectorXd given = matrix(answer.at("x")), h = matrix(answer.at("h"));
    const Eigen::Vector4d x(given(0), given(2), given(1), given(3));
    const Eigen::VectorXd z = sensor.measure(x);
    CHECK(z(0) == Approx(h(1)).epsilon(1e-12));
    CHECK(z(2) == Approx(h(0)).epsilon(1e-12));
    CHECK(z(1) == Approx((20000.0 * -120.0 + 15000.0 * 80.0) / 25000.0).epsilon(1e-12));
    const Eigen::MatrixXd jacobian = sensor.jacobian(x), expected = matrix(answer.at("H"));
    for (const int axis : {0, 1}) {
        CHECK(jacobian(0, axis) == Approx(expected(1, 2 * axis)).epsilon(1e-6));
        CHECK(jacobian(2, axis) == Approx(expected(0, 2 * axis)).epsilon(1e-6));
    }
}

TEST_CASE("the polar rate Jacobian is the derivative of the measurement", "[sensor]") {
    const Instance instance("sensor", "polar_rate",
                            {{"position", "[10, 20]"}, {"yaw", "2.5"}, {"velocity", "[15, -8]"}});
    const SensorUnderTest sensor(instance);
    sensor.check_jacobian(Eigen::Vector4d(300, -400, 12, 250), 1e-2);
    sensor.check_jacobian(Eigen::Vector4d(-50, 2000, -90, 3), 1e-2);
}

TEST_CASE("a polar rate sensor counts from its mount and its own velocity", "[sensor]") {
    const Instance instance("sensor", "polar_rate",
                            {{"position", "[100, 200]"}, {"yaw", "90 deg"}, {"velocity", "[0, 30]"}});
    const SensorUnderTest sensor(instance);
    // Straight ahead of a sensor that looks along +y and moves there at 30 m/s: an object at rest comes nearer.
    const Eigen::VectorXd z = sensor.measure(Eigen::Vector4d(100, 5200, 0, 0));
    CHECK(z(0) == 5000.0);
    CHECK(z(1) == -30.0);
    CHECK(std::fabs(z(2)) < 1e-15);
}

TEST_CASE("a platform carries the mount with it", "[sensor]") {
    const Instance on_platform("sensor", "polar_rate",
                               {{"position", "[10, 0]"}, {"yaw", "0.2"}, {"velocity", "[1, 2]"}});
    SensorUnderTest sensor(on_platform);
    // bias (3), position, yaw, velocity of the platform, which is turned by 90 deg
    const double pi = std::acos(-1.0);
    const double inputs[] = {0, 0, 0, 1000, 2000, pi / 2, 7, 9, 0};
    sensor.inputs(inputs);
    const Instance standing("sensor", "polar_rate",
                            {{"position", "[1000, 2010]"}, {"yaw", "1.7707963267948966"}, {"velocity", "[5, 10]"}});
    const SensorUnderTest same(standing);
    CHECK(largest(sensor.measure(somewhere) - same.measure(somewhere)) < 1e-9);
    CHECK(largest(sensor.jacobian(somewhere) - same.jacobian(somewhere)) < 1e-12);
    const Eigen::MatrixXd noise = sensor.noise_at(somewhere);
    CHECK(largest(sensor.invert(sensor.measure(somewhere), noise).second -
                  same.invert(same.measure(somewhere), noise).second) < 1e-9);
    CHECK(largest(sensor.invert(sensor.measure(somewhere), 1e-12 * noise).first - somewhere.head(2)) < 1e-6);
}

TEST_CASE("a bias reaches range and range rate and azimuth and is taken off by the inverse", "[sensor]") {
    const Instance instance("sensor", "polar_rate");
    SensorUnderTest sensor(instance);
    const Eigen::VectorXd plain = sensor.measure(somewhere);
    const double inputs[] = {25.0, -3.0, 0.01, 0, 0, 0, 0, 0, 0};
    sensor.inputs(inputs);
    const Eigen::VectorXd biased = sensor.measure(somewhere);
    CHECK(largest(biased - plain - Eigen::Vector3d(25.0, -3.0, 0.01)) < 1e-10);
    const Eigen::MatrixXd tiny = 1e-14 * Eigen::Matrix3d::Identity();
    CHECK(largest(sensor.invert(biased, tiny).first - somewhere.head(2)) < 1e-6);
}

TEST_CASE("constant noise is constant and the other laws are told", "[sensor]") {
    const Instance plain("sensor", "polar_rate", {{"noise", "[100, 10, 1e-4]"}});
    CHECK(SensorUnderTest(plain).flags() == (PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT));
    CHECK(SensorUnderTest(plain).noise() == Eigen::MatrixXd(Eigen::Vector3d(1e4, 1e2, 1e-8).asDiagonal()));
    const Instance rated("sensor", "polar_rate", {{"snr", "0.1"}}),
        ranged("sensor", "polar_rate", {{"reference_range", "1e5"}});
    CHECK(SensorUnderTest(rated).flags() == std::uint32_t{PLR_SENSOR_CAN_INVERT});
    CHECK(SensorUnderTest(ranged).flags() == std::uint32_t{PLR_SENSOR_CAN_INVERT});
    const Shaped shaped({});
    CHECK(SensorUnderTest(shaped.sensor).flags() == (PLR_SENSOR_WAVEFORM | PLR_SENSOR_CAN_INVERT));
}

TEST_CASE("noise follows signal-to-noise ratio and the fourth power of range", "[sensor]") {
    const Eigen::MatrixXd r0 = Eigen::Vector3d(1e4, 1e2, 1e-8).asDiagonal();
    const auto agree = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
        return ((a - b).cwiseAbs().array() <= 1e-12 * b.cwiseAbs().array()).all();
    };
    const double echo = 8.0;
    const Instance rated("sensor", "polar_rate", {{"noise", "[100, 10, 1e-4]"}, {"snr", "0.1"}});
    CHECK(agree(SensorUnderTest(rated).noise_at(somewhere), 10.0 * r0));
    CHECK(agree(SensorUnderTest(rated).noise_at(somewhere, &echo), r0 / 8.0));
    // 50 km away from a sensor at the origin.
    const Instance ranged("sensor", "polar_rate", {{"noise", "[100, 10, 1e-4]"}, {"reference_range", "25 km"}});
    CHECK(agree(SensorUnderTest(ranged).noise_at(somewhere), 16.0 * r0));
    CHECK(agree(SensorUnderTest(ranged).noise_at(somewhere, &echo), r0 / 8.0));
    const Instance both(
        "sensor", "polar_rate",
        {{"noise", "[100, 10, 1e-4]"}, {"reference_range", "25 km"}, {"snr", "4"}, {"position", "[30e3, -15e3]"}});
    CHECK(agree(SensorUnderTest(both).noise_at(somewhere), r0 / 4.0));
    const Instance plain("sensor", "polar_rate", {{"noise", "[100, 10, 1e-4]"}});
    CHECK(agree(SensorUnderTest(plain).noise_at(somewhere, &echo), r0));
}

TEST_CASE("noise that vanishes or has no end is refused", "[sensor]") {
    const Instance ranged("sensor", "polar_rate", {{"reference_range", "25 km"}}),
        rated("sensor", "polar_rate", {{"snr", "1"}});
    const double none = 0.0;
    CHECK_THROWS_WITH(SensorUnderTest(ranged).noise_at(Eigen::Vector4d(0, 0, 1, 1)),
                      "the object is at the sensor's own position, where noise that grows with range vanishes");
    CHECK_THROWS_WITH(SensorUnderTest(rated).noise_at(somewhere, &none),
                      "the signal-to-noise ratio is 0.000000, expected a power ratio above 0");
}

TEST_CASE("a waveform model shapes the noise of the parameters in force", "[sensor]") {
    const Shaped shaped({{"noise", "[100, 10, 1e-4]"}, {"reference_range", "25 km"}});
    const SensorUnderTest sensor(shaped.sensor);
    const Eigen::Matrix3d base = 16.0 * Eigen::Matrix3d(Eigen::Vector3d(1e4, 1e2, 1e-8).asDiagonal());
    const double phi = 1.0;
    const Eigen::Matrix3d l = RotatingWaveform::turn(phi);
    CHECK(largest(sensor.noise_at(somewhere) - base) < 1e-9);
    CHECK(largest(sensor.noise_at(somewhere, nullptr, &phi) - l.transpose() * base * l) < 1e-9);
    CHECK(std::fabs(sensor.noise_at(somewhere, nullptr, &phi)(0, 1)) > 1e4);
    CHECK(std::string(sensor.part().info().waveform->components[0].name) == "rotation");
    const double wild = 20.0;
    CHECK_THROWS_WITH(sensor.noise_at(somewhere, nullptr, &wild), "the rotation is not within 10 rad");
}

TEST_CASE("one item that a waveform model refuses fails alone", "[sensor]") {
    const Shaped shaped({});
    const auto sensor = shaped.sensor.as<pelorus::SensorPart>();
    const double waveforms[] = {0.5, 20.0, 0.0};
    Batch out(3, 3, 3);
    Call call(3);
    auto args = pelorus::arguments<plr_sensor_noise>();
    args.cartesian = pelorus::common_view(somewhere.data(), 4, 1, 3);
    args.waveform = pelorus::const_view(waveforms, 1, 1, 3);
    args.out = out.out();
    CHECK(sensor.call(&plr_sensor::noise, call, args) == PLR_ITEMS_FAILED);
    CHECK(call.status(0) == PLR_OK);
    CHECK(call.status(1) == PLR_E_NUMERIC);
    CHECK(call.status(2) == PLR_OK);
    CHECK(call.error().item == 1);
    CHECK(largest(out[2] - Eigen::MatrixXd(Eigen::Vector3d(100, 1, 1e-6).asDiagonal())) < 1e-12);
    const double two[] = {0.5, 0.1};
    args.waveform = pelorus::const_view(two, 1, 1, 2);
    Call wrong(3);
    CHECK(sensor.call(&plr_sensor::noise, wrong, args) == PLR_E_ARGUMENT);
    CHECK(wrong.message() == "waveform: is 1 x 1 x 2, expected 1 x 1 x 3");
}

TEST_CASE("a waveform model of another measurement is refused by name", "[sensor]") {
    const Instance waveform(RotatingWaveform::plugin(), {}, {}, 0);
    try {
        const Instance refused("sensor", "spherical", {}, {{"waveform", "", &waveform}});
        FAIL("a waveform with range rate in a sensor without");
    } catch (const Refused& error) {
        CHECK(error.where == "waveform");
        CHECK(std::string(error.what()) ==
              "waveform.test_rotating shapes the noise of range [m], range_rate [m/s], azimuth [rad], this sensor "
              "measures range [m], azimuth [rad], elevation [rad]");
    }
}

TEST_CASE("a polar rate measurement is converted without bias at errors of degrees", "[sensor]") {
    const Instance instance("sensor", "polar_rate", {{"position", "[500, -800]"}, {"yaw", "1.1"}});
    SensorUnderTest(instance).check_conversion(somewhere, Eigen::Vector3d(50.0, 2.0, 0.05));
}

TEST_CASE("at its own position a polar rate sensor measures and has no derivative", "[sensor]") {
    const Instance instance("sensor", "polar_rate", {{"position", "[5, 6]"}});
    const SensorUnderTest sensor(instance);
    CHECK(sensor.measure(Eigen::Vector4d(5, 6, 7, 8)).isZero(0.0));
    CHECK_THROWS_WITH(sensor.jacobian(Eigen::Vector4d(5, 6, 7, 8)),
                      "the object is at the sensor's own position, where azimuth has no derivative");
}

TEST_CASE("polar rate residuals wrap the azimuth alone", "[sensor]") {
    const Instance instance("sensor", "polar_rate");
    const Eigen::VectorXd residual =
        SensorUnderTest(instance).residual(Eigen::Vector3d(100, 9.0, 3.1), Eigen::Vector3d(90, -9.0, -3.1));
    CHECK(residual(0) == 10.0);
    CHECK(residual(1) == 18.0);
    CHECK(residual(2) == Approx(6.2 - 2.0 * std::acos(-1.0)));
}
