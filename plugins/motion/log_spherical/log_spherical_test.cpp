#include "../../../tests/support/motion_at.hpp"
#include "log_spherical_model.hpp"

using namespace test_support;
using Eigen::VectorXd;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Straight flight of positions and velocities.
VectorXd moved(const VectorXd& c, double dt) {
    VectorXd out = c;
    out.head(c.size() / 2) += dt * c.tail(c.size() / 2);
    return out;
}

VectorXd flight(int dimension) {
    VectorXd c(2 * dimension);
    if (dimension == 2)
        c << 4e3, -3e3, 150.0, 80.0;
    else
        c << -4e3, 3e3, 2e3, 150.0, 80.0, -40.0;
    return c;
}

}  // namespace

TEST_CASE("logarithmic spherical coordinates mean what they are called", "[motion][log_spherical]") {
    const Instance model("motion", "log_spherical");
    const MotionAt motion(model);
    const double dt = 1e-4;
    const VectorXd c = flight(3), s = motion.from_cartesian(c);
    const auto range = [](const VectorXd& at) { return at.head<3>().norm(); };
    const auto azimuth = [](const VectorXd& at) { return std::atan2(at(1), at(0)); };
    const auto elevation = [](const VectorXd& at) { return std::asin(at(2) / at.head<3>().norm()); };
    CHECK(s(0) == Approx(std::log(range(c))));
    CHECK(s(1) == Approx(azimuth(c)));
    CHECK(s(2) == Approx(elevation(c)));
    const VectorXd before = moved(c, -dt), after = moved(c, dt);
    CHECK(s(3) == Approx((range(after) - range(before)) / (2.0 * dt * range(c))).epsilon(1e-6));
    CHECK(s(4) == Approx((azimuth(after) - azimuth(before)) / (2.0 * dt) * std::cos(s(2))).epsilon(1e-6));
    CHECK(s(5) == Approx((elevation(after) - elevation(before)) / (2.0 * dt)).epsilon(1e-6));
}

TEST_CASE("logarithmic polar coordinates are the modified polar ones of Aidala and Hammel", "[motion][log_spherical]") {
    // Theirs: y1 = bearing rate, y2 = range rate over range, y4 = 1 / range. y1 and y2 obey y1' = -2 y1 y2, y2' = y1^2 - y2^2
    // and y4' = -y2 y4 without acceleration.
    const Instance model("motion", "log_spherical", {{"dimension", "2"}});
    const MotionAt motion(model);
    const VectorXd s = motion.from_cartesian(flight(2));
    const double dt = 1e-3;
    const VectorXd rate = (motion.propagate(dt, s) - motion.propagate(-dt, s)) / (2.0 * dt);
    const double y1 = s(3), y2 = s(2);
    CHECK(rate(3) == Approx(-2.0 * y1 * y2).epsilon(1e-6));
    CHECK(rate(2) == Approx(y1 * y1 - y2 * y2).epsilon(1e-6));
    CHECK(rate(1) == Approx(y1).epsilon(1e-6));
    CHECK(-std::exp(-s(0)) * rate(0) == Approx(-y2 * std::exp(-s(0))).epsilon(1e-6));
}

TEST_CASE("a step in logarithmic spherical coordinates is straight flight", "[motion][log_spherical]") {
    for (const int dimension : {2, 3}) {
        const Instance model("motion", "log_spherical", {{"dimension", std::to_string(dimension)}});
        const MotionAt motion(model);
        for (const double dt : {0.01, 1.0, 20.0, 50.0, 400.0, -30.0, -500.0}) {  // past the origin and far away
            const VectorXd c = flight(dimension), expected = moved(c, dt);
            const VectorXd after = motion.to_cartesian(motion.propagate(dt, motion.from_cartesian(c)));
            CHECK((after - expected).head(dimension).norm() < 1e-11 * expected.head(dimension).norm());
            CHECK((after - expected).tail(dimension).norm() < 1e-10);
        }
    }
}

TEST_CASE("Jacobians of logarithmic spherical coordinates are derivatives", "[motion][log_spherical]") {
    for (const int dimension : {2, 3}) {
        const Instance model("motion", "log_spherical", {{"dimension", std::to_string(dimension)}});
        const MotionAt motion(model);
        VectorXd s = motion.from_cartesian(flight(dimension));
        for (const double log_range : {0.0, 8.0, 15.0, 300.0})
            for (const double dt : {0.0, 0.1, 3.0, 20.0, -8.0}) {
                s(0) = log_range;
                CAPTURE(dimension, log_range, dt);
                CHECK(motion.jacobian_error(dt, s) < 1e-6);
            }
        s(0) = 8.0;
        CHECK(motion.conversion_error(s) < 1e-7);
        const VectorXd c = motion.to_cartesian(s);
        CHECK(relative_difference(motion.from_cartesian_jacobian(c) * motion.to_cartesian_jacobian(s),
                                  Eigen::MatrixXd::Identity(2 * dimension, 2 * dimension)) < 1e-12);
    }
}

