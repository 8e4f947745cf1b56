#include <catch2/catch.hpp>
#include <cmath>

#include <Eigen/Dense>

#include "../../../tests/fixtures/results_of.hpp"
#include "shape_error.hpp"

namespace {

using namespace pelorus::test;
using Eigen::MatrixXd;
constexpr std::int64_t second = 1'000'000'000;
enum Port : std::uint32_t { tracks, truth };

MatrixXd ellipsoid(double a, double b, double c, double degrees) {
    const Eigen::Matrix3d r =
        Eigen::AngleAxisd(degrees * std::acos(-1.0) / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return r * Eigen::Vector3d(a * a, b * b, c * c).asDiagonal() * r.transpose();
}

struct Scored {
    Bench bench;
    StageUnderTest analyzer;
    ResultsOf results{bench, analyzer};
    explicit Scored(const std::string& with = "{from_scan: 0}")
        : analyzer(bench, plugin_of<shape_error::ShapeError>("analyzer.shape_error"), with) {}

    void add(std::int64_t k, const MatrixXd& real, const MatrixXd& estimated, double offset = 0) {
        const auto d = static_cast<int>(real.rows());
        const pelorus::Space space = pelorus::position_space(d);
        const Eigen::VectorXd centre = Eigen::VectorXd::Zero(d), mean = Eigen::VectorXd::Constant(d, offset);
        const MatrixXd covariance = MatrixXd::Identity(d, d);
        pelorus::TruthBuilder objects("", space, d);
        objects.add({5, k * second, centre.data(), real.data(), 5, 0, {}});
        analyzer.receive(truth, objects.message(k * second));
        pelorus::TracksBuilder builder("", space, d);
        builder.add(
            {1, k * second, PLR_TRACK_CONFIRMED, 0, mean.data(), covariance.data(), estimated.data(), {}, 0, {}, {}});
        analyzer.receive(tracks, builder.message(k * second));
    }
    double scalar(const std::string& name) { return results.value(name); }
};

}  // namespace

TEST_CASE("shape error: half axes as published, the angle folded", "[shape_error]") {
    Scored run;
    run.add(0, ellipsoid(12, 5, 5, 45), ellipsoid(11, 4, 7, 45 + 180 - 10));
    CHECK(run.scalar("minor_axis_error") == Approx(0.5));  // (4 + 7)/2 against 5
    CHECK(run.scalar("minor_axis_bias") == Approx(0.5));
    CHECK(run.scalar("major_axis_error") == Approx(1));
    CHECK(run.scalar("major_axis_bias") == Approx(-1));
    CHECK(run.scalar("axis_angle") == Approx(10));
    Scored across;
    across.add(0, ellipsoid(12, 5, 5, 0), ellipsoid(12, 5, 5, 100));
    CHECK(across.scalar("axis_angle") == Approx(80));
}

TEST_CASE("shape error: scalars begin at from_scan and average absolute and signed errors", "[shape_error]") {
    Scored run("{from_scan: 1}");
    run.add(0, ellipsoid(12, 5, 5, 0), ellipsoid(99, 50, 50, 0));
    run.add(1, ellipsoid(12, 5, 5, 0), ellipsoid(13, 4, 4, 0));
    run.add(2, ellipsoid(12, 5, 5, 0), ellipsoid(11, 6, 6, 0));
    CHECK(run.scalar("major_axis_error") == Approx(1));
    CHECK(run.scalar("major_axis_bias") == Approx(0).margin(1e-12));
    CHECK(run.scalar("minor_axis_error") == Approx(1));
    CHECK(run.scalar("scored") == 2);
    CHECK(run.bench.published.back().table().rows.count == 3);
}

TEST_CASE("shape error: the Gaussian-Wasserstein distance of shapes with common axes is that of their roots",
          "[shape_error]") {
    Scored run;
    run.add(0, ellipsoid(12, 5, 4, 30), ellipsoid(10, 6, 4, 30), 2);
    CHECK(run.scalar("gaussian_wasserstein") == Approx(std::sqrt(3 * 4.0 + 4 + 1)));
    Scored same;
    same.add(0, ellipsoid(12, 5, 4, 30), ellipsoid(12, 5, 4, 30));
    CHECK(same.scalar("gaussian_wasserstein") < 1e-6);
    // Turned by 90 degrees: tr(X + X' - 2 (X^1/2 X' X^1/2)^1/2) = 2 (12 - 5)^2 on the two axes.
    Scored turned;
    turned.add(0, ellipsoid(12, 5, 4, 0), ellipsoid(12, 5, 4, 90));
    CHECK(turned.scalar("gaussian_wasserstein") == Approx(std::sqrt(2.0) * 7));
}

TEST_CASE("shape error: in the plane the short axis is the smaller one", "[shape_error]") {
    Scored run;
    run.add(0, ellipsoid(12, 5, 1, 20).topLeftCorner(2, 2), ellipsoid(10, 6, 1, 25).topLeftCorner(2, 2));
    CHECK(run.scalar("minor_axis_error") == Approx(1));
    CHECK(run.scalar("major_axis_error") == Approx(2));
    CHECK(run.scalar("axis_angle") == Approx(5));
}

TEST_CASE("shape error: tracks without extent are refused, flat shapes are not scored", "[shape_error]") {
    Scored run;
    pelorus::TracksBuilder bare("", pelorus::position_space(3));
    const double mean[3] = {}, covariance[9] = {};
    bare.add({1, 0, PLR_TRACK_CONFIRMED, 0, mean, covariance, nullptr, {}, 0, {}, {}});
    CHECK_THROWS_WITH(run.analyzer.receive(tracks, bare.message(0)), "these tracks tell no extent");
    run.add(0, MatrixXd::Zero(3, 3), ellipsoid(12, 5, 5, 0));  // a point
    CHECK(run.scalar("scored") == 0);
    CHECK(std::isnan(run.scalar("major_axis_error")));
}

TEST_CASE("shape error: intersection over union is told on request", "[shape_error]") {
    Scored run("{from_scan: 0, overlap: true}");
    run.add(0, ellipsoid(12, 5, 5, 0), ellipsoid(6, 2.5, 2.5, 0));
    CHECK(run.scalar("intersection_over_union") == Approx(1 / 8.0).epsilon(1e-4));
    CHECK(run.results.cell(0, "intersection_over_union") == Approx(1 / 8.0).epsilon(1e-4));
    Scored flat("{from_scan: 0, overlap: true}");
    flat.add(0, ellipsoid(12, 5, 1, 20).topLeftCorner(2, 2), ellipsoid(6, 5, 1, 20).topLeftCorner(2, 2));
    CHECK(flat.scalar("intersection_over_union") == Approx(0.5));
    Scored unasked;
    unasked.add(0, ellipsoid(12, 5, 5, 0), ellipsoid(6, 2.5, 2.5, 0));
    CHECK_THROWS_WITH(unasked.scalar("intersection_over_union"), "no scalar intersection_over_union");
}
