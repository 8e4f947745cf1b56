#include <Eigen/Dense>

#include "../../../tests/support/trajectory_under_test.hpp"

namespace {

using namespace test_support;
using Eigen::Vector3d;

struct Flight : TrajectoryUnderTest {
    explicit Flight(const std::string& with) : TrajectoryUnderTest("segments", with) {}
};

std::string refusal(const std::string& with) { return refusal_of("trajectory", "segments", with); }

std::string from_rest_of(const std::string& segments) {
    return "{start: [0 m, 0 m, 0 m], velocity: [100 m/s, 0 m/s, 0 m/s], segments: " + segments + "}";
}

constexpr double rounding = 1e-6;  // m, m/s: times are whole nanoseconds

/// The target of the plane-motion test.
const char* const looping =
    "{start: [70 km, 70 km, 20 km], velocity: [100 m/s, 175 m/s, 10 m/s], segments: [{duration: 20 s}, "
    "{duration: 20 s, loop_rate: 0.5 rad/s}, {duration: 10 s, x: 70, y: 90, z: "
    "10}, {duration: 15 s}, {duration: 10 s, along: -20 m/s2}]}";

}  // namespace

TEST_CASE("segments: the looping target of the plane-motion test passes the known points", "[segments]") {
    const Flight flight(looping);
    const std::pair<double, Vector3d> points[] = {{0, {70000, 70000, 20000}},
                                                  {20, {72000, 73500, 20200}},
                                                  {40, {71872.947, 73277.657, 20930.473}},
                                                  {50, {74560.867, 76356.516, 20250.056}},
                                                  {65, {83842.746, 87724.805, 19979.431}},
                                                  {75, {89398.329, 94529.190, 19817.451}}};
    for (const auto& [time, expected] : points) {
        INFO("at " << time << " s");
        CHECK((flight.position(time) - expected).norm() < 1e-3);
    }
}

TEST_CASE("segments: a loop comes back to where it began, flying as it did", "[segments]") {
    const double round = 4 * std::acos(-1.0);  // s, at half a radian a second
    const Flight flight(from_rest_of("[{loop_rate: 0.5 rad/s}]"));
    CHECK(flight.position(round).norm() < rounding);
    CHECK((flight.velocity(round) - Vector3d(100, 0, 0)).norm() < rounding);
    CHECK((flight.position(round / 2) - Vector3d(0, 0, 400)).norm() < rounding);  // on its back, two radii up
    CHECK((flight.acceleration(0) - Vector3d(0, 0, 50)).norm() < 1e-12);
}

TEST_CASE("segments: a turn is a level circle, to the left where its rate is positive", "[segments]") {
    const Flight flight(from_rest_of("[{turn_rate: 0.5 rad/s}]"));
    CHECK((flight.position(2 * std::acos(-1.0)) - Vector3d(0, 400, 0)).norm() < rounding);
    CHECK(flight.velocity(3)(2) == 0);
}

TEST_CASE("segments: velocity and acceleration are the derivatives of position", "[segments]") {
    const Flight flight(
        "{start: [1 m, 2 m, 3 m], velocity: [30 m/s, -20 m/s, 5 m/s], segments: [{duration: 4 s, turn_rate: 0.3 rad/s, "
        "loop_rate: -0.2 rad/s}, {duration: 3 s, along: 4 m/s2, z: -2 m/s2}, {duration: 2 s}]}");
    for (const double t : {0.5, 3.9, 4.5, 6.9, 8.0, 20.0}) {
        INFO("at " << t << " s");
        const double h = 1e-3;
        CHECK(((flight.position(t + h) - flight.position(t - h)) / (2 * h) - flight.velocity(t)).norm() < 1e-5);
        CHECK(((flight.velocity(t + h) - flight.velocity(t - h)) / (2 * h) - flight.acceleration(t)).norm() < 1e-5);
    }
    CHECK(flight.velocity(3).norm() == Approx(flight.velocity(0).norm()));
}

TEST_CASE("segments: what cannot be flown is refused", "[segments]") {
    CHECK(refusal(from_rest_of("[{along: 1 m/s2, turn_rate: 1 rad/s}]")).find("segments[0]") != std::string::npos);
    CHECK(refusal(from_rest_of("[{turn_rate: 1 rad/s}, {duration: 1 s}]")).find("segments[0].duration") !=
          std::string::npos);
    CHECK(refusal("{start: [0 m, 0 m, 0 m], velocity: [0 m/s, 0 m/s, 9 m/s], segments: [{loop_rate: 1 rad/s}]}")
              .find("segments[0].loop_rate") != std::string::npos);
    CHECK(refusal("{start: [0 m, 0 m, 0 m], velocity: [0 m/s, 0 m/s, 0 m/s], segments: [{along: 1 m/s2}]}")
              .find("segments[0].along") != std::string::npos);
}
