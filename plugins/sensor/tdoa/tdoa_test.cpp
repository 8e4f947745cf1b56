#include "../../../tests/support/sensor_checks.hpp"

using namespace test_support;

namespace {

const char* const triangle = "[[0, 0], [60, 0], [0, 80]]";

}  // namespace

TEST_CASE("differences of arrival are those of the ranges to the receivers", "[sensor]") {
    const Instance instance("sensor", "tdoa", {{"receivers", triangle}, {"noise", "[1, 2, 3]"}});
    const SensorUnderTest sensor(instance);
    // From (60, 80): 100 to the reference, 80 and 60 to the others.
    CHECK((sensor.measure(Eigen::Vector2d(60, 80)) - Eigen::Vector2d(-20, -40)).cwiseAbs().maxCoeff() < 1e-12);
    Eigen::Matrix2d noise;
    noise << 1 + 4, 1, 1, 1 + 9;
    CHECK(sensor.noise() == Eigen::MatrixXd(noise));
    CHECK(sensor.component(1) == "range_difference.2");
    CHECK(sensor.flags() == std::uint32_t{PLR_SENSOR_CONSTANT_NOISE});
}

TEST_CASE("differences of arrival in time are those in range over the speed", "[sensor]") {
    const Instance instance("sensor", "tdoa",
                            {{"receivers", triangle}, {"noise", "[3]"}, {"quantity", "time"}, {"speed", "1500"}});
    const SensorUnderTest sensor(instance);
    CHECK(sensor.measure(Eigen::Vector2d(60, 80))(1) == Approx(-40.0 / 1500.0));
    CHECK(sensor.noise()(0, 0) == Approx(2.0 * 9.0 / 1500.0 / 1500.0));
    CHECK(sensor.noise()(0, 1) == Approx(9.0 / 1500.0 / 1500.0));
    CHECK(sensor.component(0) == "time_difference.1");
}

TEST_CASE("the covariance of differences of arrival is that of drawn arrivals", "[sensor]") {
    const Instance instance("sensor", "tdoa", {{"receivers", triangle}, {"noise", "[1, 2, 3]"}});
    const Eigen::MatrixXd told = SensorUnderTest(instance).noise();
    std::mt19937_64 engine(5);
    std::normal_distribution<double> normal;
    Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
    constexpr int draws = 40000;
    for (int k = 0; k < draws; ++k) {
        const double reference = normal(engine), one = 2.0 * normal(engine), two = 3.0 * normal(engine);
        const Eigen::Vector2d d(one - reference, two - reference);
        square += d * d.transpose() / draws;
    }
    CHECK((square - told).cwiseAbs().maxCoeff() < 0.03 * told.maxCoeff());
}

TEST_CASE("the Jacobian of differences of arrival is the derivative of the measurement", "[sensor]") {
    const Instance plane("sensor", "tdoa", {{"receivers", triangle}});
    SensorUnderTest(plane).check_jacobian(Eigen::Vector2d(300, -400), 1e-2);
    const Instance space("sensor", "tdoa",
                         {{"receivers", "[[0, 0, 0], [60, 0, 1], [0, 80, 2], [5, 5, 50], [-9, 8, 7]]"}});
    SensorUnderTest(space).check_jacobian(Eigen::Vector3d(300, -400, 200), 1e-2);
    CHECK_THROWS_WITH(SensorUnderTest(plane).jacobian(Eigen::Vector2d(60, 0)),
                      "the object is at a receiver, where its range has no derivative");
}

TEST_CASE("receivers at one place and noises of another number are refused", "[sensor]") {
    try {
        const Instance refused("sensor", "tdoa", {{"receivers", "[[0, 0], [60, 0], [0, 0]]"}});
        FAIL("two receivers at one place");
    } catch (const Refused& error) {
        CHECK(error.where == "receivers");
        CHECK(std::string(error.what()) == "rows 1 and 3 are the same place");
    }
    try {
        const Instance refused("sensor", "tdoa", {{"receivers", triangle}, {"noise", "[1, 2]"}});
        FAIL("two noises of three receivers");
    } catch (const Refused& error) {
        CHECK(std::string(error.what()) == "has 2 values, expected 1 or 3 (the receivers)");
    }
}
