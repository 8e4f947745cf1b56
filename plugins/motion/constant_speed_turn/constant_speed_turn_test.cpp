#include "../../../tests/support/motion_at.hpp"
#include "constant_speed_turn_model.hpp"

#include <Eigen/Geometry>

using namespace test_support;
using constant_speed_turn::Transition;
using constant_speed_turn::white_jerk;
using Eigen::Vector3d;

namespace {

Eigen::VectorXd state(const Vector3d& p, const Vector3d& v, const Vector3d& a) {
    Eigen::VectorXd x(9);
    x << p, v, a;
    return x;
}

/// v' = a, a' = -w^2 v with w of the start, by 20000 Runge-Kutta steps of fourth order.
Eigen::VectorXd integrated(const Eigen::VectorXd& start, double span) {
    const Vector3d v = start.segment<3>(3), a = start.tail<3>();
    const double square = v.cross(a).squaredNorm() / (v.squaredNorm() * v.squaredNorm());
    const auto rate = [square](const Eigen::VectorXd& x) {
        return state(x.segment<3>(3), x.tail<3>(), -square * x.segment<3>(3));
    };
    const int steps = 20000;
    const double h = span / steps;
    Eigen::VectorXd x = start;
    for (int k = 0; k < steps; ++k) {
        const Eigen::VectorXd k1 = rate(x), k2 = rate(x + h / 2 * k1), k3 = rate(x + h / 2 * k2), k4 = rate(x + h * k3);
        x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return x;
}

/// Q for w = 1 rad/s by Simpson's rule on many pieces; the integrand is written without differences.
Eigen::Matrix3d integrated_noise(double span) {
    const int pieces = 4000;
    const double h = span / pieces;
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int k = 0; k <= 2 * pieces; ++k) {
        const double t = h * k / 2.0, half = std::sin(t / 2.0);
        const Vector3d f(2.0 * half * half, std::sin(t), std::cos(t));
        sum += (k == 0 || k == 2 * pieces ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * h / 6.0 * f * f.transpose();
    }
    return sum;
}

}  // namespace

TEST_CASE("a turn at constant speed draws a circle in its plane", "[motion][turn]") {
    const Instance turn("motion", "constant_speed_turn");
    const MotionAt motion(turn);
    // Any orthonormal pair spans the plane.
    const Vector3d along = Vector3d(1.0, -2.0, 2.0) / 3.0, across = Vector3d(2.0, 2.0, 1.0) / 3.0,
                   centre(50.0, 60.0, 70.0);
    const double w = 0.2, speed = 150.0, radius = speed / w;
    for (const double t : {0.5, 3.0, 20.0, 40.0, -7.0}) {
        const Eigen::VectorXd end =
            motion.propagate(t, state(centre - radius * across, speed * along, speed * w * across));
        const Vector3d out = -std::cos(w * t) * across + std::sin(w * t) * along;
        const Vector3d forward = std::cos(w * t) * along + std::sin(w * t) * across;
        CHECK((end - state(centre + radius * out, speed * forward, -speed * w * out)).norm() < 1e-9);
        CHECK(end.segment<3>(3).norm() == Approx(speed).epsilon(1e-13));
        CHECK(std::fabs(end.segment<3>(3).dot(end.tail<3>())) < 1e-10 * speed * speed * w);
    }
}

TEST_CASE("a turn at constant speed agrees with a fine integration when the acceleration is oblique too",
          "[motion][turn]") {
    const Instance turn("motion", "constant_speed_turn");
    const Eigen::VectorXd x = state({1.0, 2.0, 3.0}, {100.0, -30.0, 20.0}, {5.0, 9.0, -14.0});
    for (const double t : {0.1, 4.0, 25.0})
        CHECK(relative_difference(MotionAt(turn).propagate(t, x), integrated(x, t)) < 1e-11);
}

TEST_CASE("a turn at constant speed without acceleration is straight flight", "[motion][turn]") {
    const Instance turn("motion", "constant_speed_turn");
    const Eigen::VectorXd x = state({1.0, 2.0, 3.0}, {100.0, -30.0, 20.0}, Vector3d::Zero());
    CHECK(MotionAt(turn).propagate(4.0, x) == state({401.0, -118.0, 83.0}, {100.0, -30.0, 20.0}, Vector3d::Zero()));
    // With w = 0 the model is that of constant acceleration.
    Eigen::Matrix3d f, q;
    f << 1.0, 2.0, 2.0, 0.0, 1.0, 2.0, 0.0, 0.0, 1.0;
    q << 32.0 / 20.0, 2.0, 8.0 / 6.0, 2.0, 8.0 / 3.0, 2.0, 8.0 / 6.0, 2.0, 2.0;
    CHECK(relative_difference(Transition(0.0, 2.0).value, f) < 1e-15);
    CHECK(relative_difference(white_jerk(0.0, 2.0), q) < 1e-15);
}

TEST_CASE("the Jacobian of a turn at constant speed is its derivative", "[motion][turn]") {
    const Instance turn("motion", "constant_speed_turn");
    const MotionAt motion(turn);
    for (const double scale : {0.0, 1e-6, 1e-3, 0.1, 1.0, 10.0})
        for (const double t : {0.05, 1.0, 8.0, -3.0}) {
            const Vector3d a = scale * Vector3d(5.0, 9.0, -14.0);
            CHECK(motion.jacobian_error(t, state({1.0, 2.0, 3.0}, {100.0, -30.0, 20.0}, a)) < 2e-7);
        }
    const Instance slow("motion", "constant_speed_turn", {{"least_speed", "30"}});
    CHECK(MotionAt(slow).jacobian_error(1.0, state({1.0, 2.0, 3.0}, {1.0, -3.0, 2.0}, {0.1, 0.2, 0.3})) < 1e-7);
    CHECK(MotionAt(slow).jacobian_error(1.0, Eigen::VectorXd::Zero(9)) < 1e-7);
}

TEST_CASE("the noise of a turn is the integral that defines it at any angle", "[motion][turn]") {
    for (const double x : {0.01, 0.3, 0.999, 1.0, 1.001, 2.0, 7.0, 30.0}) {
        const Eigen::Matrix3d q = white_jerk(1.0, x), expected = integrated_noise(x);
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                CHECK(std::fabs(q(r, c) - expected(r, c)) < 2e-12 * std::sqrt(expected(r, r) * expected(c, c)));
    }
    const Instance turn("motion", "constant_speed_turn", {{"noise", "[1, 2, 3]"}});
    const Eigen::VectorXd x = state({1.0, 2.0, 3.0}, {100.0, 0.0, 0.0}, {0.0, 30.0, 40.0});  // w = 0.5
    const Eigen::MatrixXd q = MotionAt(turn).noise(2.0, x);
    CHECK(q(4, 7) == Approx(2.0 * white_jerk(0.25, 2.0)(1, 2)));
    CHECK(q(4, 8) == 0.0);
    const Eigen::VectorXd later = MotionAt(turn).propagate(2.0, x);
    const Eigen::MatrixXd back = MotionAt(turn).jacobian(-2.0, later);
    CHECK(relative_difference(MotionAt(turn).noise(-2.0, later), back * q * back.transpose()) < 1e-12);
}
