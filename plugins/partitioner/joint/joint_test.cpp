#include <cmath>

#include "../../common/partition/partition_rig.hpp"

using namespace partition;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd spread(int d, double deviation) { return deviation * deviation * MatrixXd::Identity(d, d); }

MatrixXd some_covariance(int d, double deviation, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    MatrixXd a(d, d);
    for (double& x : a.reshaped()) x = normal(random);
    return deviation * deviation * (a * a.transpose() / d + 0.2 * MatrixXd::Identity(d, d));
}

/// Groups about centres 300 m apart, some predicted, and points anywhere.
Scene groups_scene(int d, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-600, 600);
    Scene scene;
    scene.points.resize(d, 60);
    MatrixXd centres(d, 4);
    for (double& x : centres.reshaped()) x = uniform(random);
    for (Eigen::Index i = 0; i < 60; ++i)
        for (int axis = 0; axis < d; ++axis)
            scene.points(axis, i) = i < 50 ? centres(axis, i % 4) + 40 * normal(random) : uniform(random);
    for (int i = 0; i < 60; ++i) scene.covariance.push_back(some_covariance(d, 15, random));
    scene.mean = centres.leftCols(3);
    for (int j = 0; j < 3; ++j) {
        for (int axis = 0; axis < d; ++axis) scene.mean(axis, j) += 10 * normal(random);
        scene.mean_covariance.push_back(some_covariance(d, 10, random));
        scene.extent.push_back(some_covariance(d, 60, random));
    }
    return scene;
}

double log_density(const VectorXd& e, const MatrixXd& s) {
    return -0.5 * (e.dot(s.inverse() * e) + std::log((2 * std::acos(-1.0) * s).determinant()));
}

/// The equations of the page, with inverses and plain sums.
CellsSeen by_the_equations(const Scene& scene, double gate, double lambda, double d0, bool repartition) {
    const Eigen::Index count = scene.points.cols();
    const auto cell_ids = [&](const std::vector<std::int64_t>& of) {
        const auto first =
            components_by_pairs(static_cast<Eigen::Index>(of.size()), [&](Eigen::Index a, Eigen::Index b) {
                return squared_distance(scene.points, of[static_cast<std::size_t>(a)],
                                        of[static_cast<std::size_t>(b)]) < d0 * d0;
            });
        std::vector<CellSeen> parts;
        for (std::size_t k = 0; k < of.size(); ++k) {
            if (first[k] == static_cast<std::int64_t>(k)) parts.emplace_back();
            std::size_t part = 0;
            for (std::size_t l = 0; l < static_cast<std::size_t>(first[k]); ++l)
                part += first[l] == static_cast<std::int64_t>(l) ? 1 : 0;
            parts[part].points.push_back(of[k]);
        }
        return parts;
    };
    CellsSeen cells;
    std::vector<char> kept(static_cast<std::size_t>(count), 0);
    for (Eigen::Index j = 0; j < scene.mean.cols(); ++j) {
        const auto index = static_cast<std::size_t>(j);
        std::vector<std::int64_t> inside;
        for (Eigen::Index i = 0; i < count; ++i) {
            const VectorXd e = scene.points.col(i) - scene.mean.col(j);
            const MatrixXd s = lambda * scene.extent[index] + scene.covariance[static_cast<std::size_t>(i)];
            if (e.dot(s.inverse() * e) < gate) inside.push_back(i);
        }
        if (inside.empty()) continue;
        if (repartition) {
            double least = 1e300;
            std::vector<std::int64_t> nearest;
            for (const CellSeen& part : cell_ids(inside)) {
                VectorXd mean = VectorXd::Zero(scene.points.rows());
                MatrixXd noise = MatrixXd::Zero(scene.points.rows(), scene.points.rows());
                for (const std::int64_t i : part.points) {
                    mean += scene.points.col(i);
                    noise += scene.covariance[static_cast<std::size_t>(i)];
                }
                const auto n = static_cast<double>(part.points.size());
                const VectorXd e = mean / n - scene.mean.col(j);
                const double distance = e.dot((scene.mean_covariance[index] + noise / n).inverse() * e);
                if (distance < least) {
                    least = distance;
                    nearest = part.points;
                }
            }
            inside = nearest;
        }
        CellSeen cell{j, inside, {}};
        std::vector<double> logs;
        for (const std::int64_t i : inside) {
            const VectorXd e = scene.points.col(i) - scene.mean.col(j);
            logs.push_back(
                log_density(e, scene.mean_covariance[index] + scene.covariance[static_cast<std::size_t>(i)]) -
                std::log(std::max(e.norm(), 1e-3)));
            kept[static_cast<std::size_t>(i)] = 1;
        }
        const double largest = *std::max_element(logs.begin(), logs.end());
        double sum = 0;
        for (const double l : logs) sum += std::exp(l - largest);
        for (const double l : logs) cell.weights.push_back(std::exp(l - largest) / sum);
        cells.push_back(cell);
    }
    std::vector<std::int64_t> rest;
    for (Eigen::Index i = 0; i < count; ++i)
        if (kept[static_cast<std::size_t>(i)] == 0) rest.push_back(i);
    for (CellSeen cell : cell_ids(rest)) {
        cell.weights.assign(cell.points.size(), 1.0 / static_cast<double>(cell.points.size()));
        cells.push_back(cell);
    }
    return cells;
}

