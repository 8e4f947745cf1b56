#include "../../../tests/support/reference.hpp"
#include "../../../tests/support/sensor_checks.hpp"
#include "../../common/sensing/polar_model.hpp"

#include <pelorus/unbiased_conversion.hpp>

using namespace test_support;

TEST_CASE("polar measurement agrees with the reference library", "[sensor]") {
    const auto answers = reference("models_and_filters.json");
    const nlohmann::json& answer = answers.at("h BR (x,y)");
    const Instance instance("sensor", "polar");
    const SensorUnderTest sensor(instance);
    const Eigen::VectorXd given = matrix(answer.at("x")), h = matrix(answer.at("h"));
    const Eigen::Vector2d p(given(0), given(2));
    CHECK(sensor.measure(p)(0) == Approx(h(1)).epsilon(1e-12));
    CHECK(sensor.measure(p)(1) == Approx(h(0)).epsilon(1e-12));
    const Eigen::MatrixXd jacobian = sensor.jacobian(p), expected = matrix(answer.at("H"));
    for (const int axis : {0, 1}) {
        CHECK(jacobian(0, axis) == Approx(expected(1, 2 * axis)).epsilon(1e-6));
        CHECK(jacobian(1, axis) == Approx(expected(0, 2 * axis)).epsilon(1e-6));
    }
}

TEST_CASE("the polar Jacobian is the derivative of the measurement through the mount", "[sensor]") {
    const Instance instance("sensor", "polar", {{"position", "[10, 20]"}, {"yaw", "2.5"}});
    const SensorUnderTest sensor(instance);
    sensor.check_jacobian(Eigen::Vector2d(300, -400), 1e-2);
    sensor.check_jacobian(Eigen::Vector2d(-50, 2000), 1e-2);
}

TEST_CASE("unbiased polar conversion has the moments of normal angles", "[sensor]") {
    // By hand, for r = 100, sr = 2, a = 0: E x^2 = e^(s^2) (r^2 + sr^2) (1 + e^(-2 s^2)) / 2 and its like.
    const double s2 = 0.01;
    Eigen::Matrix2d noise;
    noise << 4.0, 0.0, 0.0, s2;
    const auto found = pelorus::unbiased_point(Eigen::Vector2d(100.0, 0.0), noise);
    CHECK(found.mean(0) == Approx(100.0 * std::exp(s2 / 2.0)));
    CHECK(found.mean(1) == 0.0);
    CHECK(found.covariance(0, 0) == Approx(std::exp(s2) * 10004.0 * (1.0 + std::exp(-2.0 * s2)) / 2.0 - 1e4));
    CHECK(found.covariance(1, 1) == Approx(std::exp(s2) * 10004.0 * (1.0 - std::exp(-2.0 * s2)) / 2.0));
    CHECK(std::fabs(found.covariance(0, 1)) < 1e-12);
}

TEST_CASE("polar measurements are converted without bias at errors of degrees", "[sensor]") {
    const Instance instance("sensor", "polar", {{"position", "[500, -800]"}, {"yaw", "1.1"}});
    SensorUnderTest(instance).check_conversion(Eigen::Vector2d(30e3, -40e3), Eigen::Vector2d(50.0, 0.05));
}

TEST_CASE("polar residuals wrap and noise follows its law", "[sensor]") {
    const Instance instance("sensor", "polar", {{"noise", "[3, 0.1]"}, {"reference_range", "10"}, {"snr", "2"}});
    const SensorUnderTest sensor(instance);
    CHECK(sensor.residual(Eigen::Vector2d(5, 3.1), Eigen::Vector2d(1, -3.1))(1) == Approx(6.2 - 2.0 * std::acos(-1.0)));
    const Eigen::MatrixXd noise = sensor.noise_at(Eigen::Vector2d(0, 20));
    CHECK(noise(0, 0) == Approx(9.0 * 16.0 / 2.0));
    CHECK(noise(1, 1) == Approx(0.01 * 16.0 / 2.0));
}
