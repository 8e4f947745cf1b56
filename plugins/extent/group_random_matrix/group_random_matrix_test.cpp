#include <catch2/catch.hpp>
#include <cmath>

#include <Eigen/Dense>

#include "../../../tests/support/extent_under_test.hpp"
#include "evolution.hpp"

namespace {

using namespace test_support;
using group_random_matrix::evolved_as_printed;
using group_random_matrix::evolved_by_moments;

const char* const group = "group_random_matrix";
const MatrixXd unit = MatrixXd::Identity(3, 3);

MatrixXd root(const MatrixXd& matrix) { return Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix).operatorSqrt(); }
MatrixXd columns(const std::vector<Eigen::Vector3d>& points) {
    MatrixXd out(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t k = 0; k < points.size(); ++k) out.col(static_cast<Eigen::Index>(k)) = points[k];
    return out;
}

/// Four points of which two along each of the first two axes, with scatter diag(2 a^2, 2 b^2, 0).
MatrixXd cross(double a, double b) { return columns({{a, 0, 0}, {-a, 0, 0}, {0, b, 0}, {0, -b, 0}}); }

}  // namespace

TEST_CASE("group random matrix: a start is the scatter over n and the smallest half axis", "[group_random_matrix]") {
    const ExtentUnderTest extent("{smallest_half_axis: 10 m}", group);
    CHECK(extent.info().start_scans == 1);
    CHECK(extent.info().start_points == 1);
    const auto shape = extent.shape(extent.init({{cross(40, 20), 9 * unit}}));
    CHECK((shape.matrix - diagonal({900, 300, 100})).norm() < 1e-9);
    const auto point = extent.shape(extent.init({{columns({{5, 6, 7}}), 9 * unit}}));
    CHECK((point.matrix - 100 * unit).norm() < 1e-9);
}

TEST_CASE("group random matrix: a prediction keeps the shape, and steps add up", "[group_random_matrix]") {
    const ExtentUnderTest extent("{}", group);
    const MatrixXd start = extent.init({{cross(40, 20), unit}});
    const MatrixXd once = extent.predict(start, 2), twice = extent.predict(extent.predict(start, 0.5), 1.5);
    CHECK((extent.shape(once).matrix - extent.shape(start).matrix).norm() < 1e-9);
    CHECK((once - twice).norm() < 1e-9 * once.norm());
    // l = 3: l' = 3 (5 + 2)/(3 + 5) after a step of 1 s; v = l + 2 d + 2.
    CHECK(extent.predict(start, 1)(0) == Approx(8 + 21.0 / 8));
}

TEST_CASE("group random matrix: certainty falls to two, by either law", "[group_random_matrix]") {
    for (const double degrees : {0.5, 5.0, 50.0}) {
        double moments = 40, printed = 40;
        for (int k = 0; k < 2000; ++k) {
            const double before = moments;
            moments = evolved_by_moments(moments, degrees, 1);
            CHECK(moments == Approx(before * (degrees + 2) / (before + degrees)));
            printed = evolved_as_printed(printed, degrees);
        }
        CHECK(moments == Approx(2));
        CHECK(printed >= 2);
    }
    // By hand: l = 4, delta = 5: 2 + 2 5 5 3 2/(16 9).
    CHECK(evolved_as_printed(4, 5) == Approx(2 + 300.0 / 144));
    CHECK(evolved_by_moments(4, 5, 1) == Approx(28.0 / 9));
}

TEST_CASE("group random matrix: an update adds the members' scatter and the innovation, without the noise",
          "[group_random_matrix]") {
    const ExtentUnderTest extent("{smallest_half_axis: 0 m, lambda: 0.25}", group);
    const MatrixXd record = extent.init({{cloud(3, 12, 5, diagonal({900, 300, 200})), unit}});
    const double certainty = record(0) - 8;
    CHECK(certainty == Approx(3));
    const MatrixXd extent_before = extent.shape(record).matrix, noise = 16 * unit;
    MatrixXd points = cloud(3, 6, 8, diagonal({900, 300, 200}));
    Cloud scan(points, noise);
    scan.weights = {0.3, 0.3, 0.1, 0.1, 0.1, 0.1};
    const VectorXd weights = Eigen::Map<const VectorXd>(scan.weights.data(), 6);
    const VectorXd innovation = Eigen::Vector3d(20, -5, 3);
    const MatrixXd s = 100 * unit;
    const auto updated = extent.update(record, scan, innovation, s);
    // As printed: y = X^1/2 (S + lambda X)^-1/2 e, B = (lambda X + R)^1/2 X^-1/2, Z unweighted about the weighted centre.
    const MatrixXd apart = points.colwise() - VectorXd(points * weights), z = apart * apart.transpose();
    const VectorXd y = root(extent_before) * root(s + 0.25 * extent_before).inverse() * innovation;
    const MatrixXd b = root(0.25 * extent_before + noise) * root(extent_before).inverse();
    const MatrixXd sum = certainty * extent_before + y * y.transpose() + b.inverse() * z * b.transpose().inverse();
    CHECK((extent.shape(updated.records).matrix - sum / (certainty + 6)).norm() < 1e-9 * sum.norm());
    CHECK(updated.records(0) == Approx(record(0) + 6));
}

TEST_CASE("group random matrix: no half axis gets smaller than the smallest", "[group_random_matrix]") {
    const ExtentUnderTest extent("{smallest_half_axis: 10 m}", group);
    MatrixXd record = extent.init({{cross(40, 20), unit}});
    for (int k = 0; k < 200; ++k) {
        record = extent.predict(record, 1);
        record = extent.update(record, Cloud(cross(40, 0.1), unit), VectorXd::Zero(3), unit).records;
    }
    const auto shape = extent.shape(record);
    CHECK(shape.half_axes(1) == Approx(10));
    CHECK(shape.half_axes(2) == Approx(10));
    CHECK(shape.half_axes(0) > 40);
}
