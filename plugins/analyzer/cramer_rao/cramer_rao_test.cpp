#include "cramer_rao.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include <Eigen/Dense>

#include "../../../tests/fixtures/results_of.hpp"

namespace {

using namespace pelorus::test;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
constexpr std::int64_t second = 1'000'000'000;
enum Port : std::uint32_t { scans, truth };
using Parts = std::vector<Instance::Part>;

std::shared_ptr<Instance> part(Bench& bench, const std::string& id, const std::string& with) {
    return std::make_shared<Instance>(bench, installed(id), with);
}

/// One object and its measurements, told by hand.
struct Bounded {
    Bench bench;
    StageUnderTest analyzer;
    ResultsOf results{bench, analyzer};
    pelorus::Space measured;
    std::uint64_t next_id = 1;

    Bounded(const std::string& motion, const std::string& motion_with, const std::string& sensor,
            const std::string& sensor_with, pelorus::Space space, const std::string& with = "{}")
        : analyzer(bench, plugin_of<cramer_rao::CramerRao>("analyzer.cramer_rao"), with,
                   Parts{{"motion", "", part(bench, motion, motion_with)},
                         {"sensors", "radar", part(bench, sensor, sensor_with)}}),
          measured(std::move(space)) {}

    /// A state as positions and velocities; `noise`: of each of so many measurements, or none told.
    void instant(double time, std::uint64_t id, const VectorXd& state, int measurements, const MatrixXd& noise = {},
                 const MatrixXd& extent = {}) {
        const auto at = std::llround(time * 1e9);
        const auto axes = static_cast<int>(state.size()) / 2;
        std::vector<std::uint64_t> ids;
        pelorus::ScanBuilder scan("radar", "", measured);
        const VectorXd value = VectorXd::Ones(measured.size());  // what was measured does not matter
        for (int k = 0; k < measurements; ++k) {
            ids.push_back(next_id++);
            scan.add(ids.back(), value.data(), noise.size() == 0 ? nullptr : noise.data());
        }
        pelorus::TruthBuilder builder("", pelorus::kinematic_space(axes, {1, 1}), static_cast<int>(extent.rows()));
        builder.add({id, at, state.data(), extent.size() == 0 ? nullptr : extent.data(), id, 0, ids});
        analyzer.receive(truth, builder.message(at));
        analyzer.receive(scans, scan.message(at));
    }
};

const char* const flat_velocity = "{dimension: 2, noise: 2 m2/s3, prior_position: 100 m, prior_velocity: 30 m/s}";

/// Kalman's covariance on one axis of constant velocity, seen at whole seconds.
std::vector<Matrix2d> kalman(int steps, double q, double r, const Matrix2d& prior) {
    Matrix2d f, noise;
    f << 1, 1, 0, 1;
    noise << q / 3, q / 2, q / 2, q;
    std::vector<Matrix2d> out;
    Matrix2d p = prior;
    for (int k = 0; k < steps; ++k) {
        if (k > 0) p = (f * p * f.transpose() + noise).eval();
        const Vector2d gain = p.col(0) / (p(0, 0) + r);
        p = (p - gain * p.row(0)).eval();
        out.push_back(p);
    }
    return out;
}

}  // namespace

TEST_CASE("Cramer-Rao: of a linear Gaussian model it is the Kalman filter's covariance", "[cramer_rao]") {
    Bounded run("motion.constant_velocity", flat_velocity, "sensor.position", "{dimension: 2, noise: 3 m}",
                pelorus::position_space(2));
    const auto expected = kalman(30, 2, 9, Vector2d(1e4, 900).asDiagonal());
    for (int k = 0; k < 30; ++k) run.instant(k, 7, VectorXd::Constant(4, 10.0 * k), 1);  // R by the sensor's model
    REQUIRE(run.results.table().rows.count == 30);
    for (int k = 0; k < 30; ++k) {
        const Matrix2d& p = expected[static_cast<std::size_t>(k)];
        CHECK(run.results.cell(k, "position") == Approx(std::sqrt(2 * p(0, 0))).epsilon(1e-12));
        CHECK(run.results.cell(k, "velocity") == Approx(std::sqrt(2 * p(1, 1))).epsilon(1e-12));
        CHECK(run.results.cell(k, "position.y") == Approx(std::sqrt(p(0, 0))).epsilon(1e-12));
    }
    CHECK(std::string(run.results.scalar("position_rmse").column) == "position");
    CHECK(run.results.column("velocity").reduce == PLR_REDUCE_ROOT_MEAN_SQUARE);
}

