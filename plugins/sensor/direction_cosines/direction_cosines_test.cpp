#include "../../../tests/support/sensor_checks.hpp"

using namespace test_support;

TEST_CASE("direction cosines are those of the line of sight along the array's axes", "[sensor]") {
    const Instance passive("sensor", "direction_cosines"),
        radar("sensor", "direction_cosines", {{"range_noise", "10"}, {"noise", "[1e-3, 2e-3]"}});
    const SensorUnderTest two(passive), three(radar);
    // 2, 3 and 6 along the axes: a distance of 7.
    CHECK((two.measure(Eigen::Vector3d(2, 3, 6)) - Eigen::Vector2d(3, 6) / 7.0).cwiseAbs().maxCoeff() < 1e-15);
    CHECK((three.measure(Eigen::Vector3d(2, 3, 6)) - Eigen::Vector3d(7, 3.0 / 7, 6.0 / 7)).cwiseAbs().maxCoeff() <
          1e-14);
    CHECK(two.component(0) == "direction_cosine.u");
    CHECK(three.component(0) == "range");
    CHECK((two.flags() & PLR_SENSOR_CAN_INVERT) == 0);
    CHECK((three.flags() & PLR_SENSOR_CAN_INVERT) != 0);
    CHECK(three.noise() == Eigen::MatrixXd(Eigen::Vector3d(10, 1e-3, 2e-3).cwiseAbs2().asDiagonal()));
    CHECK_THROWS_WITH(two.measure(Eigen::Vector3d(-2, 3, 6)), "the object is not in front of the array");
}

TEST_CASE("the Jacobian of direction cosines is the derivative of the measurement", "[sensor]") {
    for (const Values& values : {Values{}, Values{{"range_noise", "10"}}}) {
        Values mounted = values;
        mounted["position"] = "[10, 20, 30]";
        mounted["attitude"] = "[0.4, -0.3, -0.9]";
        const Instance instance("sensor", "direction_cosines", mounted);
        SensorUnderTest(instance).check_jacobian(Eigen::Vector3d(300, -400, 200), 1e-2);
    }
}

TEST_CASE("range and direction cosines are converted without bias where errors bend", "[sensor]") {
    const Instance instance("sensor", "direction_cosines",
                            {{"range_noise", "10"}, {"position", "[500, -800, 90]"}, {"attitude", "[0.2, -0.4, 0.3]"}});
    SensorUnderTest(instance).check_conversion(Eigen::Vector3d(70e3, 50e3, 20e3), Eigen::Vector3d(50.0, 0.02, 0.03));
}

TEST_CASE("a direction beyond the array's horizon tells no point", "[sensor]") {
    const Instance instance("sensor", "direction_cosines", {{"range_noise", "10"}});
    CHECK_THROWS_WITH(
        SensorUnderTest(instance).invert(Eigen::Vector3d(1000, 0.8, 0.7), 1e-8 * Eigen::Matrix3d::Identity()),
        "u^2 + v^2 is not below 1: the measurement points nowhere in front of the array");
}

TEST_CASE("the bias of direction cosines has the same three values with and without range", "[sensor]") {
    const double inputs[] = {5.0, 0.01, -0.02, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const Eigen::Vector3d p(200, 300, 600);
    for (const bool with_range : {false, true}) {
        const Instance instance("sensor", "direction_cosines", with_range ? Values{{"range_noise", "10"}} : Values{});
        SensorUnderTest sensor(instance);
        const Eigen::VectorXd plain = sensor.measure(p);
        sensor.inputs(inputs);
        const Eigen::VectorXd moved = sensor.measure(p) - plain;
        CHECK((moved.tail(2) - Eigen::Vector2d(0.01, -0.02)).cwiseAbs().maxCoeff() < 1e-14);
        if (with_range) CHECK(moved(0) == Approx(5.0));
    }
}
