#include "../../../tests/support/motion_at.hpp"
#include "../../common/ballistic/air.hpp"

#include <GeographicLib/Geocentric.hpp>

using namespace test_support;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr double pi = 3.14159265358979323846, degree = pi / 180.0;

VectorXd state(const Vector3d& position, const Vector3d& velocity) {
    VectorXd x(6);
    x << position, velocity;
    return x;
}

/// The Earth as the frame ecef has it.
ballistic::Earth turning_earth() {
    ballistic::Earth earth;
    earth.gravity = ballistic::wgs84::gravitational_constant;
    earth.flattening_term =
        1.5 * ballistic::wgs84::j2 * earth.gravity * std::pow(ballistic::wgs84::equatorial_radius, 2);
    earth.rate = ballistic::wgs84::rotation_rate;
    return earth;
}

/// Jacobi's integral of a satellite in a frame that turns: kinetic energy + potentials of gravity with J2 and of turning (m2/s2).
double jacobi_integral(const VectorXd& x) {
    const Vector3d r = x.head<3>(), v = x.tail<3>();
    const double distance = r.norm(), sine = r(2) / distance;
    const double potential =
        -3.986004418e14 / distance *
        (1.0 - 1.08262668e-3 * std::pow(6378137.0 / distance, 2) * (3.0 * sine * sine - 1.0) / 2.0);
    return v.squaredNorm() / 2.0 + potential - std::pow(7.292115e-5, 2) * (r(0) * r(0) + r(1) * r(1)) / 2.0;
}

/// How fast the velocity changes as a step begins (m/s2).
Vector3d acceleration(const MotionAt& motion, const VectorXd& x) {
    const double dt = 1e-2;
    return (motion.propagate(dt, x) - motion.propagate(-dt, x)).segment<3>(3) / (2.0 * dt);
}

struct LocalFrame {
    double latitude, longitude, height;  // deg, deg, m
    std::string origin() const {
        return "[" + std::to_string(latitude) + " deg, " + std::to_string(longitude) + " deg, " +
               std::to_string(height) + "]";
    }
    /// Columns east, north, up in ECEF, and the place, by GeographicLib.
    std::pair<Eigen::Matrix3d, Vector3d> axes() const {
        std::vector<double> rotation(9);
        Vector3d place;
        GeographicLib::Geocentric::WGS84().Forward(latitude, longitude, height, place(0), place(1), place(2), rotation);
        Eigen::Matrix3d columns;
        for (int row = 0; row < 3; ++row)
            for (int col = 0; col < 3; ++col) columns(row, col) = rotation[static_cast<std::size_t>(3 * row + col)];
        return {columns, place};
    }
};

}  // namespace

TEST_CASE("a flight over 760 s agrees with an independent integration in east north up", "[motion][ballistic]") {
    const Instance flight("motion", "ballistic", {{"axes", "enu"}, {"origin", "[37.5 deg, 0, 0]"}});
    const MotionAt motion(flight);
    const VectorXd x = state({0.0, 0.0, 1e5}, {3000.0, 3000.0, 3000.0});
    const Vector3d start = acceleration(motion, x);
    CHECK((start - Vector3d(-0.08076393, -0.26711628, -9.15091277)).norm() < 3e-8);
    const VectorXd end = motion.propagate(760.0, x);
    CHECK((end.head<3>() - Vector3d(2082313.748, 1972529.612, 121524.833)).norm() < 2e-3);
}

TEST_CASE("gravity on the ground is what J2 and the Earth's rotation make of it", "[motion][ballistic]") {
    // Normal gravity (WGS84): 9.7803253 m/s2 at the equator, 9.8321849 at the poles. Terms beyond J2 are of the order of the
    // flattening squared, 1e-5 of it.
    const Instance flight("motion", "ballistic", {{"axes", "ecef"}});
    const MotionAt motion(flight);
    const Vector3d equator = acceleration(motion, state({6378137.0, 0.0, 0.0}, Vector3d::Zero()));
    const Vector3d pole = acceleration(motion, state({0.0, 0.0, 6356752.3142}, Vector3d::Zero()));
    CHECK(equator(0) == Approx(-9.7803253).margin(2e-4));
    CHECK(pole(2) == Approx(-9.8321849).margin(2e-4));
    // At 45 degrees it stands upright on the ellipsoid within a few seconds of arc, which a point's does not.
    const Instance local("motion", "ballistic", {{"axes", "enu"}, {"origin", "[45 deg, 0, 0]"}});
    const Instance point("motion", "ballistic", {{"axes", "enu"}, {"origin", "[45 deg, 0, 0]"}, {"gravity", "point"}});
    const VectorXd rest = VectorXd::Zero(6);
    const Vector3d down = acceleration(MotionAt(local), rest), aside = acceleration(MotionAt(point), rest);
    CHECK(down.head<2>().norm() < 3e-5 * 9.8);
    CHECK(aside.head<2>().norm() > 1e-3 * 9.8);
    CHECK(down(2) == Approx(-9.8061978).margin(2e-4));  // normal gravity at 45 degrees
}

