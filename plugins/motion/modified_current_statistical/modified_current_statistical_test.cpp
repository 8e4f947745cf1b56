#include "../../../tests/support/motion_filter.hpp"
#include "../../common/axis_models/singer.hpp"

using namespace test_support;

namespace {

/// A step of a filter on a line, and a posterior of that acceleration.
void step_to(MotionFilter& filter, double dt, double acceleration) {
    filter.predict(dt);
    filter.put(Eigen::Vector3d(0.0, 0.0, acceleration), Eigen::Matrix3d::Identity());
}

}  // namespace

TEST_CASE("the modified model starts as Singer's about the first acceleration", "[motion]") {
    const Instance instance("motion", "modified_current_statistical", {{"dimension", "1"}});
    const Eigen::Vector3d mean(10.0, -2.0, 4.0);
    const MotionFilter filter(instance, mean, Eigen::Matrix3d::Identity());
    // b = 4, so that position and velocity move as at a constant acceleration.
    const Eigen::VectorXd after = filter.moved(2.0, mean);
    CHECK(after(0) == Approx(10.0 - 4.0 + 8.0).epsilon(1e-14));
    CHECK(after(1) == Approx(-2.0 + 8.0).epsilon(1e-14));
    CHECK(after(2) == Approx(4.0).epsilon(1e-14));
    CHECK(relative_difference(filter.jacobian(2.0), singer::exact_transition(0.6, 2.0)) < 1e-15);
    const double variance = (4.0 / std::acos(-1.0) - 1.0) * 16.0;
    CHECK(filter.noise(2.0, after)(2, 2) == Approx(variance * (1.0 - std::exp(-2.4))).epsilon(1e-13));
}

TEST_CASE("the modified model extrapolates the acceleration from the last two", "[motion]") {
    const Instance instance("motion", "modified_current_statistical", {{"dimension", "1"}});
    MotionFilter filter(instance, Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Matrix3d::Identity());
    step_to(filter, 1.0, 3.0);
    // b = 3 + (3 - 1) = 5: x- = F x + (g - f) b with x = (0, 0, 3).
    const Eigen::Matrix3d f = singer::exact_transition(0.6, 1.0);
    const Eigen::Vector3d expected = 3.0 * f.col(2) + 5.0 * (Eigen::Vector3d(0.5, 1.0, 1.0) - f.col(2));
    CHECK(relative_difference(filter.moved(1.0, filter.mean()), expected) < 1e-14);
    const double variance = (4.0 / std::acos(-1.0) - 1.0) * 25.0;
    CHECK(filter.noise(1.0, expected)(2, 2) == Approx(variance * (1.0 - std::exp(-1.2))).epsilon(1e-12));
}

TEST_CASE("the modified model learns its rate from the fifth step on", "[motion]") {
    const Instance instance("motion", "modified_current_statistical", {{"dimension", "1"}});
    MotionFilter filter(instance, Eigen::Vector3d(0.0, 0.0, 8.0), Eigen::Matrix3d::Identity());
    const auto rate = [&] { return -std::log(filter.jacobian(1.0)(2, 2)); };
    const double accelerations[] = {9.0, 12.0, 11.0, 14.0, 20.0};
    // The means begin with 1.5 m/s2 and the rate of the first steps.
    double square = 2.25, product = 2.25 * std::exp(-0.6 * 2.0), last = 8.0;
    for (int step = 1; step <= 5; ++step) {
        CHECK(rate() == Approx(step < 5 ? 0.6 : -std::log(product / square) / 2.0).epsilon(1e-12));
        const double now = accelerations[step - 1];
        step_to(filter, 2.0, now);
        square = 0.9 * square + 0.1 * now * now;
        product = 0.9 * product + 0.1 * now * last;
        last = now;
    }
    CHECK(rate() == Approx(-std::log(product / square) / 2.0).epsilon(1e-12));
}

TEST_CASE("the rate that the modified model learns keeps its bounds", "[motion]") {
    const Instance instance("motion", "modified_current_statistical",
                            {{"dimension", "1"}, {"start_deviation", "0 m/s2"}});
    const auto rate_after = [&](double factor) {
        MotionFilter filter(instance, Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Matrix3d::Identity());
        double acceleration = 1.0;
        for (int step = 0; step < 6; ++step) step_to(filter, 1.0, acceleration *= factor);
        return -std::log(filter.jacobian(1.0)(2, 2));
    };
    CHECK(rate_after(1.25) == Approx(-std::log(0.8)).epsilon(1e-12));
    CHECK(rate_after(100.0) == Approx(3.0).epsilon(1e-12));   // r1 = r0 / 100
    CHECK(rate_after(1.001) == Approx(0.01).epsilon(1e-12));  // r1 = 0.999 r0
}

TEST_CASE("the modified model keeps its rate where the accelerations tell of none", "[motion]") {
    const Instance instance("motion", "modified_current_statistical",
                            {{"dimension", "1"}, {"start_deviation", "0 m/s2"}});
    MotionFilter filter(instance, Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Matrix3d::Identity());
    const auto rate = [&] { return -std::log(filter.jacobian(1.0)(2, 2)); };
    double acceleration = 1.0;
    for (int step = 0; step < 6; ++step) step_to(filter, 1.0, acceleration *= 1.25);
    const double learned = rate();
    CHECK(learned == Approx(-std::log(0.8)).epsilon(1e-12));
    step_to(filter, 1.0, -2.0 * acceleration);  // turns over: r1 < 0
    CHECK(rate() == Approx(learned).epsilon(1e-12));
    step_to(filter, 1.0, -2.0 * acceleration);
    for (int step = 0; step < 30; ++step) step_to(filter, 1.0, acceleration *= 0.5);  // correlated by more than 1
    const double before = rate();
    step_to(filter, 1.0, acceleration *= 0.5);
    CHECK(rate() == Approx(before).epsilon(1e-12));
}

TEST_CASE("the modified model is never quite sure of its acceleration", "[motion]") {
    const Instance instance("motion", "modified_current_statistical", {{"dimension", "1"}});
    const MotionFilter filter(instance, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity());
    CHECK(filter.noise(1.0, filter.mean())(2, 2) == Approx(0.01 * (1.0 - std::exp(-1.2))).epsilon(1e-13));
}

TEST_CASE("the modified model keeps each axis to itself", "[motion]") {
    const Instance plane("motion", "modified_current_statistical", {{"dimension", "2"}}),
        line("motion", "modified_current_statistical", {{"dimension", "1"}});
    Eigen::VectorXd start(6);
    start << 0.0, 0.0, 3.0, -1.0, 2.0, -5.0;
    MotionFilter both(plane, start, Eigen::MatrixXd::Identity(6, 6));
    MotionFilter second(line, Eigen::Vector3d(0.0, -1.0, -5.0), Eigen::Matrix3d::Identity());
    for (int step = 0; step < 8; ++step) {
        both.predict(0.5);
        second.predict(0.5);
    }
    for (int r = 0; r < 3; ++r) {
        CHECK(both.mean()(2 * r + 1) == Approx(second.mean()(r)).epsilon(1e-12));
        CHECK(both.covariance()(2 * r + 1, 2 * r + 1) == Approx(second.covariance()(r, r)).epsilon(1e-12));
    }
}
