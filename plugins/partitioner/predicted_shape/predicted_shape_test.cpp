#include "../../common/partition/partition_rig.hpp"

using namespace partition;
using Eigen::MatrixXd;

TEST_CASE("predicted shape: the gate is an ellipse of the extent and the noise, and strict", "[partition]") {
    // lambda X + R = diag(0.25 x 64 + 9, 0.25 x 0 + 9) = diag(25, 9); chi-square(0.99, 2) = -2 ln 0.01.
    const double gate = -2 * std::log(0.01);
    Scene scene;
    scene.points.resize(2, 4);
    scene.points << 5 * std::sqrt(gate) - 1e-6, 5 * std::sqrt(gate) + 1e-6, 0, 0, 0, 0, 3 * std::sqrt(gate) - 1e-6,
        3 * std::sqrt(gate) + 1e-6;
    scene.covariance = {9 * MatrixXd::Identity(2, 2)};
    scene.mean = MatrixXd::Zero(2, 1);
    scene.mean_covariance = {1e6 * MatrixXd::Identity(2, 2)};  // H P H' is not part of the gate
    scene.extent = {MatrixXd(Eigen::Vector2d(64, 0).asDiagonal())};
    const auto cells = PartitionerUnderTest("predicted_shape", "{threshold: 1 mm}").split(scene);
    REQUIRE(cells.size() == 3);
    CHECK(cells[0].prediction == 0);
    CHECK(cells[0].points == std::vector<std::int64_t>{0, 2});
    CHECK(cells[1].points == std::vector<std::int64_t>{1});
    CHECK(cells[2].points == std::vector<std::int64_t>{3});
}

TEST_CASE("predicted shape: without extents the gate is that of the noise, without noise that of the extent",
          "[partition]") {
    Scene scene;
    scene.points.resize(1, 2);
    scene.points << 2, 4;
    scene.mean = MatrixXd::Zero(1, 1);
    scene.mean_covariance = {MatrixXd::Identity(1, 1)};
    PartitionerUnderTest shape("predicted_shape", "{threshold: 1 mm}");  // gate 6.63 = 2.576^2
    scene.covariance = {MatrixXd::Identity(1, 1)};
    CHECK(shape.split(scene)[0].points == std::vector<std::int64_t>{0});
    scene.covariance.clear();
    scene.extent = {4 * 1.6 * 1.6 * MatrixXd::Identity(1, 1)};
    CHECK(shape.split(scene)[0].points == std::vector<std::int64_t>{0, 1});
}