void check_same(const CellsSeen& one, const CellsSeen& other) {
    REQUIRE(one.size() == other.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
        CHECK(one[k].prediction == other[k].prediction);
        REQUIRE(one[k].points == other[k].points);
        for (std::size_t l = 0; l < one[k].weights.size(); ++l)
            CHECK(one[k].weights[l] == Approx(other[k].weights[l]).epsilon(1e-9).margin(1e-300));
    }
}

/// Chi-square quantiles from tables: p = 0.99 and 0.9999 for 1, 2 and 3 degrees of freedom.
constexpr double gate_99[] = {6.6348966010212145, 9.2103403719761836, 11.344866730144373};
constexpr double gate_9999[] = {15.136705226623606, 18.420680743952367, 21.107513466160413};

}  // namespace

TEST_CASE("joint partition: cells and weights are those of the equations", "[partition]") {
    std::mt19937_64 random(5);
    PartitionerUnderTest joint("joint", "{threshold: 60}"),
        literal("joint", "{threshold: 60, gate_probability: 0.99, repartition: false}"),
        shape("predicted_shape", "{threshold: 60}");
    for (int d = 1; d <= 3; ++d)
        for (int repeat = 0; repeat < 20; ++repeat) {
            INFO(d << " dimensions, scene " << repeat);
            const Scene scene = groups_scene(d, random);
            check_same(joint.split(scene), by_the_equations(scene, gate_9999[d - 1], 0.25, 60, true));
            const CellsSeen as_printed = by_the_equations(scene, gate_99[d - 1], 0.25, 60, false);
            check_same(literal.split(scene), as_printed);
            check_same(shape.split(scene), as_printed);
        }
}

TEST_CASE("joint partition: a part that has left is released, which the printed gate never does", "[partition]") {
    // Two clumps 400 m apart in one gate of 1 km; the prediction is at the first.
    Scene scene;
    scene.points.resize(3, 6);
    scene.points << 0, 400, 10, 410, -10, 400, 0, 0, 5, 5, 0, 10, 0, 0, 0, 0, 0, 0;
    scene.covariance = {spread(3, 6)};
    scene.mean = VectorXd::Zero(3);
    scene.mean_covariance = {spread(3, 10)};
    scene.extent = {spread(3, 500)};
    const auto split = PartitionerUnderTest("joint", "{threshold: 300}").split(scene);
    REQUIRE(split.size() == 2);
    CHECK(split[0].prediction == 0);
    CHECK(split[0].points == std::vector<std::int64_t>{0, 2, 4});
    CHECK(split[1].prediction == -1);
    CHECK(split[1].points == std::vector<std::int64_t>{1, 3, 5});
    CHECK(PartitionerUnderTest("joint", "{threshold: 300, repartition: false}").split(scene).size() == 1);
}

TEST_CASE("joint partition: a measurement may serve two predictions", "[partition]") {
    Scene scene;
    scene.points = MatrixXd::Zero(2, 1);
    scene.covariance = {spread(2, 1)};
    scene.mean.resize(2, 2);
    scene.mean << 3, -3, 0, 0;
    scene.mean_covariance = {spread(2, 1), spread(2, 1)};
    scene.extent = {spread(2, 10), spread(2, 10)};
    const auto cells = PartitionerUnderTest("joint", "{threshold: 5}").split(scene);
    REQUIRE(cells.size() == 2);
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK(cells[k].prediction == static_cast<std::int64_t>(k));
        CHECK(cells[k].points == std::vector<std::int64_t>{0});
        CHECK(cells[k].weights[0] == 1);
    }
}

TEST_CASE("joint partition: weights of members whose densities no double holds still sum to one", "[partition]") {
    Scene scene;
    scene.points.resize(1, 3);
    scene.points << 100, 101, 250;
    scene.covariance = {spread(1, 1)};
    scene.mean = VectorXd::Zero(1);
    scene.mean_covariance = {spread(1, 1)};
    scene.extent = {spread(1, 1000)};
    const auto cells = PartitionerUnderTest("joint", "{threshold: 200}").split(scene);
    REQUIRE(cells.size() == 1);
    // N(100; 0, 2)/100 against N(101; 0, 2)/101: e^(201/4) 101/100.
    CHECK(cells[0].weights[1] / cells[0].weights[0] == Approx(std::exp(-201.0 / 4) * 100 / 101));
    CHECK(cells[0].weights[2] == 0);
    const auto alike = PartitionerUnderTest("joint", "{threshold: 200, weights: equal}").split(scene);
    CHECK(alike[0].weights == std::vector<double>(3, 1.0 / 3));
}

TEST_CASE("joint partition: without predictions, or far from them, cells are those by distance", "[partition]") {
    std::mt19937_64 random(6);
    Scene scene = groups_scene(3, random);
    PartitionerUnderTest joint("joint", "{threshold: 60}"), distance("distance", "{threshold: 60}");
    scene.mean.array() += 1e6;
    const auto far = joint.split(scene);
    scene.mean.resize(3, 0);
    scene.mean_covariance.clear();
    scene.extent.clear();
    const auto none = joint.split(scene), expected = distance.split(scene);
    check_same(far, expected);
    check_same(none, expected);
}

TEST_CASE("joint partition: a covariance that is none is refused by its number", "[partition]") {
    std::mt19937_64 random(7);
    Scene scene = groups_scene(2, random);
    scene.covariance[7](0, 0) = -1;
    PartitionerUnderTest joint("joint", "{threshold: 60}");
    CHECK(joint.try_split(scene) == PLR_E_NUMERIC);
    CHECK(joint.message() == "covariance of point 7 is not positive semidefinite");
}