TEST_CASE("an elevation beyond the zenith is the point on the other side", "[motion][log_spherical]") {
    const Instance model("motion", "log_spherical");
    const MotionAt motion(model);
    VectorXd beyond(6), same(6);
    beyond << 7.0, 0.4, pi - 0.9, 0.01, 0.02, -0.03;
    same << 7.0, 0.4 - pi, 0.9, 0.01, -0.02, 0.03;
    CHECK((motion.to_cartesian(beyond) - motion.to_cartesian(same)).norm() < 1e-10);
    for (const double dt : {0.0, 2.0, 15.0}) {
        CHECK((motion.to_cartesian(motion.propagate(dt, beyond)) - motion.to_cartesian(motion.propagate(dt, same)))
                  .norm() < 1e-9);
        CHECK(motion.jacobian_error(dt, beyond) < 1e-6);
    }
    CHECK((motion.propagate(0.0, beyond) - beyond).norm() < 1e-15);
}

TEST_CASE("noise in logarithmic spherical coordinates is that of white acceleration", "[motion][log_spherical]") {
    for (const int dimension : {2, 3}) {
        const Instance model("motion", "log_spherical", {{"dimension", std::to_string(dimension)}, {"noise", "3"}});
        const MotionAt motion(model);
        const VectorXd s = motion.from_cartesian(flight(dimension));
        for (const double dt : {2.0, -2.0}) {
            const Eigen::MatrixXd to = motion.to_cartesian_jacobian(motion.propagate(dt, s));
            const Eigen::MatrixXd q = to * motion.noise(dt, s) * to.transpose();
            for (int axis = 0; axis < dimension; ++axis) {
                CHECK(q(axis, axis) == Approx(3.0 * 8.0 / 3.0));
                CHECK(q(dimension + axis, axis) == Approx(3.0 * dt));
                CHECK(q(dimension + axis, dimension + axis) == Approx(6.0));
            }
            CHECK(std::fabs(q(0, 1)) < 1e-9);
        }
    }
}

TEST_CASE("places without a direction are refused", "[motion][log_spherical]") {
    const Instance model("motion", "log_spherical");
    const MotionAt motion(model);
    CHECK_THROWS_WITH(motion.from_cartesian(VectorXd::Zero(6)), Catch::Contains("origin"));
    VectorXd above = VectorXd::Zero(6);
    above(2) = 100.0;
    CHECK_THROWS_WITH(motion.from_cartesian(above), Catch::Contains("straight above"));
    VectorXd hit = VectorXd::Zero(6);
    hit(3) = -0.5;
    CHECK_THROWS_WITH(motion.propagate(2.0, hit), Catch::Contains("ends in the origin"));
    CHECK_NOTHROW(motion.propagate(2.001, hit));
}

TEST_CASE("a turn in logarithmic spherical coordinates is the coordinated turn seen from the origin",
          "[motion][log_spherical]") {
    for (const int dimension : {2, 3})
        for (const bool estimated : {false, true}) {
            Values turning{{"dimension", std::to_string(dimension)}, {"noise", "3"}}, cartesian = turning;
            turning["origin"] = dimension == 2 ? "[10, -5]" : "[10, -5, 3]";
            if (estimated) {
                turning["estimate_turn_rate"] = "true";
                turning["turn_rate_noise"] = cartesian["turn_rate_noise"] = "1e-6";
            } else {
                turning["turn_rate"] = cartesian["turn_rate"] = "-0.02";
            }
            const Instance ours("motion", "log_spherical", turning), plain("motion", "coordinated_turn", cartesian);
            const MotionAt motion(ours), reference(plain);
            VectorXd c(2 * dimension + (estimated ? 1 : 0));
            c.head(2 * dimension) = flight(dimension);
            if (estimated) c(2 * dimension) = 0.02;
            const VectorXd s = motion.from_cartesian(c);
            CHECK((motion.to_cartesian(s) - c).norm() < 1e-9);
            for (const double dt : {0.05, 2.0, 40.0, -3.0}) {
                CAPTURE(dimension, estimated, dt);
                const VectorXd expected = reference.propagate(dt, c), after = motion.propagate(dt, s);
                CHECK((motion.to_cartesian(after) - expected).norm() < 1e-11 * expected.norm());
                CHECK(motion.jacobian_error(dt, s) < 1e-6);
                const Eigen::MatrixXd to = motion.to_cartesian_jacobian(after), q = reference.noise(dt, c);
                CHECK(relative_difference(to * motion.noise(dt, s) * to.transpose(), q) < 1e-9);
            }
            CHECK(motion.conversion_error(s) < 1e-7);
        }
}

TEST_CASE("what belongs to an estimated turn rate is refused beside a known one", "[motion][log_spherical]") {
    CHECK_THROWS_WITH(Instance("motion", "log_spherical", {{"turn_rate_noise", "1e-6"}}), Catch::Contains("estimate"));
    CHECK_THROWS_WITH(Instance("motion", "log_spherical", {{"prior_turn_rate", "0.01"}}), Catch::Contains("estimate"));
    CHECK_THROWS_WITH(Instance("motion", "log_spherical", {{"origin", "[1, 2]"}}), Catch::Contains("expected 3"));
}
