#include "../../../tests/support/sensor_checks.hpp"

using namespace test_support;

TEST_CASE("a position sensor measures from where it stands", "[sensor]") {
    const Instance instance("sensor", "position", {{"position", "[1, 2, 3]"}, {"noise", "[1, 2, 4]"}});
    const SensorUnderTest sensor(instance);
    const Eigen::Vector3d p(10.0, 20.0, 30.0);
    CHECK(sensor.measure(p) == Eigen::Vector3d(9.0, 18.0, 27.0));
    CHECK(sensor.jacobian(p) == Eigen::Matrix3d::Identity());
    CHECK(sensor.noise() == Eigen::Matrix3d(Eigen::Vector3d(1.0, 4.0, 16.0).asDiagonal()));
    CHECK(sensor.residual(p, Eigen::Vector3d(1.0, 1.0, 1.0)) == Eigen::Vector3d(9.0, 19.0, 29.0));
    const Eigen::MatrixXd noise = Eigen::Vector3d(9.0, 16.0, 25.0).asDiagonal();
    const auto [mean, covariance] = sensor.invert(sensor.measure(p), noise);
    CHECK(mean == p);
    CHECK(covariance == noise);
    constexpr std::uint32_t flags = PLR_SENSOR_LINEAR | PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT;
    CHECK(sensor.flags() == flags);
}

TEST_CASE("a position sensor has one to three axes, with one noise or one an axis", "[sensor]") {
    const Instance plane("sensor", "position", {{"dimension", "2"}, {"noise", "3 m"}});
    CHECK(SensorUnderTest(plane).noise() == Eigen::MatrixXd(9.0 * Eigen::Matrix2d::Identity()));
    CHECK(SensorUnderTest(plane).component(1) == "position.y");
    const Instance line("sensor", "position", {{"dimension", "1"}});
    CHECK(SensorUnderTest(line).measure(Eigen::VectorXd::Constant(1, 5.0))(0) == 5.0);
    try {
        const Instance refused("sensor", "position", {{"dimension", "2"}, {"noise", "[1, 2, 3]"}});
        FAIL("three values for two axes");
    } catch (const Refused& error) {
        CHECK(error.where == "noise");
    }
}

TEST_CASE("a position sensor that measures velocity has both in each direction", "[sensor]") {
    const Instance instance(
        "sensor", "position",
        {{"velocity", "true"}, {"position", "[1, 2, 3]"}, {"noise", "[1, 2, 4]"}, {"velocity_noise", "[0.5, 3, 5]"}});
    const SensorUnderTest sensor(instance);
    Eigen::VectorXd x(6), seen(6), deviations(6);
    x << 10, 20, 30, -4, 5, -6;
    seen << 9, 18, 27, -4, 5, -6;  // the mount rests: velocities stay as they are
    deviations << 1, 2, 4, 0.5, 3, 5;
    CHECK(sensor.measure(x) == seen);
    CHECK(sensor.jacobian(x) == Eigen::MatrixXd::Identity(6, 6));
    CHECK(sensor.noise() == Eigen::MatrixXd(deviations.cwiseAbs2().asDiagonal()));
    CHECK(sensor.component(2) == "position.z");
    CHECK(sensor.component(3) == "velocity.x");
    CHECK(sensor.component(5) == "velocity.z");
    Eigen::MatrixXd noise = Eigen::MatrixXd::Constant(6, 6, 0.25);  // errors of position and velocity may go together
    noise.diagonal() = deviations;
    const auto [mean, covariance] = sensor.invert(seen, noise);
    CHECK(mean == x);
    CHECK(covariance == noise);
    CHECK(sensor.part().info().inverse->size == 6);
    constexpr std::uint32_t flags = PLR_SENSOR_LINEAR | PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT;
    CHECK(sensor.flags() == flags);
}

TEST_CASE("velocity is measured on as many axes as position, with a deviation of 1 m per s unless one is given",
          "[sensor]") {
    const Instance plane("sensor", "position", {{"dimension", "2"}, {"velocity", "true"}, {"noise", "3 m"}});
    CHECK(SensorUnderTest(plane).noise() == Eigen::MatrixXd(Eigen::Vector4d(9, 9, 1, 1).asDiagonal()));
    CHECK(SensorUnderTest(plane).component(3) == "velocity.y");
    const Instance line("sensor", "position", {{"dimension", "1"}, {"velocity", "true"}, {"velocity_noise", "2"}});
    CHECK(SensorUnderTest(line).noise() == Eigen::MatrixXd(Eigen::Vector2d(1, 4).asDiagonal()));
    CHECK(SensorUnderTest(line).measure(Eigen::Vector2d(5, -7)) == Eigen::Vector2d(5, -7));
}

TEST_CASE("noise of a velocity that does not fit is refused", "[sensor]") {
    const auto refusal = [](const Values& values) -> std::string {
        try {
            const Instance refused("sensor", "position", values);
            return "";
        } catch (const Refused& error) {
            return error.where + ": " + error.what();
        }
    };
    CHECK_THAT(refusal({{"velocity_noise", "2 m/s"}}),
               Catch::Contains("velocity_noise") && Catch::Contains("velocity is not measured (velocity: true)"));
    CHECK_THAT(refusal({{"dimension", "2"}, {"velocity", "true"}, {"velocity_noise", "[1, 2, 3]"}}),
               Catch::Contains("velocity_noise") && Catch::Contains("expected 1 or 2"));
}