TEST_CASE("a satellite about a point returns after Kepler's period", "[motion][ballistic]") {
    const Instance flight("motion", "ballistic", {{"axes", "ecef"}, {"gravity", "point"}, {"maximum_step", "2"}});
    const double a = 8e6, e = 0.1, w = ballistic::wgs84::rotation_rate;
    const double mu = ballistic::wgs84::gravitational_constant, period = 2.0 * pi * std::sqrt(a * a * a / mu);
    // At perigee over the x axis in inertial axes; in those that turn, the velocity is less by w x r.
    const Vector3d r(a * (1.0 - e), 0.0, 0.0);
    const double speed = std::sqrt(mu / a * (1.0 + e) / (1.0 - e));
    const Vector3d v(0.0, speed * std::cos(1.0), speed * std::sin(1.0));
    const VectorXd end = MotionAt(flight).propagate(period, state(r, v - Vector3d(0.0, w * r(0), 0.0)));
    const double angle = -w * period;  // the frame has turned under it
    CHECK((end.head<3>() - r(0) * Vector3d(std::cos(angle), std::sin(angle), 0.0)).norm() < 0.02);
}

TEST_CASE("Jacobi's integral stays what it was for a day about a flattened Earth", "[motion][ballistic]") {
    const Instance flight("motion", "ballistic", {{"axes", "ecef"}, {"maximum_step", "5"}});
    const MotionAt motion(flight);
    VectorXd x = state({6.9e6, 1e5, -3e5}, {200.0, 4500.0, 5500.0});
    const double before = jacobi_integral(x);
    for (int hour = 0; hour < 24; ++hour) x = motion.propagate(3600.0, x);
    CHECK(std::fabs(jacobi_integral(x) / before - 1.0) < 1e-9);
    CHECK(std::fabs(x(2)) > 1e5);  // it has not stayed in the plane where J2 shows least
}

TEST_CASE("flights in east north up, north east down and from the centre are one flight", "[motion][ballistic]") {
    for (const LocalFrame& frame : {LocalFrame{37.5, 0.0, 0.0}, LocalFrame{-64.0, 120.0, 1500.0},
                                    LocalFrame{90.0, 0.0, 0.0}, LocalFrame{0.0, -75.0, -100.0}}) {
        const auto [axes, place] = frame.axes();
        const Instance enu("motion", "ballistic", {{"axes", "enu"}, {"origin", frame.origin()}, {"drag", "known"}});
        const Instance ned("motion", "ballistic", {{"axes", "ned"}, {"origin", frame.origin()}, {"drag", "known"}});
        const Instance ecef("motion", "ballistic", {{"axes", "ecef"}, {"drag", "known"}});
        Eigen::Matrix3d swap;
        swap << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
        const Vector3d p(12e3, -30e3, 25e3), v(900.0, 1200.0, 700.0);
        const VectorXd a = MotionAt(enu).propagate(90.0, state(p, v));
        const VectorXd b = MotionAt(ned).propagate(90.0, state(swap * p, swap * v));
        const VectorXd c = MotionAt(ecef).propagate(90.0, state(place + axes * p, axes * v));
        CHECK((swap * b.head<3>() - a.head<3>()).norm() < 1e-7);
        CHECK((swap * b.tail<3>() - a.tail<3>()).norm() < 1e-9);
        CHECK((axes.transpose() * (c.head<3>() - place) - a.head<3>()).norm() < 1e-6);
        CHECK((axes.transpose() * c.tail<3>() - a.tail<3>()).norm() < 1e-8);
    }
}

TEST_CASE("a stone thrown on a flat ground flies a parabola", "[motion][ballistic]") {
    const Instance flight("motion", "ballistic", {{"maximum_step", "4"}});
    const VectorXd end = MotionAt(flight).propagate(10.0, state({1.0, 2.0, 3.0}, {40.0, -5.0, 60.0}));
    CHECK((end - state({401.0, -48.0, 3.0 + 600.0 - 9.80665 * 50.0}, {40.0, -5.0, 60.0 - 98.0665})).norm() < 1e-10);
}

