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
