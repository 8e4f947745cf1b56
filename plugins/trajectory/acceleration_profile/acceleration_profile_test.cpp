#include <Eigen/Dense>

#include "../../../tests/support/reference.hpp"
#include "../../../tests/support/trajectory_under_test.hpp"

namespace {

using namespace test_support;
using Eigen::Vector2d;
using Eigen::VectorXd;

struct Flight : TrajectoryUnderTest {
    explicit Flight(const std::string& with) : TrajectoryUnderTest("acceleration_profile", with) {}
};

std::string refusal(const std::string& with) { return refusal_of("trajectory", "acceleration_profile", with); }

/// The target of tests/reference/waveform_traces.json.
const char* const manoeuvring =
    "{start: [432 km, 88 km], velocity: [-2255 m/s, 397 m/s], acceleration: "
    "[[0, 0, -10], [40, 0, -10], [40, -20, -10], [50, 10, 120], [50, 0, -10], [100, 0, -10], [100, -5, -10], "
    "[105, 0, 40], [110, 5, -10], [110, 0, -10]]}";

}  // namespace

TEST_CASE("acceleration profile: the manoeuvring target of the waveform scenario is where the reference has it",
          "[acceleration_profile]") {
    const Flight flight(manoeuvring);
    const auto truth = reference("waveform_traces.json")["truth"];
    REQUIRE(truth.size() == 11);
    for (const auto& [time, told] : truth.items()) {
        INFO("at " << time << " s");
        const VectorXd expected = reordered(matrix(told), {0, 3, 1, 4, 2, 5}, {0});  // told axis by axis
        const VectorXd state = flight.at({std::stod(time)}).states.col(0);
        CHECK((state - expected).cwiseAbs().maxCoeff() < 1e-6);
    }
    CHECK((flight.position(150) - Vector2d(88166.0 + 2.0 / 3, 113466.0 + 2.0 / 3)).norm() < 1e-9);
    CHECK((flight.velocity(150) - Vector2d(-2305, -203)).norm() < 1e-12);
}

TEST_CASE("acceleration profile: at a jump the later row holds, and only the acceleration jumps",
          "[acceleration_profile]") {
    const Flight flight(manoeuvring);
    CHECK(flight.acceleration(40) == VectorXd(Vector2d(-20, -10)));
    CHECK(flight.acceleration(40 - 1e-9) == VectorXd(Vector2d(0, -10)));
    CHECK(flight.acceleration(50) == VectorXd(Vector2d(0, -10)));
    CHECK((flight.acceleration(50 - 1e-9) - Vector2d(10, 120)).norm() < 1e-6);
    for (const double t : {40.0, 50.0, 100.0, 105.0, 110.0}) {
        CHECK((flight.velocity(t) - flight.velocity(t - 1e-9)).norm() < 1e-6);
        CHECK((flight.position(t) - flight.position(t - 1e-9)).norm() < 1e-5);
    }
}

TEST_CASE("acceleration profile: velocity and acceleration are the derivatives of position", "[acceleration_profile]") {
    const Flight flight(
        "{start: [0 m, 5 m, 9 m], velocity: [1 m/s, -2 m/s, 3 m/s], acceleration: [[2 s, 1, 2, 3], [5 s, -4, 0, 1], "
        "{time: 7 s, x: 0, y: 0, z: 2}]}");
    for (const double t : {0.5, 1.9, 2.5, 4.0, 5.5, 6.9, 9.0}) {
        INFO("at " << t << " s");
        const double h = 1e-3;
        CHECK(((flight.position(t + h) - flight.position(t - h)) / (2 * h) - flight.velocity(t)).norm() < 1e-6);
        CHECK(((flight.velocity(t + h) - flight.velocity(t - h)) / (2 * h) - flight.acceleration(t)).norm() < 1e-6);
    }
    CHECK(flight.acceleration(0) == VectorXd(Eigen::Vector3d(1, 2, 3)));   // as at the first row
    CHECK(flight.acceleration(90) == VectorXd(Eigen::Vector3d(0, 0, 2)));  // as at the last one
}

TEST_CASE("acceleration profile: times count from birth", "[acceleration_profile]") {
    const std::string profile = "start: [0 m, 0 m], velocity: [1 m/s, 2 m/s], acceleration: [[0, 1, 0], [4, 0, 3]]";
    const Flight now("{" + profile + "}"), later("{" + profile + ", birth: 10 s, death: 20 s}");
    CHECK(std::isnan(later.position(9.5)(0)));
    CHECK(std::isnan(later.position(20)(0)));
    CHECK(later.at({13}).states == now.at({3}).states);
    CHECK(later.at({13}).birth == 10 * second);
}

TEST_CASE("acceleration profile: without rows it is a straight line", "[acceleration_profile]") {
    const Flight flight("{start: [1 m, 2 m], velocity: [3 m/s, 4 m/s]}");
    CHECK((flight.position(10) - Vector2d(31, 42)).norm() < 1e-12);
    CHECK(flight.acceleration(10).norm() == 0);
}

TEST_CASE("acceleration profile: what makes no path is refused by name", "[acceleration_profile]") {
    const std::string start = "{start: [0 m, 0 m], velocity: [0 m/s, 0 m/s], acceleration: ";
    CHECK(refusal("{start: [0 m, 0 m], velocity: [1 m/s, 2 m/s, 3 m/s]}") == "velocity: has 3 elements, start has 2");
    CHECK(refusal(start + "[[5, 1, 1], [4, 1, 1]]}") ==
          "acceleration[1].time: is before the one above it; rows ascend in time");
    CHECK(refusal(start + "[[5, 1, 1], [5, 2, 2], [5, 1, 1]]}") ==
          "acceleration[2].time: stands a third time; a jump takes two rows");
    CHECK(refusal(start + "[[5, 1, 1, 1]]}") == "acceleration[0].z: is given; start has two axes");
    CHECK(refusal("{start: [0 m, 0 m, 0 m], velocity: [1 m/s, 2 m/s, 3 m/s], acceleration: [[0, 1, 1]]}") ==
          "acceleration[0].z: is missing; start has three axes");
    CHECK_THAT(refusal(start + "[[5, 1]]}"), Catch::Contains("column 'y' is required"));
}
