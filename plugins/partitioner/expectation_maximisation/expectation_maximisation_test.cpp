#include <cmath>

#include "../../common/partition/partition_rig.hpp"

using namespace partition;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double density(const VectorXd& e, const MatrixXd& s) {
    return std::exp(-0.5 * e.dot(s.inverse() * e)) / std::sqrt((2 * std::acos(-1.0) * s).determinant());
}

/// The textbook's equations, with all responsibilities in a matrix: `passes` of them from given parts. Answers the last
/// responsibilities of the parts that the passes end with; the last row is the background's.
MatrixXd textbook(const MatrixXd& points, MatrixXd mean, std::vector<MatrixXd> covariance, double background,
                  int passes) {
    const Eigen::Index parts = mean.cols(), count = points.cols();
    VectorXd weight = VectorXd::Constant(parts + 1, 1.0 / static_cast<double>(parts + 1));
    MatrixXd r(parts + 1, count);
    for (int pass = 0; pass <= passes; ++pass) {
        for (Eigen::Index i = 0; i < count; ++i) {
            for (Eigen::Index k = 0; k < parts; ++k)
                r(k, i) = weight(k) * density(points.col(i) - mean.col(k), covariance[static_cast<std::size_t>(k)]);
            r(parts, i) = weight(parts) * background;
            r.col(i) /= r.col(i).sum();
        }
        if (pass == passes) break;
        weight = r.rowwise().sum() / static_cast<double>(count);
        for (Eigen::Index k = 0; k < parts; ++k) {
            const double members = r.row(k).sum();
            mean.col(k) = points * r.row(k).transpose() / members;
            const MatrixXd errors = points.colwise() - mean.col(k);
            covariance[static_cast<std::size_t>(k)] = errors * r.row(k).asDiagonal() * errors.transpose() / members;
        }
    }
    return r;
}

Scene three_objects(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-300, 300);
    Scene scene;
    scene.points.resize(2, 100);
    MatrixXd centres(2, 3);
    centres << -60, 60, 0, 0, 0, 150;
    for (Eigen::Index i = 0; i < 100; ++i) {
        if (i < 90)
            scene.points.col(i) << centres(0, i % 3) + 30 * normal(random), centres(1, i % 3) + 15 * normal(random);
        else
            scene.points.col(i) << uniform(random), uniform(random);
    }
    scene.mean = centres;
    scene.mean(0, 0) += 10;
    for (int j = 0; j < 3; ++j) {
        scene.mean_covariance.push_back(MatrixXd::Identity(2, 2));
        scene.extent.push_back(MatrixXd(Eigen::Vector2d(3000, 900).asDiagonal()));
    }
    return scene;
}

}  // namespace

TEST_CASE("expectation maximisation: from predictions the cells are those of the textbook's equations", "[partition]") {
    std::mt19937_64 random(18);
    for (const int passes : {1, 2, 5, 20}) {
        const Scene scene = three_objects(random);
        PartitionerUnderTest em("expectation_maximisation", "{passes: " + std::to_string(passes) + "}");
        const VectorXd box = scene.points.rowwise().maxCoeff() - scene.points.rowwise().minCoeff();
        std::vector<MatrixXd> start;
        for (const MatrixXd& x : scene.extent) start.push_back(0.25 * x);
        const MatrixXd r = textbook(scene.points, scene.mean, start, 1 / box.prod(), passes);
        const CellsSeen cells = em.split(scene);
        for (Eigen::Index k = 0; k < 3; ++k) {
            std::vector<std::int64_t> members;
            double sum = 0;
            for (Eigen::Index i = 0; i < 100; ++i) {
                Eigen::Index most = 0;
                r.col(i).maxCoeff(&most);
                if (most != k) continue;
                members.push_back(i);
                sum += r(k, i);
            }
            const CellSeen& cell = cells[static_cast<std::size_t>(k)];
            CHECK(cell.prediction == k);
            REQUIRE(cell.points == members);
            for (std::size_t l = 0; l < members.size(); ++l)
                CHECK(cell.weights[l] == Approx(r(k, members[l]) / sum).epsilon(1e-6));
        }
        for (std::size_t c = 3; c < cells.size(); ++c) CHECK(cells[c].prediction == -1);
    }
}

