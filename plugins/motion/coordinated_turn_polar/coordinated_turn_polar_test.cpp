#include "../../../tests/support/motion_at.hpp"

using namespace test_support;
using Eigen::VectorXd;

namespace {

constexpr double pi = 3.14159265358979323846;

VectorXd state(double x, double y, double speed, double heading, double turn_rate) {
    VectorXd out(5);
    out << x, y, speed, heading, turn_rate;
    return out;
}

}  // namespace

TEST_CASE("the polar coordinated turn goes where the Cartesian one goes", "[motion][turn][polar]") {
    const Instance polar("motion", "coordinated_turn_polar");
    const Instance cartesian("motion", "coordinated_turn", {{"dimension", "2"}});
    const MotionAt motion(polar);
    for (const double rate : {0.0, 1e-9, 0.05, -0.7, 3.0})
        for (const double dt : {0.1, 2.0, 30.0, -4.0}) {
            const VectorXd x = state(100.0, -50.0, 25.0, 2.5, rate);
            const VectorXd after = motion.to_cartesian(motion.propagate(dt, x));
            CHECK((after - MotionAt(cartesian).propagate(dt, motion.to_cartesian(x))).norm() < 1e-10);
        }
}

TEST_CASE("a quarter of a circle ends a quarter turn on", "[motion][turn][polar]") {
    const Instance polar("motion", "coordinated_turn_polar");
    const double w = 0.5, dt = pi / 2.0 / w, radius = 40.0 / w;
    const VectorXd end = MotionAt(polar).propagate(dt, state(0.0, 0.0, 40.0, pi / 2.0, w));
    CHECK((end - state(-radius, radius, 40.0, pi, w)).norm() < 1e-12);
    CHECK(MotionAt(polar).propagate(dt, end)(3) == Approx(-pi / 2.0));  // wrapped
}

TEST_CASE("Jacobians of the polar coordinated turn are derivatives", "[motion][turn][polar]") {
    const Instance polar("motion", "coordinated_turn_polar");
    const MotionAt motion(polar);
    for (const double rate : {0.0, 1e-8, 1e-3, 0.3, -1.9999, 2.0001, 5.0})
        for (const double dt : {0.02, 1.0, 6.0, -2.0})
            CHECK(motion.jacobian_error(dt, state(10.0, 20.0, 30.0, -3.0, rate)) < 1e-8);
    CHECK(motion.jacobian_error(1.0, state(0.0, 0.0, 0.0, 1.0, 0.2)) < 1e-8);
    CHECK(motion.conversion_error(state(10.0, 20.0, 30.0, -3.0, 0.2)) < 1e-8);
    // The difference of the headings is wrapped: pi is crossed.
    CHECK(motion.jacobian_error(1.0, state(0.0, 0.0, 30.0, 3.14, 0.0)) < 1e-8);
}

TEST_CASE("at rest the heading is not told by the velocity", "[motion][turn][polar]") {
    const Instance polar("motion", "coordinated_turn_polar");
    const MotionAt motion(polar);
    const VectorXd rest = VectorXd::Zero(5);
    CHECK(motion.from_cartesian(rest) == rest);
    CHECK(motion.from_cartesian_jacobian(rest).row(3).isZero(0.0));
}

TEST_CASE("the noise of the polar turn is what white accelerations along and about make of it",
          "[motion][turn][polar]") {
    const Instance polar("motion", "coordinated_turn_polar", {{"noise", "0.5"}, {"turn_rate_noise", "0.002"}});
    const MotionAt motion(polar);
    const VectorXd x = state(0.0, 0.0, 20.0, 0.7, 0.1);
    const double dt = 1.0;
    const int steps = 200;
    // The covariance by the linearised motion: exact up to the turn within the step, here 0.1 rad.
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(5, 5), g = p;
    g(2, 2) = 0.5 * dt / steps;
    g(4, 4) = 0.002 * dt / steps;
    VectorXd at = x;
    for (int k = 0; k < steps; ++k) {
        const Eigen::MatrixXd f = motion.jacobian(dt / steps, at);
        p = f * (p + g) * f.transpose();
        at = motion.propagate(dt / steps, at);
    }
    const Eigen::MatrixXd q = motion.noise(dt, x);
    for (int r = 0; r < 5; ++r)
        for (int c = 0; c < 5; ++c) {
            CAPTURE(r, c, q(r, c), p(r, c));
            CHECK(std::fabs(q(r, c) - p(r, c)) < 0.03 * std::sqrt(p(r, r) * p(c, c)));
        }
    const VectorXd later = motion.propagate(dt, x);
    const Eigen::MatrixXd back = motion.jacobian(-dt, later);
    CHECK(relative_difference(motion.noise(-dt, later), back * q * back.transpose()) < 1e-12);
}