TEST_CASE("Cramer-Rao: a start of its own, and several measurements are as good as one of less noise", "[cramer_rao]") {
    Bounded run("motion.constant_velocity", flat_velocity, "sensor.position", "{dimension: 2}",
                pelorus::position_space(2), "{start_deviations: [5 m, 1 m/s]}");
    const auto expected = kalman(10, 2, 4.0 / 8, Vector2d(25, 1).asDiagonal());
    for (int k = 0; k < 10; ++k) run.instant(k, 7, VectorXd::Zero(4), 8, 4 * MatrixXd::Identity(2, 2));
    for (int k = 0; k < 10; ++k)
        CHECK(run.results.cell(k, "position") ==
              Approx(std::sqrt(2 * expected[static_cast<std::size_t>(k)](0, 0))).epsilon(1e-12));
    CHECK(run.results.cell(3, "measurements") == 8);
}

TEST_CASE("Cramer-Rao: without a measurement the bound is the prediction", "[cramer_rao]") {
    Bounded run("motion.constant_velocity", flat_velocity, "sensor.position", "{dimension: 2}",
                pelorus::position_space(2), "{start_deviations: [5 m, 1 m/s], from_scan: 1}");
    run.instant(0, 7, VectorXd::Zero(4), 0);
    run.instant(2, 7, VectorXd::Zero(4), 0);
    REQUIRE(run.results.table().rows.count == 1);
    CHECK(run.results.cell(0, "time") == 2);
    CHECK(run.results.cell(0, "position") == Approx(std::sqrt(2 * (25 + 4 + 2 * 8 / 3.0))).epsilon(1e-12));
    CHECK(run.results.cell(0, "velocity") == Approx(std::sqrt(2 * (1 + 2 * 2.0))).epsilon(1e-12));
}

TEST_CASE("Cramer-Rao: priors ten orders above the noise do no harm", "[cramer_rao]") {
    // A line through n points: the variance of its end is 2 (2 n - 1) / (n (n + 1)) R (the batch bound of constant velocity).
    Bounded run("motion.constant_velocity",
                "{dimension: 2, noise: 1e-14 m2/s3, prior_position: 1e5 m, prior_velocity: 1e4 m/s}", "sensor.position",
                "{dimension: 2, noise: 1 m}", pelorus::position_space(2));
    for (int k = 0; k < 100; ++k) run.instant(k, 7, VectorXd::Zero(4), 1);
    for (int n = 3; n <= 100; ++n)
        CHECK(run.results.cell(n - 1, "position") ==
              Approx(std::sqrt(2 * 2.0 * (2 * n - 1) / (n * (n + 1.0)))).epsilon(1e-5));
}

TEST_CASE("Cramer-Rao: floors of the airship, shape known", "[cramer_rao]") {
    // Independently: mean over scans 1 .. 99 of the bound of position and velocity with 10, 16 and 22 points.
    const double position[] = {3.00, 2.44, 2.13}, velocity[] = {1.28, 1.13, 1.04};
    const int points[] = {10, 16, 22};
    for (int i = 0; i < 3; ++i) {
        Bounded run("motion.singer",
                    "{form: truncated, maneuver_rate: 0.1 1/s, acceleration: 0.1 m/s2, prior_position: 1 km, "
                    "prior_velocity: 1 km/s, prior_acceleration: 0.2349 m/s2}",
                    "sensor.position", "{noise: 1 m}", pelorus::position_space(3), "{from_scan: 1}");
        const Eigen::Vector3d along = Eigen::Vector3d(1, 1, 0).normalized();
        const MatrixXd extent = 25 * MatrixXd::Identity(3, 3) + (144 - 25) * along * along.transpose();
        VectorXd state = VectorXd::Zero(6);
        for (int k = 0; k < 100; ++k) run.instant(k, 7, state, points[i], MatrixXd::Identity(3, 3), extent);
        double position_sum = 0, velocity_sum = 0;
        for (int k = 0; k < 99; ++k) {
            position_sum += run.results.cell(k, "position") / 99;
            velocity_sum += run.results.cell(k, "velocity") / 99;
        }
        CHECK(position_sum == Approx(position[i]).margin(0.006));
        CHECK(velocity_sum == Approx(velocity[i]).margin(0.006));
        CHECK(run.results.cell(5, "acceleration") > 0);
    }
}

