#include <catch2/catch.hpp>
#include <cmath>

#include <Eigen/Dense>

#include "../../../tests/support/trajectory_under_test.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const double pi = std::acos(-1.0);

struct Path : TrajectoryUnderTest {
    explicit Path(const std::string& with) : TrajectoryUnderTest("legs", with) {}
};

std::string refusal(const std::string& with) { return refusal_of("trajectory", "legs", with); }

}  // namespace

TEST_CASE("legs: without any it is one endless straight line", "[legs]") {
    const Path path("{start: [0 m, 0 m, 300 m], speed: 20 m/s, heading: 45 deg}");
    CHECK((path.position(99) - Vector3d(99 * 20 / std::sqrt(2), 99 * 20 / std::sqrt(2), 300)).norm() < 1e-9);
    CHECK((path.velocity(1e6) - Vector3d(20 / std::sqrt(2), 20 / std::sqrt(2), 0)).norm() < 1e-12);
    CHECK(path.acceleration(5).norm() == 0);
    CHECK(path.info().extent_dimension == 0);
}

TEST_CASE("legs: the airship of scenario C flies an exact circle, its main axis along the velocity", "[legs]") {
    const Path path(
        "{start: [0 m, 0 m, 300 m], speed: 20 m/s, heading: 45 deg, legs: [{turn_rate: 2 deg/s}], "
        "semi_axes: [12 m, 5 m, 5 m]}");
    const double rate = 2 * pi / 180, radius = 20 / rate;
    const Vector3d centre = Vector3d(0, 0, 300) + radius * Vector3d(-std::sqrt(0.5), std::sqrt(0.5), 0);  // to the left
    for (const double t : {0.0, 1.0, 17.5, 99.0}) {
        CHECK((path.position(t) - centre).norm() == Approx(radius).epsilon(1e-12));
        CHECK(path.velocity(t).norm() == Approx(20).epsilon(1e-13));
        const Vector3d u = path.velocity(t) / 20;
        const MatrixXd extent = Eigen::Map<const Eigen::Matrix3d>(path.at({t}).extents.data());
        CHECK((extent - (25 * Eigen::Matrix3d::Identity() + 119 * u * u.transpose())).norm() < 1e-10);
    }
    CHECK((path.position(180) - path.position(0)).norm() < 1e-9);
    // The truth of tests/reference/airship_giw_trace.json, which was integrated step by step.
    CHECK((path.position(1) - Vector3d(13.892462087, 14.386065625, 300)).norm() < 1e-6);
    CHECK((path.position(5) - Vector3d(64.197206984, 76.507252057, 300)).norm() < 1e-6);
}

TEST_CASE("legs: the path of the radar and electro-optical scenario meets its check points", "[legs]") {
    const Path path(
        "{start: [500 m, 500 m, 600 m], velocity: [3 m/s, 5 m/s, 3 m/s], legs: ["
        "{duration: 150 s}, {duration: 75 s, turn_rate: -0.5 deg/s}, {duration: 65 s, turn_rate: 0.25 deg/s}, "
        "{duration: 160 s}, "
        "{duration: 75 s, turn_rate: -0.5 deg/s}, {duration: 75 s, turn_rate: 0.25 deg/s}]}");
    CHECK((path.position(150) - Vector3d(950, 1250, 1050)).norm() < 1e-9);
    CHECK((path.position(600) - Vector3d(3178.500, 2499.497, 2400)).norm() < 1e-3);
}

TEST_CASE("legs: velocity and acceleration are the derivatives of position, at every kind of leg", "[legs]") {
    const Path path(
        "{start: [10 m, -20 m, 30 m], speed: 40 m/s, heading: 200 deg, climb: 7 m/s, legs: ["
        "{duration: 10 s, acceleration: 1.5 m/s2}, {duration: 20 s, turn_rate: -9 deg/s, acceleration: -1 m/s2}, "
        "{duration: 30 s, turn_rate: 0.01 deg/s, acceleration: 0.3 m/s2}, {duration: 5 s, turn_rate: 40 deg/s}]}");
    for (const double t : {3.0, 9.0, 12.0, 29.0, 31.0, 55.0, 61.0, 64.0, 80.0}) {
        INFO("at " << t << " s");
        const double h = 1e-3;
        const Vector3d slope = (path.position(t + h) - path.position(t - h)) / (2 * h);
        const Vector3d change = (path.velocity(t + h) - path.velocity(t - h)) / (2 * h);
        CHECK((slope - path.velocity(t)).norm() < 1e-4);
        CHECK((change - path.acceleration(t)).norm() < 1e-4);
    }
    for (const double t : {10.0, 30.0, 60.0, 65.0}) {  // no jump between legs
        CHECK((path.position(t + 1e-9) - path.position(t - 1e-9)).norm() < 1e-6);
        CHECK((path.velocity(t + 1e-9) - path.velocity(t - 1e-9)).norm() < 1e-6);
    }
    // Climb included: the path's slope against the horizon stays.
    CHECK(path.velocity(29)(2) / path.velocity(29).norm() == Approx(7 / std::hypot(40.0, 7.0)));
}