TEST_CASE("drag alone slows as its closed form says", "[motion][ballistic]") {
    // Level flight through even air: v = v0 / (1 + k v0 t), k = rho alpha / 2, and the way is ln(1 + k v0 t) / k.
    const double alpha = 2e-3, k = 1.225 * alpha / 2.0, v0 = 300.0, t = 20.0;
    const Instance known(
        "motion", "ballistic",
        {{"gravity", "none"}, {"drag", "known"}, {"drag_parameter", "2e-3"}, {"maximum_step", "0.05"}});
    const VectorXd end = MotionAt(known).propagate(t, state(Vector3d::Zero(), {v0, 0.0, 0.0}));
    CHECK(end(3) == Approx(v0 / (1.0 + k * v0 * t)).epsilon(1e-9));
    CHECK(end(0) == Approx(std::log1p(k * v0 * t) / k).epsilon(1e-9));
    // The estimated parameter is the known one times exp(log_drag).
    const Instance estimated(
        "motion", "ballistic",
        {{"gravity", "none"}, {"drag", "estimated"}, {"drag_parameter", "1e-3"}, {"maximum_step", "0.05"}});
    VectorXd x(7);
    x << state(Vector3d::Zero(), {v0, 0.0, 0.0}), std::log(2.0);
    CHECK((MotionAt(estimated).propagate(t, x).head<6>() - end).norm() < 1e-9);
}

TEST_CASE("a body falls at its terminal speed through even air", "[motion][ballistic]") {
    const double alpha = 0.01, terminal = std::sqrt(2.0 * 9.80665 / (1.225 * alpha));
    const Instance fall(
        "motion", "ballistic",
        {{"drag", "known"}, {"drag_parameter", "0.01"}, {"scale_height", "1000000 km"}, {"maximum_step", "0.1"}});
    CHECK(MotionAt(fall).propagate(60.0, state({0.0, 0.0, 5e3}, Vector3d::Zero()))(5) ==
          Approx(-terminal).epsilon(1e-5));
}

TEST_CASE("the height for the air is near the geodetic one", "[motion][ballistic]") {
    const ballistic::Earth earth = turning_earth();
    const GeographicLib::Geocentric& geocentric = GeographicLib::Geocentric::WGS84();
    for (const double latitude : {-90.0, -45.0, 0.0, 20.0, 45.0, 70.0, 90.0})
        for (const double height : {0.0, 1e4, 1e5}) {
            Vector3d r;
            geocentric.Forward(latitude, 33.0, height, r(0), r(1), r(2));
            CHECK(std::fabs(ballistic::height_of(earth, r).value - height) < 30.0);
        }
}

TEST_CASE("gravity is the gradient of its potential and its own gradient that of a potential", "[motion][ballistic]") {
    ballistic::Earth earth = turning_earth();
    earth.rate = 0.0;
    for (const Vector3d& r : {Vector3d(7e6, 1e6, -2e6), Vector3d(-1e5, 2e5, 6.5e6), Vector3d(4e7, 1e7, 1e7)}) {
        const Eigen::Matrix3d gradient = earth.with_gradient(r, Vector3d::Zero()).by_position;
        CHECK(relative_difference(gradient, gradient.transpose()) < 1e-14);
        CHECK(std::fabs(gradient.trace()) < 1e-14 * gradient.norm());  // Laplace's equation
    }
}

