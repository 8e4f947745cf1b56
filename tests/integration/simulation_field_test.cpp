// Simulated sensors that are not as their models say: turned and biased, through a whole graph.
#include <cmath>
#include <cstdio>
#include <sstream>

#include <catch2/catch.hpp>
#include <Eigen/Geometry>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;

namespace {

/// A sensor `eye` looks at an object at rest at (3, 4, 1) km; {} is the sensor.
std::string world(const std::string& sensor) {
    return R"(pelorus: 1
graph:
  world:
    use: source.simulation
    with: {scans: 1}
    parts:
      targets: {rock: {use: trajectory.legs, with: {start: [3 km, 4 km, 1 km], speed: 0 m/s}}}
      sensors: {eye: )" +
           sensor + R"(}
  files: {use: sink.csv, in: {scans: world.scans}}
)";
}

/// What it sees: the numbers after time and id.
Eigen::Vector3d seen_by(const std::string& sensor) {
    const TemporaryFolder folder;
    const Ended ended = pelorus_command({"run", folder.write("world.yaml", world(sensor)), "--out", folder / "out"});
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    std::istringstream file(folder.read("out/scans_eye.csv"));
    std::string head, row;
    std::getline(file, head);
    std::getline(file, row);
    Eigen::Vector3d out = Eigen::Vector3d::Zero();
    CAPTURE(head, row);
    REQUIRE(std::sscanf(row.c_str(), "%*[^,],%*[^,],%lf,%lf,%lf", &out(0), &out(1), &out(2)) >= 2);
    return out;
}

std::string spherical(const std::string& attitude, const std::string& more) {
    return "{use: sensor.spherical, with: {noise: [1e-9 m, 1e-12 rad, 1e-12 rad], position: [10 m, 5 m, 3 m], "
           "attitude: " +
           attitude + more + "}}";
}

}  // namespace

TEST_CASE("a mount turned about its own z axis makes azimuths smaller by that, and nothing else") {
    const std::string attitude = "[-1 deg, 2 deg, -3 deg]";
    const Eigen::Vector3d right = seen_by(spherical(attitude, "")),
                          turned = seen_by(spherical(attitude, ", attitude_error: [0 mrad, 0 mrad, 1 mrad]"));
    CHECK(turned(0) == Approx(right(0)).epsilon(1e-12));
    CHECK(right(1) - turned(1) == Approx(1e-3).epsilon(1e-6));
    CHECK(turned(2) == Approx(right(2)).margin(1e-10));
}

TEST_CASE("a mount is turned by roll, pitch and yaw about its own axes, where it stands") {
    const auto about = [](double angle, const Eigen::Vector3d& axis) {
        return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    };
    const Eigen::Matrix3d turned = about(0.7, Eigen::Vector3d::UnitZ()) * about(0.2, Eigen::Vector3d::UnitZ()) *
                                   about(0.1, Eigen::Vector3d::UnitY()) * about(-0.3, Eigen::Vector3d::UnitX());
    const Eigen::Vector3d local = turned.transpose() * Eigen::Vector3d(2990, 3995, 997);
    const Eigen::Vector3d seen =
        seen_by(spherical("[0 rad, 0 rad, 0.7 rad]", ", attitude_error: [-0.3 rad, 0.1 rad, 0.2 rad]"));
    CHECK(seen(0) == Approx(local.norm()).epsilon(1e-12));
    CHECK(seen(1) == Approx(std::atan2(local.y(), local.x())).margin(1e-10));
    CHECK(seen(2) == Approx(std::asin(local.z() / local.norm())).margin(1e-10));
}

TEST_CASE("sensors of any plugin are turned and biased through the inputs that their models declare") {
    const Eigen::Vector3d cosines = seen_by(
        "{use: sensor.direction_cosines, with: {noise: [1e-12, 1e-12], attitude_error: [0 rad, 0 rad, 0.1 rad]}}");
    CHECK(cosines(0) == Approx(5 / std::sqrt(26.0) * std::sin(std::atan2(4.0, 3.0) - 0.1)).margin(1e-9));
    const Eigen::Vector3d biased =
        seen_by("{use: sensor.bearings, with: {noise: [1e-12 rad, 1e-12 rad], bias: [0.01, -0.02]}}");
    CHECK(biased(0) == Approx(std::atan2(4.0, 3.0) + 0.01).margin(1e-10));
    CHECK(biased(1) == Approx(std::atan2(1.0, 5.0) - 0.02).margin(1e-10));
}
