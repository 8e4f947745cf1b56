#include "../../../tests/support/reference.hpp"
#include "../../../tests/support/sensor_checks.hpp"

using namespace test_support;

TEST_CASE("bearings agree with the reference library", "[sensor]") {
    const auto answers = reference("models_and_filters.json");
    const nlohmann::json& answer = answers.at("h EBR moved+rotated");
    const Instance instance("sensor", "bearings", {{"position", "[100, -200, 30]"}, {"attitude", "[0.1, 0.2, 0.3]"}});
    const SensorUnderTest sensor(instance);
    const Eigen::VectorXd p = reordered(matrix(answer.at("x")), {0, 2, 4}, {0}), h = matrix(answer.at("h"));
    CHECK(sensor.measure(p)(0) == Approx(h(1)).epsilon(1e-12));
    CHECK(sensor.measure(p)(1) == Approx(h(0)).epsilon(1e-12));
    CHECK((sensor.flags() & PLR_SENSOR_CAN_INVERT) == 0);
}

TEST_CASE("the Jacobian of bearings is the derivative of the measurement", "[sensor]") {
    for (const char* const angle : {"elevation", "zenith"}) {
        const Instance instance("sensor", "bearings", {{"angle", angle}, {"attitude", "[0.4, -0.3, 2.5]"}});
        SensorUnderTest(instance).check_jacobian(Eigen::Vector3d(300, -400, 200), 1e-2);
    }
}

TEST_CASE("zenith angles of bearings complement elevations and wrap", "[sensor]") {
    const Instance instance("sensor", "bearings", {{"angle", "zenith"}});
    const SensorUnderTest sensor(instance);
    CHECK(sensor.component(1) == "zenith");
    CHECK(sensor.measure(Eigen::Vector3d(0, 5, 5))(1) == Approx(std::acos(-1.0) / 4.0));
    CHECK(sensor.residual(Eigen::Vector2d(3.1, 0.2), Eigen::Vector2d(-3.1, 0.1))(0) ==
          Approx(6.2 - 2.0 * std::acos(-1.0)));
}