TEST_CASE("expectation maximisation: predictions keep apart what nearest centres cut", "[partition]") {
    // Two parallel bars of 400 m x 4 m, 60 m apart; the predictions know where they are and nothing of their shape.
    std::mt19937_64 random(19);
    std::normal_distribution<double> normal;
    Scene scene;
    scene.points.resize(2, 120);
    for (Eigen::Index i = 0; i < 120; ++i)
        scene.points.col(i) << 200 * normal(random), (i % 2 == 0 ? 30 : -30) + 2 * normal(random);
    scene.mean.resize(2, 2);
    scene.mean << 5, -5, 28, -33;
    scene.mean_covariance.assign(2, MatrixXd::Identity(2, 2));
    scene.extent.assign(2, 1e4 * MatrixXd::Identity(2, 2));
    const auto cells = PartitionerUnderTest("expectation_maximisation").split(scene);
    REQUIRE(cells.size() >= 2);
    for (std::size_t c = 0; c < 2; ++c) {
        CHECK(cells[c].prediction == static_cast<std::int64_t>(c));
        CHECK(cells[c].points.size() >= 54);  // the background has some from the far ends
        for (const std::int64_t i : cells[c].points) CHECK(i % 2 == static_cast<std::int64_t>(c));
    }
}

TEST_CASE("expectation maximisation: the criterion finds how many groups there are, whatever their shapes",
          "[partition]") {
    std::mt19937_64 random(21);
    std::normal_distribution<double> normal;
    for (const int count : {1, 2, 4, 6}) {
        INFO(count << " groups");
        Scene scene;
        scene.covariance = {25 * MatrixXd::Identity(2, 2)};
        scene.points.resize(2, 50 * count);
        for (Eigen::Index i = 0; i < scene.points.cols(); ++i) {
            const auto group = static_cast<double>(i % count);  // longer from one to the next
            scene.points.col(i) << 1000 * group + 10 * normal(random), (20 + 30 * group) * normal(random);
        }
        const auto cells = PartitionerUnderTest("expectation_maximisation", "{tries: 20}").split(scene);
        REQUIRE(cells.size() == static_cast<std::size_t>(count));
        for (const CellSeen& cell : cells)
            for (const std::int64_t i : cell.points) CHECK(i % count == cell.points[0]);
    }
}

TEST_CASE("expectation maximisation: what is of no prediction becomes cells of its own", "[partition]") {
    std::mt19937_64 random(20);
    std::normal_distribution<double> normal;
    Scene scene;
    scene.points.resize(3, 60);
    for (Eigen::Index i = 0; i < 60; ++i)
        for (int axis = 0; axis < 3; ++axis)
            scene.points(axis, i) = 20 * normal(random) + (i % 3 == 0 ? 0 : i % 3 == 1 ? 4000 : -4000);
    scene.covariance = {25 * MatrixXd::Identity(3, 3)};
    scene.mean = VectorXd::Zero(3);
    scene.mean_covariance = {MatrixXd::Identity(3, 3)};
    scene.extent = {1600 * MatrixXd::Identity(3, 3)};
    const auto cells = PartitionerUnderTest("expectation_maximisation", "{most_cells: 4}").split(scene);
    REQUIRE(cells.size() == 3);
    CHECK(cells[0].prediction == 0);
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(cells[c].points.size() == 20);
        for (const std::int64_t i : cells[c].points) CHECK(i % 3 == static_cast<std::int64_t>(c));
    }
}

TEST_CASE("expectation maximisation: points in one place, and one point, are one cell", "[partition]") {
    PartitionerUnderTest em("expectation_maximisation");
    for (const Eigen::Index count : {1, 2, 9}) {
        const auto cells = em.split({MatrixXd::Constant(2, count, 7), {}, {}, {}, {}});
        REQUIRE(cells.size() == 1);
        CHECK(cells[0].weights ==
              std::vector<double>(static_cast<std::size_t>(count), 1.0 / static_cast<double>(count)));
    }
}