TEST_CASE("legs: slow turns and straight lines agree to the last digits", "[legs]") {
    const std::string start =
        "{start: [0 m, 0 m], speed: 300 m/s, heading: 0 deg, legs: [{acceleration: 2 m/s2, turn_rate: ";
    const auto end = [&](const std::string& rate) {
        const Path path(start + rate + "}]}");
        return VectorXd(path.at({100}).states.col(0).head(2));
    };
    const VectorXd straight = end("0 rad/s");
    CHECK(straight(0) == Approx(40000).epsilon(1e-14));
    const double rate = 1e-9;  // 1e-7 rad in all: y = rate (s t^2/2 + a t^3/3) to first order
    const VectorXd bent = end("1e-9 rad/s");
    CHECK(bent(0) == Approx(40000).epsilon(1e-13));
    CHECK(bent(1) == Approx(rate * (300 * 5e3 + 2 * 1e6 / 3)).epsilon(1e-9));
    // Either side of the switch between series and closed form (0.5 rad in 100 s).
    const VectorXd below = end("0.00499999999 rad/s"), above = end("0.00500000001 rad/s");
    CHECK((above - below).norm() < 1e-2);
    CHECK((above - below).norm() > 1e-5);
}

TEST_CASE("legs: an object exists from its birth to its death", "[legs]") {
    const Path path("{start: [5 m, 6 m], speed: 1 m/s, semi_axes: [2 m, 1 m], birth: 10 s, death: 20 s}");
    const auto states = path.at({9.999, 10, 19.999, 20});
    CHECK(std::isnan(states.states(0, 0)));
    CHECK(std::isnan(states.extents(0, 0)));
    CHECK(states.states.col(1).head(2) == VectorXd(Eigen::Vector2d(5, 6)));
    CHECK(states.states(0, 2) == Approx(14.999));
    CHECK(std::isnan(states.states(0, 3)));
    CHECK(states.birth == 10 * second);
    CHECK(states.death == 20 * second);
}

TEST_CASE("legs: what makes no path is refused by name", "[legs]") {
    CHECK(refusal("{start: [0 m, 0 m]}") == "speed: is missing; give speed and heading, or velocity");
    CHECK(refusal("{start: [0 m, 0 m], speed: 1 m/s, velocity: [1 m/s, 0 m/s]}") ==
          "velocity: stands instead of speed, heading and climb; give one or the other");
    CHECK(refusal("{start: [0 m, 0 m], velocity: [1 m/s, 0 m/s, 2 m/s]}") == "velocity: has 3 elements, start has 2");
    CHECK(refusal("{start: [0 m, 0 m], speed: 1 m/s, climb: 1 m/s}") == "climb: needs a third axis; start has two");
    CHECK(refusal("{start: [0 m, 0 m, 0 m], speed: 1 m/s, semi_axes: [1 m, 1 m]}") ==
          "semi_axes: has 2 elements, start has 3");
    CHECK(refusal("{start: [0 m, 0 m], speed: 1 m/s, legs: [{turn_rate: 1 rad/s}, {duration: 1 s}]}") ==
          "legs[0].duration: is missing; only the last leg may go on for ever");
    CHECK(refusal("{start: [0 m, 0 m], speed: 1 m/s, legs: [{duration: 10 s, acceleration: -1 m/s2}]}") ==
          "legs[0].acceleration: ends at speed -9.000000 m/s, expected 0 or more");
    CHECK(refusal("{start: [0 m, 0 m], speed: 1 m/s, birth: 2 s, death: 1 s}") == "death: must be after birth");
    CHECK(
        refusal("{start: [0 m, 0 m], speed: 10 m/s, legs: [{duration: 10 s, acceleration: -1 m/s2}, {duration: 3 s}]}")
            .empty());
}
