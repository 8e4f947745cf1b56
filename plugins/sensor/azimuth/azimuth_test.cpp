#include "../../../tests/support/sensor_checks.hpp"

using namespace test_support;

TEST_CASE("an azimuth sensor tells a bearing and nothing else", "[sensor]") {
    const Instance instance("sensor", "azimuth", {{"position", "[10, 20]"}, {"yaw", "90 deg"}, {"noise", "0.02"}});
    const SensorUnderTest sensor(instance);
    CHECK(sensor.flags() == std::uint32_t{PLR_SENSOR_CONSTANT_NOISE});
    CHECK(sensor.measure(Eigen::Vector2d(0, 30))(0) == Approx(std::acos(-1.0) / 4.0));
    CHECK(sensor.noise()(0, 0) == Approx(4e-4));
    sensor.check_jacobian(Eigen::Vector2d(300, -400), 1e-2);
    CHECK(sensor.residual(Eigen::VectorXd::Constant(1, 3.1), Eigen::VectorXd::Constant(1, -3.1))(0) ==
          Approx(6.2 - 2.0 * std::acos(-1.0)));
    CHECK_THROWS_WITH(sensor.jacobian(Eigen::Vector2d(10, 20)),
                      "the object is at the sensor's own position, where azimuth has no derivative");
}

TEST_CASE("the bias of an azimuth sensor is added and wrapped", "[sensor]") {
    const Instance instance("sensor", "azimuth");
    SensorUnderTest sensor(instance);
    const double inputs[] = {0.5, 0, 0, 0, 0};
    sensor.inputs(inputs);
    CHECK(sensor.measure(Eigen::Vector2d(-10, 1e-9))(0) == Approx(0.5 - std::acos(-1.0)));
}