TEST_CASE("the Jacobian of a ballistic flight is its derivative", "[motion][ballistic]") {
    struct Case {
        Values with;
        VectorXd x;
    };
    const VectorXd local = state({-4e3, 9e3, 11e3}, {500.0, -800.0, 300.0});
    VectorXd seven(7);
    seven << local, 0.3;
    VectorXd below = seven;
    below(2) = -2e3;
    const std::vector<Case> cases{
        {{{"axes", "flat"}, {"drag", "known"}, {"drag_parameter", "1e-3"}, {"maximum_step", "0.2"}}, local},
        {{{"axes", "enu"}, {"origin", "[37.5 deg, 0, 0]"}}, local},
        {{{"axes", "enu"}, {"origin", "[52 deg, 0, 0]"}, {"drag", "estimated"}, {"maximum_step", "0.5"}}, seven},
        {{{"axes", "ned"}, {"origin", "[-20 deg, 0, 0]"}, {"drag", "estimated"}, {"maximum_step", "0.5"}}, seven},
        {{{"axes", "flat"}, {"drag", "estimated"}, {"drag_parameter", "3e-4"}, {"maximum_step", "0.1"}}, below},
        {{{"axes", "ecef"}}, state({-3e6, 6e6, 2e6}, {5e3, 2e3, -4e3})},
        {{{"axes", "ecef"}, {"maximum_step", "60"}}, state({1e4, -2e4, 5e3}, {10.0, 20.0, 30.0})}};
    for (const Case& one : cases)
        for (const double dt : {0.01, 1.0, 5.3, -2.0}) {
            const Instance flight("motion", "ballistic", one.with);
            CAPTURE(one.x.transpose(), dt);
            CHECK(MotionAt(flight).jacobian_error(dt, one.x) < 1e-7);
        }
    const Instance orbit("motion", "ballistic", {{"axes", "ecef"}, {"maximum_step", "10"}});
    CHECK(MotionAt(orbit).jacobian_error(2000.0, state({-3e6, 6e6, 2e6}, {5e3, 2e3, -4e3})) < 1e-6);
}

TEST_CASE("a ballistic flight goes back the way it came", "[motion][ballistic]") {
    const Instance flight(
        "motion", "ballistic",
        {{"axes", "enu"}, {"origin", "[37.5 deg, 0, 0]"}, {"drag", "known"}, {"drag_parameter", "1e-4"}});
    const MotionAt motion(flight);
    const VectorXd x = state({0.0, 0.0, 2e4}, {1000.0, 500.0, 100.0});
    const VectorXd back = motion.propagate(-20.0, motion.propagate(20.0, x));
    CHECK((back - x).head<3>().norm() < 1e-4);
    const Eigen::MatrixXd q = motion.noise(-2.0, x);
    CHECK(q(0, 3) == Approx(-0.01 * 2.0));  // -q T^2/2
    CHECK(q(0, 0) == Approx(0.01 * 8.0 / 3.0));
}

TEST_CASE("an acceleration that is constant over the step has the noise of rank one", "[motion][ballistic]") {
    const Instance flight("motion", "ballistic", {{"acceleration", "0.02"}});
    const Eigen::MatrixXd q = MotionAt(flight).noise(2.0, VectorXd::Zero(6));
    CHECK(q(1, 1) == Approx(0.0004 * 4.0));
    CHECK(q(1, 4) == Approx(0.0004 * 4.0));
    CHECK(q(4, 4) == Approx(0.0004 * 4.0));
    CHECK(q(0, 1) == 0.0);
}

TEST_CASE("a ballistic flight refuses what its choices leave without a meaning", "[motion][ballistic]") {
    const std::vector<std::pair<std::string, Values>> wrong{{"origin", {{"axes", "enu"}}},
                                                            {"origin", {{"axes", "ecef"}, {"origin", "[1, 2, 3]"}}},
                                                            {"origin", {{"origin", "[1, 2, 3]"}}},
                                                            {"origin", {{"axes", "ned"}, {"origin", "[91 deg, 0, 0]"}}},
                                                            {"gravity", {{"gravity", "j2"}}},
                                                            {"gravity", {{"axes", "ecef"}, {"gravity", "constant"}}},
                                                            {"drag_parameter", {{"drag_parameter", "0.001"}}},
                                                            {"scale_height", {{"scale_height", "7 km"}}},
                                                            {"air_density", {{"air_density", "1"}}},
                                                            {"drag_noise", {{"drag", "known"}, {"drag_noise", "0.1"}}},
                                                            {"prior_log_drag", {{"prior_log_drag", "0.1"}}},
                                                            {"acceleration", {{"noise", "1"}, {"acceleration", "1"}}}};
    for (const auto& [parameter, with] : wrong) {
        try {
            const Instance flight("motion", "ballistic", with);
            FAIL(parameter << " must be refused");
        } catch (const Refused& refused) {
            CHECK(refused.where == parameter);
        }
    }
    const Instance heavy_air("motion", "ballistic", {{"drag", "known"}, {"drag_parameter", "1"}});
    CHECK_THROWS_WITH(MotionAt(heavy_air).propagate(1.0, state(Vector3d::Zero(), {300.0, 0.0, 0.0})),
                      Catch::Contains("make it shorter"));
    CHECK_THROWS_WITH(MotionAt(heavy_air).propagate(1e6, VectorXd::Zero(6)), Catch::Contains("maximum_step"));
}