TEST_CASE("Cramer-Rao: points of an extent scatter by as much of it as the factor says", "[cramer_rao]") {
    for (const double factor : {0.0, 0.25}) {
        Bounded run("motion.constant_velocity", flat_velocity, "sensor.position", "{dimension: 2}",
                    pelorus::position_space(2), "{extent_factor: " + std::to_string(factor) + "}");
        run.instant(0, 7, VectorXd::Zero(4), 4, MatrixXd::Identity(2, 2), 16 * MatrixXd::Identity(2, 2));
        const double variance = 1 / (1e-4 + 4 / (1 + 16 * factor));
        CHECK(run.results.cell(0, "position") == Approx(std::sqrt(2 * variance)).epsilon(1e-12));
    }
}

TEST_CASE("Cramer-Rao: a radar knows as much as its geometry where the object is allows", "[cramer_rao]") {
    // Far away on x, an error of azimuth and elevation is one across: 1000 m x 0.01 rad.
    const pelorus::Space spherical(
        {{"range", "m", 0, 0, false}, {"azimuth", "rad", 0, 0, true}, {"elevation", "rad", 0, 0, true}});
    Bounded run("motion.constant_velocity", "{prior_position: 1e5 m}", "sensor.spherical", "{}", spherical);
    VectorXd state = VectorXd::Zero(6);
    state(0) = 1000;
    run.instant(0, 7, state, 1, Eigen::Vector3d(4, 1e-4, 1e-4).asDiagonal().toDenseMatrix());
    CHECK(run.results.cell(0, "position.x") == Approx(2).epsilon(1e-6));
    CHECK(run.results.cell(0, "position.y") == Approx(10).epsilon(1e-6));
    CHECK(run.results.cell(0, "position.z") == Approx(10).epsilon(1e-6));
}

TEST_CASE("Cramer-Rao: objects of one time are told as their root mean square", "[cramer_rao]") {
    Bounded run("motion.constant_velocity", flat_velocity, "sensor.position", "{dimension: 2}",
                pelorus::position_space(2), "{start_deviations: [5 m, 1 m/s]}");
    run.instant(0, 1, VectorXd::Zero(4), 0);
    run.instant(0, 2, VectorXd::Zero(4), 1, 25 * MatrixXd::Identity(2, 2));
    CHECK(run.results.cell(0, "objects") == 2);
    CHECK(run.results.cell(0, "position") == Approx(std::sqrt((50 + 25) / 2.0)));
}

TEST_CASE("Cramer-Rao: goes on exactly where its saved state left off", "[cramer_rao]") {
    const auto make = [] {
        return std::make_unique<Bounded>("motion.constant_velocity", flat_velocity, "sensor.position", "{dimension: 2}",
                                         pelorus::position_space(2));
    };
    auto one = make(), two = make();
    one->instant(0, 1, VectorXd::Zero(4), 2, MatrixXd::Identity(2, 2));
    two->analyzer.load(one->analyzer.save());
    two->next_id = one->next_id;
    for (auto* run : {one.get(), two.get()}) run->instant(1, 1, VectorXd::Ones(4), 3);
    CHECK(two->results.cell(1, "position") == one->results.cell(1, "position"));
    CHECK(two->results.cell(0, "measurements") == 2);
}

TEST_CASE("Cramer-Rao: a truth without the motion's axes is refused", "[cramer_rao]") {
    Bounded run("motion.constant_velocity", "{}", "sensor.position", "{}", pelorus::position_space(3));
    pelorus::TruthBuilder flat("", pelorus::kinematic_space(2, {1, 1}));
    const double state[4] = {};
    flat.add({1, 0, state, nullptr, 1, 0, {}});
    CHECK_THROWS_WITH(run.analyzer.receive(truth, flat.message(0)), "this truth tells no position.z");
}
