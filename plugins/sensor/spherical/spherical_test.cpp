#include "../../../tests/support/reference.hpp"
#include "../../../tests/support/sensor_checks.hpp"
#include "../../common/sensing/spherical_model.hpp"

#include <random>

#include <pelorus/unbiased_conversion.hpp>

using namespace test_support;

namespace {

/// Rows (elevation, azimuth, range) of the reference library as (range, azimuth, elevation).
const std::vector<int> measurement_order{2, 1, 0};
/// Positions out of its (x, vx, y, vy, z, vz).
const std::vector<int> positions{0, 2, 4};

double largest(const Eigen::MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

void check_against(const nlohmann::json& answer, const Instance& instance) {
    const SensorUnderTest sensor(instance);
    const Eigen::VectorXd p = reordered(matrix(answer.at("x")), positions, {0});
    const Eigen::VectorXd h = reordered(matrix(answer.at("h")), measurement_order, {0});
    const Eigen::MatrixXd jacobian = reordered(matrix(answer.at("H")), measurement_order, positions);
    const Eigen::VectorXd z = sensor.measure(p);
    CHECK(std::fabs(z(0) - h(0)) < 1e-9 * h(0));
    CHECK(largest(z.tail(2) - h.tail(2)) < 1e-12);
    // The library's Jacobian is made of finite differences.
    const Eigen::MatrixXd difference = sensor.jacobian(p) - jacobian;
    CHECK(largest(difference.row(0)) < 1e-6);
    CHECK(largest(difference.bottomRows(2)) < 1e-6 * largest(jacobian.bottomRows(2)) + 1e-10);
}

}  // namespace

TEST_CASE("spherical measurement agrees with the reference library", "[sensor]") {
    const auto answers = reference("models_and_filters.json");
    check_against(answers.at("h EBR"), Instance("sensor", "spherical"));
    check_against(answers.at("h EBR moved+rotated"),
                  Instance("sensor", "spherical", {{"position", "[100, -200, 30]"}, {"attitude", "[0.1, 0.2, 0.3]"}}));
}

TEST_CASE("the spherical Jacobian is the derivative of the measurement", "[sensor]") {
    for (const char* const angle : {"elevation", "zenith"}) {
        const Instance instance("sensor", "spherical",
                                {{"angle", angle}, {"position", "[10, 20, 30]"}, {"attitude", "[0.4, -0.3, 2.5]"}});
        const SensorUnderTest sensor(instance);
        for (const Eigen::Vector3d& p : {Eigen::Vector3d(300, -400, 200), Eigen::Vector3d(-50, 2000, -900)}) {
            const Eigen::MatrixXd exact = sensor.jacobian(p), approximate = sensor.differences(p, 1e-2);
            for (int r = 0; r < 3; ++r)
                CHECK(largest(exact.row(r) - approximate.row(r)) < 1e-7 * largest(exact.row(r)));
        }
    }
}

TEST_CASE("a mount is turned by roll, pitch and yaw, right-handed", "[sensor]") {
    const auto seen = [](const char* attitude, const Eigen::Vector3d& p) {
        const Instance instance("sensor", "spherical", {{"attitude", attitude}});
        return SensorUnderTest(instance).measure(p);
    };
    // Yawed by 90 deg it looks along +y; pitched by 90 deg its x axis points down; rolled by 90 deg its y axis points up.
    CHECK(std::fabs(seen("[0 deg, 0 deg, 90 deg]", {0, 5, 0})(1)) < 1e-15);
    CHECK(std::fabs(seen("[0 deg, 90 deg, 0 deg]", {0, 0, -5})(1)) < 1e-15);
    CHECK(seen("[90 deg, 0 deg, 0 deg]", {0, 0, 5})(1) == Approx(std::acos(-1.0) / 2.0));
}

TEST_CASE("unbiased conversion gives the published covariance", "[sensor]") {
    const Eigen::Vector3d p(70e3, 70e3, 20e3), deviation(50.0, 0.8725e-3, 0.8725e-3);
    const auto converted =
        pelorus::unbiased_point(spherical::from_cartesian(p), Eigen::Matrix3d(deviation.cwiseAbs2().asDiagonal()));
    Eigen::Matrix3d expected;
    expected << 5083.391, -2376.922, -722.621, -2376.922, 5083.391, -722.621, -722.621, -722.621, 7558.352;
    CHECK(largest(converted.covariance - expected) < 6e-4);  // printed to a thousandth
    CHECK(largest(converted.mean - p) < 0.08);
}

TEST_CASE("unbiased conversion agrees with the plane test's points", "[sensor]") {
    const auto answers = reference("plane_test_cases.json");
    const Eigen::VectorXd sigma = matrix(answers.at("sigma")), r = matrix(answers.at("r"));
    const Eigen::VectorXd el = matrix(answers.at("el")), az = matrix(answers.at("az"));
    const Eigen::MatrixXd points = matrix(answers.at("xyz"));
    const Instance instance("sensor", "spherical");
    const SensorUnderTest sensor(instance);
    const Eigen::MatrixXd noise = Eigen::Vector3d(sigma(0), sigma(2), sigma(1)).cwiseAbs2().asDiagonal();
    for (int i = 0; i < 20; ++i) {
        const auto [mean, covariance] = sensor.invert(Eigen::Vector3d(r(i), az(i), el(i)), noise);
        CHECK(largest(mean - points.row(i).transpose()) < 1e-6 * r(i) * 1e-3);  // given to 1e-4 m
        if (i == 0) CHECK(largest(covariance - matrix(answers.at("cov0"))) < 1e-4);
    }
}

TEST_CASE("converted measurements are unbiased and as spread as they say, at errors of degrees, through the mount",
          "[sensor]") {
    const Instance instance("sensor", "spherical", {{"position", "[500, -800, 90]"}, {"attitude", "[0.2, -0.4, 1.1]"}});
    const SensorUnderTest sensor(instance);
    const Eigen::Vector3d truth(70e3, 70e3, 20e3), deviation(50.0, 0.05, 0.04);
    const Eigen::MatrixXd noise = deviation.cwiseAbs2().asDiagonal();
    const Eigen::VectorXd exact = sensor.measure(truth);
    const Eigen::MatrixXd expected = sensor.invert(exact, noise).second;

    std::mt19937_64 engine(4);
    std::normal_distribution<double> normal;
    const int draws = 40000;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
    for (int k = 0; k < draws; ++k) {
        Eigen::VectorXd z = exact;
        for (int c = 0; c < 3; ++c) z(c) += deviation(c) * normal(engine);
        const Eigen::Vector3d error = sensor.invert(z, noise).first - truth;
        sum += error;
        square += error * error.transpose();
    }
    for (int c = 0; c < 3; ++c) CHECK(std::fabs(sum(c) / draws) < 4.0 * std::sqrt(expected(c, c) / draws));
    CHECK(largest(square / draws - expected) < 0.03 * largest(expected));
    // The plain conversion is off by more than that: the test can tell.
    CHECK((1.0 - std::exp(-0.05 * 0.05 / 2.0)) * 100e3 > 4.0 * std::sqrt(largest(expected) / draws));
}

TEST_CASE("spherical noise follows range and signal-to-noise ratio", "[sensor]") {
    const Instance ranged("sensor", "spherical", {{"reference_range", "10 km"}, {"snr", "2"}, {"noise", "[4, 1, 1]"}});
    const SensorUnderTest sensor(ranged);
    CHECK((sensor.flags() & PLR_SENSOR_CONSTANT_NOISE) == 0);
    const double echo = 4.0;
    CHECK(sensor.noise_at(Eigen::Vector3d(0, 12e3, 16e3))(0, 0) == Approx(16.0 * 16.0 / 2.0));
    CHECK(sensor.noise_at(Eigen::Vector3d(0, 12e3, 16e3), &echo)(0, 0) == Approx(4.0));
}

TEST_CASE("a platform carries a spherical sensor with it", "[sensor]") {
    const Instance carried("sensor", "spherical", {{"position", "[0, 0, 5]"}, {"attitude", "[0, 0, 0.4]"}});
    SensorUnderTest sensor(carried);
    const double pi = std::acos(-1.0);
    // Rolled by 90 deg, what points up on the platform points to -y.
    const double inputs[] = {0, 0, 0, 100, 200, 300, pi / 2, 0, 0, 0, 0, 0};
    sensor.inputs(inputs);
    const Eigen::VectorXd z = sensor.measure(Eigen::Vector3d(100 + 30 * std::cos(0.4), 195, 300 + 30 * std::sin(0.4)));
    CHECK(largest(z - Eigen::Vector3d(30, 0, 0)) < 1e-12);
}

TEST_CASE("correlated errors reach the converted covariance", "[sensor]") {
    const Eigen::Vector3d z(1000.0, 0.7, 0.3);
    Eigen::Matrix3d noise;
    noise << 1.0, 2e-5, 1e-5, 2e-5, 1e-8, 0.0, 1e-5, 0.0, 1e-8;
    const Eigen::Matrix3d j = pelorus::conversion_slope(z);
    const Eigen::Matrix3d first_order = j * noise * j.transpose();
    CHECK(largest(pelorus::unbiased_point(z, noise).covariance - first_order) < 1e-6 * largest(first_order));
}

TEST_CASE("zenith is the complement of elevation", "[sensor]") {
    const Instance one("sensor", "spherical", {{"angle", "elevation"}}),
        other("sensor", "spherical", {{"angle", "zenith"}});
    const SensorUnderTest elevation(one), zenith(other);
    CHECK(elevation.component(2) == "elevation");
    CHECK(zenith.component(2) == "zenith");
    const Eigen::Vector3d p(300, -400, 1200);
    const Eigen::VectorXd ze = elevation.measure(p), zz = zenith.measure(p);
    CHECK(zz(2) == Approx(std::acos(1200.0 / p.norm())));
    CHECK(zz(2) == Approx(std::acos(-1.0) / 2.0 - ze(2)));
    Eigen::Matrix3d noise, mirrored;
    noise << 4.0, 1e-3, 2e-3, 1e-3, 1e-4, 1e-5, 2e-3, 1e-5, 1e-4;
    mirrored << 4.0, 1e-3, -2e-3, 1e-3, 1e-4, -1e-5, -2e-3, -1e-5, 1e-4;
    const auto a = elevation.invert(ze, noise), b = zenith.invert(zz, mirrored);
    CHECK(largest(a.first - b.first) < 1e-9);
    CHECK(largest(a.second - b.second) < 1e-8);
}

TEST_CASE("on its vertical axis and at its own position a spherical sensor fails the item alone, without a NaN",
          "[sensor]") {
    const Instance instance("sensor", "spherical", {{"position", "[10, 20, 30]"}});
    const auto sensor = instance.as<pelorus::SensorPart>();
    const double points[] = {10, 20, 530, 110, 20, 30, 10, 20, 30, 10, 20, -470};
    Batch seen(3, 1, 4), jacobian(3, 3, 4);
    Call call(4);
    auto measure = pelorus::arguments<plr_sensor_measure>();
    measure.cartesian = pelorus::const_view(points, 3, 1, 4);
    measure.out = seen.out();
    CHECK(sensor.call(&plr_sensor::measure, call, measure) == PLR_OK);
    CHECK(seen[0](0) == 500.0);
    CHECK(seen[0](2) == Approx(std::acos(-1.0) / 2.0));
    CHECK(seen[2].isZero(0.0));
    auto derive = pelorus::arguments<plr_sensor_jacobian>();
    derive.cartesian = measure.cartesian;
    derive.out = jacobian.out();
    CHECK(sensor.call(&plr_sensor::jacobian, call, derive) == PLR_ITEMS_FAILED);
    CHECK(call.status(0) == PLR_E_NUMERIC);
    CHECK(call.status(1) == PLR_OK);
    CHECK(call.status(2) == PLR_E_NUMERIC);
    CHECK(call.status(3) == PLR_E_NUMERIC);
    CHECK(call.message() == "the object is on the sensor's vertical axis, where azimuth has no derivative");
    CHECK(jacobian[1](0, 0) == 1.0);
}

TEST_CASE("a bias given as an input is measured, and taken off again by the inverse", "[sensor]") {
    const Instance instance("sensor", "spherical");
    SensorUnderTest sensor(instance);
    const Eigen::Vector3d p(3000, 4000, 500);
    const Eigen::VectorXd plain = sensor.measure(p);
    const double bias[] = {25.0, 0.01, -0.02, 0, 0, 0, 0, 0, 0, 0, 0, 0};  // and the pose of the platform
    sensor.inputs(bias);
    const Eigen::VectorXd biased = sensor.measure(p);
    CHECK(largest(biased - plain - Eigen::Vector3d(25.0, 0.01, -0.02)) < 1e-12);
    CHECK(largest(sensor.invert(biased, 1e-12 * Eigen::Matrix3d::Identity()).first - p) < 1e-6);
}

TEST_CASE("azimuths on both sides of the cut are close to each other", "[sensor]") {
    const Instance instance("sensor", "spherical");
    const SensorUnderTest sensor(instance);
    const Eigen::VectorXd residual = sensor.residual(Eigen::Vector3d(100, 3.1, 0.1), Eigen::Vector3d(90, -3.1, 0.2));
    CHECK(residual(0) == 10.0);
    CHECK(residual(1) == Approx(6.2 - 2.0 * std::acos(-1.0)));
    CHECK(residual(2) == Approx(-0.1));
}

TEST_CASE("a passive spherical sensor measures the angles of one with a range, with their noise and bias", "[sensor]") {
    const std::vector<std::pair<std::string, std::string>> mount{{"angle", "zenith"},
                                                                 {"position", "[10, 5, 3]"},
                                                                 {"attitude", "[-1 deg, 2 deg, -3 deg]"},
                                                                 {"noise", "[5, 1e-5, 2e-5]"}};
    Values own(mount.begin(), mount.end()), alone = own;
    alone["range"] = "passive";
    const Instance ranging("sensor", "spherical", own), passive("sensor", "spherical", alone);
    SensorUnderTest full(ranging), angles(passive);
    CHECK(angles.component(0) == "azimuth");
    CHECK(angles.component(1) == "zenith");
    CHECK((angles.flags() & PLR_SENSOR_CAN_INVERT) == 0);
    CHECK((angles.flags() & PLR_SENSOR_CONSTANT_NOISE) != 0);
    const double inputs[] = {40.0, 0.01, -0.02, 7, -6, 5, 0.3, -0.2, 0.1};
    full.inputs(inputs);
    angles.inputs(inputs);
    const Eigen::Vector3d p(950, 1250, 1050);
    CHECK(largest(angles.measure(p) - full.measure(p).tail(2)) < 1e-14);
    CHECK(largest(angles.noise_at(p) - full.noise_at(p).bottomRightCorner(2, 2)) < 1e-20);
    angles.check_jacobian(p, 1e-2);
}
