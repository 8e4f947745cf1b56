#include <Eigen/Dense>

#include "../../../tests/support/trajectory_under_test.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* start = "start: [1 km, 2 km], velocity: [10 m/s, -5 m/s], acceleration: [1, 2], ";

/// A path in the plane under discrete constant acceleration, deviation 1 m/s2.
TrajectoryUnderTest drawn(std::uint64_t key, const std::string& with,
                          const std::string& motion = "{dimension: 2, form: discrete}") {
    static Bench parts;
    const auto model = part(parts, "motion", "constant_acceleration", motion);
    return TrajectoryUnderTest("random_motion", "{" + (start + with) + "}", {{"motion", "", model}}, {{key, ~key}});
}

/// F of a step over (x, y) positions, velocities, accelerations.
MatrixXd transition(double dt) {
    MatrixXd f = MatrixXd::Identity(6, 6);
    for (int axis = 0; axis < 2; ++axis) {
        f(axis, 2 + axis) = f(2 + axis, 4 + axis) = dt;
        f(axis, 4 + axis) = dt * dt / 2;
    }
    return f;
}

}  // namespace

TEST_CASE("random motion: steps are disturbed by the noise of the model and by nothing else", "[random_motion]") {
    std::vector<double> times;
    for (int k = 0; k <= 4000; ++k) times.push_back(0.5 * k);
    const MatrixXd x = drawn(3, "period: 0.5 s").at(times).states;
    MatrixXd sum = MatrixXd::Zero(6, 6);
    VectorXd g(3);
    g << 0.125, 0.5, 1;
    for (Eigen::Index k = 1; k < x.cols(); ++k) {
        const VectorXd noise = x.col(k) - transition(0.5) * x.col(k - 1);
        for (int axis = 0; axis < 2; ++axis)  // of rank one: g times a normal
            CHECK((VectorXd(noise(Eigen::seqN(axis, 3, 2))) - g * noise(4 + axis)).norm() < 1e-6);
        sum += noise * noise.transpose() / 4000;
    }
    MatrixXd expected = MatrixXd::Zero(6, 6);
    for (int axis = 0; axis < 2; ++axis) expected(Eigen::seqN(axis, 3, 2), Eigen::seqN(axis, 3, 2)) = g * g.transpose();
    CHECK((sum - expected).cwiseAbs().maxCoeff() < 0.1);  // 4.5 deviations of a variance of 1
}

TEST_CASE("random motion: starts have the mean and the deviations that are given", "[random_motion]") {
    constexpr int runs = 2000;
    VectorXd mean = VectorXd::Zero(6), square = VectorXd::Zero(6), expected(6), deviations(6);
    expected << 1000, 2000, 10, -5, 1, 2;
    deviations << 100, 100, 10, 10, 3, 3;
    for (std::uint64_t key = 0; key < runs; ++key) {
        const VectorXd error = drawn(key, "start_deviation: [100, 10, 3]").at({0}).states.col(0) - expected;
        mean += error.cwiseQuotient(deviations) / runs;
        square += error.cwiseQuotient(deviations).cwiseAbs2() / runs;
    }
    CHECK(mean.cwiseAbs().maxCoeff() < 5 / std::sqrt(runs));
    CHECK((square.array() - 1).abs().maxCoeff() < 5 * std::sqrt(2.0 / runs));
    CHECK(drawn(1, "").at({0}).states.col(0) == expected);
}

TEST_CASE("random motion: between steps the model carries the last one on, and asking changes nothing",
          "[random_motion]") {
    const auto path = drawn(5, "start_deviation: [100, 10, 3]");
    const MatrixXd x = path.at({7, 7.25, 7.999, 8}).states;
    CHECK((x.col(1) - transition(0.25) * x.col(0)).norm() < 1e-9);
    CHECK((x.col(3) - transition(1) * x.col(0)).norm() > 1e-3);
    CHECK((x.col(2) - transition(0.999) * x.col(0)).norm() < 1e-9);
    CHECK(path.at({8}).states.col(0) == x.col(3));
    CHECK(drawn(5, "start_deviation: [100, 10, 3]").at({8}).states == path.at({8}).states);
    CHECK(drawn(6, "start_deviation: [100, 10, 3]").at({8}).states != path.at({8}).states);
    const auto later = drawn(5, "start_deviation: [100, 10, 3], birth: 10 s, death: 20 s");
    CHECK(later.at({18}).states == path.at({8}).states);
    CHECK(std::isnan(later.at({20}).states(0, 0)));
}

TEST_CASE("random motion: what does not fit the model is refused by name", "[random_motion]") {
    const auto refused = [](const std::string& with, const char* motion) {
        try {
            drawn(1, with, motion);
        } catch (const std::exception& problem) {
            return std::string(problem.what());
        }
        return std::string();
    };
    CHECK(refused("", "{}") == "start: has 2 elements, the motion has 3 axes");
    CHECK(refused("birth: 2 s, death: 1 s", "{dimension: 2}") == "death: must be after birth");
    Bench bench;
    const auto velocity = part(bench, "motion", "constant_velocity", "{noise: 1, prior_velocity: 1}");
    CHECK_THROWS_WITH(BenchInstance(bench, plugin("trajectory", "random_motion"),
                                    "{start: [0 m, 0 m, 0 m], acceleration: [0, 0, 1]}", {{"motion", "", velocity}}),
                      "acceleration: the motion has no acceleration");
}
