#include "../../../tests/support/reference.hpp"
#include "../../../tests/support/sensor_checks.hpp"

using namespace test_support;

namespace {

const std::vector<int> measurement_order{2, 3, 1, 0};  // of the reference: elevation, azimuth, range, range rate
const std::vector<int> state_order{0, 2, 4, 1, 3, 5};  // of its (x, vx, y, vy, z, vz)

void check_against(const nlohmann::json& answer, const Instance& instance) {
    const SensorUnderTest sensor(instance);
    const Eigen::VectorXd x = reordered(matrix(answer.at("x")), state_order, {0});
    const Eigen::VectorXd h = reordered(matrix(answer.at("h")), measurement_order, {0}), z = sensor.measure(x);
    const Eigen::MatrixXd expected = reordered(matrix(answer.at("H")), measurement_order, state_order);
    const Eigen::MatrixXd jacobian = sensor.jacobian(x);
    for (int r = 0; r < 4; ++r) {
        INFO("component " << r);
        CHECK(z(r) == Approx(h(r)).epsilon(1e-12));
        CHECK((jacobian.row(r) - expected.row(r)).cwiseAbs().maxCoeff() < 1e-6 * expected.row(r).cwiseAbs().maxCoeff());
    }
}

}  // namespace

TEST_CASE("spherical rate measurement agrees with the reference library", "[sensor]") {
    const auto answers = reference("models_and_filters.json");
    check_against(answers.at("h EBRR"), Instance("sensor", "spherical_rate"));
    check_against(
        answers.at("h EBRR moved+rotated+velocity"),
        Instance("sensor", "spherical_rate",
                 {{"position", "[100, -200, 30]"}, {"attitude", "[0.1, 0.2, 0.3]"}, {"velocity", "[10, 20, -5]"}}));
}

TEST_CASE("the spherical rate Jacobian is the derivative of the measurement", "[sensor]") {
    for (const char* const angle : {"elevation", "zenith"}) {
        const Instance instance("sensor", "spherical_rate",
                                {{"angle", angle},
                                 {"position", "[10, 20, 30]"},
                                 {"attitude", "[0.4, -0.3, 2.5]"},
                                 {"velocity", "[9, 8, -7]"}});
        Eigen::VectorXd x(6);
        x << 300, -400, 200, 40, -30, 70;
        SensorUnderTest(instance).check_jacobian(x, 1e-2);
    }
}

TEST_CASE("spherical rate measurements are converted to positions without bias", "[sensor]") {
    const Instance instance("sensor", "spherical_rate",
                            {{"position", "[500, -800, 90]"}, {"attitude", "[0.2, -0.4, 1.1]"}, {"angle", "zenith"}});
    Eigen::VectorXd x(6);
    x << 70e3, 70e3, 20e3, 40, -30, 70;
    SensorUnderTest(instance).check_conversion(x, Eigen::Vector4d(50.0, 2.0, 0.05, 0.04));
}

TEST_CASE("above itself a spherical rate sensor measures and has no derivative", "[sensor]") {
    const Instance instance("sensor", "spherical_rate");
    Eigen::VectorXd x(6);
    x << 0, 0, 500, 1, 2, 3;
    const SensorUnderTest sensor(instance);
    CHECK(sensor.measure(x)(1) == 3.0);
    CHECK_THROWS_WITH(sensor.jacobian(x),
                      "the object is on the sensor's vertical axis, where azimuth has no derivative");
}
