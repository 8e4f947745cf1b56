#include <catch2/catch.hpp>
#include <cmath>

#include <Eigen/Dense>

#include "../../../tests/support/extent_under_test.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double log_normal(const VectorXd& e, const MatrixXd& covariance) {
    return -0.5 * (static_cast<double>(e.size()) * std::log(2 * std::acos(-1.0)) + std::log(covariance.determinant()) +
                   e.dot(covariance.inverse() * e));
}
MatrixXd rotation() {
    return (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(-1.9, Eigen::Vector3d::UnitZ()))
        .toRotationMatrix();
}

const MatrixXd ellipsoid = diagonal({144, 25, 30}), unit_noise = MatrixXd::Identity(3, 3);

}  // namespace

TEST_CASE("random matrix: the published start takes the undivided scatter for the shape", "[random_matrix]") {
    const ExtentUnderTest extent("{}");
    const MatrixXd points = cloud(3, 12, 5, ellipsoid, 100);
    const auto shape = extent.shape(extent.init({{points, unit_noise}}));
    CHECK((shape.matrix - scatter(points)).norm() < 1e-9 * shape.matrix.norm());
    CHECK(extent.info().start_scans == 1);
    CHECK(extent.info().start_points == 4);
}

TEST_CASE("random matrix: half axes descend and their axes rebuild the shape", "[random_matrix]") {
    const auto [d, with] = GENERATE(table<int, std::string>({{2, "{dimension: 2}"}, {3, "{}"}}));
    const ExtentUnderTest extent(with);
    const MatrixXd truth = ellipsoid.topLeftCorner(d, d);
    const auto shape = extent.shape(extent.init({{cloud(d, 30, 3, truth), MatrixXd::Identity(d, d)}}));
    for (int k = 1; k < d; ++k) CHECK(shape.half_axes(k - 1) >= shape.half_axes(k));
    const MatrixXd rebuilt = shape.axes * shape.half_axes.cwiseAbs2().asDiagonal() * shape.axes.transpose();
    CHECK((rebuilt - shape.matrix).norm() < 1e-10 * shape.matrix.norm());
    CHECK((shape.axes.transpose() * shape.axes - MatrixXd::Identity(d, d)).norm() < 1e-12);
}

TEST_CASE("random matrix: the consistent start takes the sensor's noise out, and floors what is left",
          "[random_matrix]") {
    const MatrixXd first = cloud(3, 40, 1, ellipsoid), second_scan = cloud(3, 60, 2, ellipsoid, 20);
    const MatrixXd spread = (scatter(first) + scatter(second_scan)) / 98.0;
    for (const double lambda : {1.0, 0.2}) {
        const ExtentUnderTest extent("{start: consistent, lambda: " + std::to_string(lambda) + "}");
        const MatrixXd noise = 4 * unit_noise;
        const auto shape = extent.shape(extent.init({{first, noise}, {second_scan, noise}}));
        CHECK((shape.matrix - (spread - noise) / lambda).norm() < 1e-9 * spread.norm() / lambda);
    }
    const ExtentUnderTest extent("{start: consistent}");
    CHECK(extent.info().start_scans == 2);
    const MatrixXd loud = 1e4 * unit_noise;  // more noise than spread
    const auto floored = extent.shape(extent.init({{first, loud}, {second_scan, loud}}));
    for (int k = 0; k < 3; ++k) CHECK(std::pow(floored.half_axes(k), 2) == Approx(0.05 * spread.trace() / 3));
}

TEST_CASE("random matrix: too few points fail their own item and leave the others alone", "[random_matrix]") {
    const ExtentUnderTest extent("{}");
    Cloud scan(3);
    const MatrixXd points = cloud(3, 8, 9, ellipsoid);
    scan.add(points, unit_noise);
    scan.add(points.leftCols(3), unit_noise);
    scan.add(points, unit_noise);
    Call call(3);
    const MatrixXd records = extent.init({scan}, call, PLR_ITEMS_FAILED);
    CHECK(call.status(0) == PLR_OK);
    CHECK(call.status(1) == PLR_E_NUMERIC);
    CHECK(call.status(2) == PLR_OK);
    CHECK(call.error().item == 1);
    CHECK(call.message() == "the shape starts with at least 4 points a scan, got 3");
    CHECK(records.col(0) == records.col(2));
}

TEST_CASE("random matrix: points in a plane make no shape", "[random_matrix]") {
    const ExtentUnderTest extent("{}");
    MatrixXd flat = cloud(3, 8, 9, ellipsoid);
    flat.row(2).setConstant(20.1);
    Call call;
    extent.init({{flat, unit_noise}}, call, PLR_ITEMS_FAILED);
    CHECK(call.message() == "the points lie in a plane, on a line or in one place: they make no shape");
}

TEST_CASE("random matrix: forgetting follows the published prediction and never ends the shape", "[random_matrix]") {
    const ExtentUnderTest extent("{decay: 0.1 1/s}");
    MatrixXd record = extent.init({{cloud(3, 12, 5, ellipsoid), unit_noise}});
    const MatrixXd before = extent.shape(record).matrix;
    record = extent.predict(record, 1);
    const double degrees = 9 * std::exp(-0.1);
    CHECK(record(0) == Approx(degrees).epsilon(1e-14));
    CHECK((extent.shape(record).matrix - before * (degrees - 4) / 5 / (degrees - 8)).norm() < 1e-9 * before.norm());
    for (int k = 0; k < 1000; ++k) record = extent.predict(record, 1);
    const MatrixXd after = extent.shape(record).matrix;
    CHECK(record(0) == Approx(8.1));
    CHECK((after - before * 4.1 / 5 / 0.1).norm() < 1e-9 * after.norm());
    CHECK(extent.predict(record, 0) == record);
}

TEST_CASE("random matrix: an item without points is copied", "[random_matrix]") {
    const ExtentUnderTest extent(GENERATE("{}", "{update: feldmann}"));
    Cloud start(3);
    start.add(cloud(3, 8, 1, ellipsoid), unit_noise);
    start.add(cloud(3, 9, 2, ellipsoid), unit_noise);
    const MatrixXd records = extent.predict(extent.init({start}), 1);
    Cloud scan(3);
    scan.add(MatrixXd(3, 0), unit_noise);
    scan.add(cloud(3, 5, 3, ellipsoid), unit_noise);
    MatrixXd covariance(3, 6);
    covariance << 9 * unit_noise, 9 * unit_noise;
    const auto updated = extent.update(records, scan, MatrixXd::Ones(3, 2), covariance);
    CHECK(updated.records.col(0) == records.col(0));
    CHECK(updated.log_likelihood(0) == 0);
    CHECK(updated.records(0, 1) == Approx(records(0, 1) + 5));
}

TEST_CASE("random matrix: one point tells of the shape by its innovation alone", "[random_matrix]") {
    const ExtentUnderTest extent("{}");
    const MatrixXd record = extent.predict(extent.init({{cloud(3, 8, 1, ellipsoid), unit_noise}}), 1);
    const MatrixXd predicted = extent.shape(record).matrix, covariance = 50 * unit_noise;
    const VectorXd innovation = VectorXd::LinSpaced(3, -2, 5);
    const auto updated = extent.update(record, {MatrixXd::Constant(3, 1, 4.0), unit_noise}, innovation, covariance);
    const MatrixXd expected =
        (predicted * (record(0) - 8) + innovation * innovation.transpose() * predicted.trace() / 150) / (record(0) - 7);
    CHECK((extent.shape(updated.records).matrix - expected).norm() < 1e-10 * expected.norm());
    CHECK(updated.log_likelihood(0) == Approx(0).margin(1e-15));
}

TEST_CASE("random matrix: likelihoods of centroid and spread make the density of all points", "[random_matrix]") {
    const ExtentUnderTest extent("{lambda: 0.5}");
    const MatrixXd record = extent.predict(extent.init({{cloud(3, 8, 1, ellipsoid), unit_noise}}), 0.5);
    const MatrixXd points = cloud(3, 6, 4, ellipsoid, 2), noise = diagonal({2, 3, 4});
    const MatrixXd of_point = extent.effective_noise(record, noise, 1);
    CHECK((of_point - (0.5 * extent.shape(record).matrix + noise)).norm() < 1e-10 * of_point.norm());
    CHECK((extent.effective_noise(record, noise, 6) - of_point / 6).norm() < 1e-12 * of_point.norm());
    const VectorXd centre = VectorXd::Constant(3, 1.5);
    double joint = 0;
    for (int k = 0; k < 6; ++k) joint += log_normal(points.col(k) - centre, of_point);
    const VectorXd innovation = points.rowwise().mean() - centre;
    const auto updated = extent.update(record, {points, noise}, innovation, of_point / 6);
    CHECK(log_normal(innovation, of_point / 6) + updated.log_likelihood(0) == Approx(joint).epsilon(1e-12));
}

TEST_CASE("random matrix: the gate weighs shape, noise and prediction", "[random_matrix]") {
    const ExtentUnderTest extent("{lambda: 0.25}");
    const MatrixXd record = extent.init({{cloud(3, 20, 1, ellipsoid), unit_noise}});
    const MatrixXd points = cloud(3, 4, 2, ellipsoid), prediction = diagonal({1, 2, 3}), noise = diagonal({5, 6, 7});
    const VectorXd centre = VectorXd::LinSpaced(3, 1, 3);
    const VectorXd distances = extent.gate(record, centre, prediction, {points, noise});
    const MatrixXd covariance = 0.25 * extent.shape(record).matrix + prediction + noise;
    for (int k = 0; k < 4; ++k) {
        const VectorXd e = points.col(k) - centre;
        CHECK(distances(k) == Approx(e.dot(covariance.inverse() * e)).epsilon(1e-12));
    }
}

TEST_CASE("random matrix: the filter turns with the axes", "[random_matrix]") {
    // `symmetrised`, `trace` and `feldmann` are all made of invariant pieces: rotating everything rotates the shape.
    const ExtentUnderTest extent(
        GENERATE("{}", "{innovation_spread: symmetrised}", "{innovation_spread: feldmann}", "{update: feldmann}"));
    const MatrixXd r = rotation();
    const MatrixXd start = cloud(3, 10, 1, ellipsoid), next = cloud(3, 7, 2, ellipsoid, 3), noise = diagonal({1, 4, 9});
    const MatrixXd covariance = diagonal({20, 10, 5});
    const VectorXd innovation = VectorXd::LinSpaced(3, -3, 4);
    const auto run = [&](const MatrixXd& turn) {
        const MatrixXd turned_noise = turn * noise * turn.transpose();
        const MatrixXd record = extent.predict(extent.init({{turn * start, turned_noise}}), 1);
        return extent
            .shape(extent
                       .update(record, {turn * next, turned_noise}, turn * innovation,
                               turn * covariance * turn.transpose())
                       .records)
            .matrix;
    };
    const MatrixXd plain = run(MatrixXd::Identity(3, 3));
    CHECK((run(r) - r * plain * r.transpose()).norm() < 1e-10 * plain.norm());
}

TEST_CASE("random matrix: equal weights are no weights", "[random_matrix]") {
    const ExtentUnderTest extent("{update: feldmann}");
    const MatrixXd record = extent.predict(extent.init({{cloud(3, 10, 1, ellipsoid), unit_noise}}), 1);
    Cloud scan(cloud(3, 8, 2, ellipsoid), unit_noise), weighted = scan;
    weighted.weights.assign(8, 0.125);
    const VectorXd innovation = VectorXd::Ones(3);
    const MatrixXd covariance = 9 * unit_noise;
    const auto one = extent.update(record, scan, innovation, covariance),
               other = extent.update(record, weighted, innovation, covariance);
    CHECK((one.records - other.records).norm() < 1e-11 * one.records.norm());
}

TEST_CASE("random matrix: a batch is its items", "[random_matrix]") {
    const ExtentUnderTest extent("{update: feldmann}");
    Cloud start(3), scan(3);
    MatrixXd innovation(3, 3), covariance(3, 9);
    for (int i = 0; i < 3; ++i) {
        start.add(cloud(3, 6 + i, 10 + static_cast<std::uint64_t>(i), ellipsoid), unit_noise);
        scan.add(cloud(3, 4 + i, 20 + static_cast<std::uint64_t>(i), ellipsoid), (1.0 + i) * unit_noise);
        innovation.col(i).setConstant(i - 1.0);
        covariance.middleCols(3 * i, 3) = (5.0 + i) * unit_noise;
    }
    const MatrixXd records = extent.predict(extent.init({start}), 1);
    const auto together = extent.update(records, scan, innovation, covariance);
    for (int i = 0; i < 3; ++i) {
        const Cloud one(cloud(3, 4 + i, 20 + static_cast<std::uint64_t>(i), ellipsoid), (1.0 + i) * unit_noise);
        const auto alone = extent.update(records.col(i), one, innovation.col(i), covariance.middleCols(3 * i, 3));
        CHECK(alone.records == together.records.col(i));
        CHECK(alone.log_likelihood(0) == together.log_likelihood(i));
    }
}

TEST_CASE("random matrix: parameters and parts of another update are refused", "[random_matrix]") {
    Bench bench;
    const auto refusal = [&](const std::string& with, std::vector<Part> parts = {}) -> std::string {
        try {
            const BenchInstance instance(bench, plugin("extent", "random_matrix"), with, std::move(parts));
            return "";
        } catch (const std::exception& problem) {
            return problem.what();
        }
    };
    const auto motion = part(bench, "motion", "singer", airship_motion);
    CHECK(refusal("{update: feldmann, innovation_spread: trace}") ==
          "innovation_spread: is for update: published only");
    CHECK(refusal("{nominal_extent: 50 m2}") == "nominal_extent: is for update: koch or lan_li only");
    CHECK(
        refusal("{}", {{"motion", "", motion}}) ==
        "motion: is for update: koch, lan_li or variational; with this update the estimator beside the extent has it");
    CHECK(refusal("{update: koch}") == "motion: slot motion is empty");
    CHECK(refusal("{update: koch, dimension: 2}", {{"motion", "", motion}}) ==
          "motion: has 3 axes, the extent has 2 (dimension)");
    const auto uneven = part(bench, "motion", "singer", "{acceleration: [1 m/s2, 2 m/s2, 3 m/s2]}");
    CHECK(refusal("{update: koch}", {{"motion", "", uneven}}) ==
          "motion: motion.singer does not offer pelorus.motion.structure/1: this update takes a motion F1 (x) "
          "I, Q1 (x) I");
}

TEST_CASE("random matrix: a shape that follows turns as the velocity does, once it is old enough", "[random_matrix]") {
    const std::string with = "{update: feldmann, start: consistent, follow_velocity: true, follow_after: 2 s}";
    const ExtentUnderTest extent(with), still("{update: feldmann, start: consistent}");
    const MatrixXd points = cloud(3, 40, 1, ellipsoid);
    MatrixXd record = extent.init({{points, unit_noise}, {points, unit_noise}}), other = record;
    VectorXd before(6), after(6);
    before << 1, 2, 3, 20, 0, 0;
    after << 21, 2, 3, 20 * std::cos(0.2), 20 * std::sin(0.2), 0;
    record = extent.predict(record, 1, before, after);  // too young
    other = still.predict(other, 1);
    CHECK(record == other);
    record = extent.predict(record, 1, before, after);
    other = still.predict(other, 1);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const MatrixXd expected = turn * still.shape(other).matrix * turn.transpose();
    CHECK((extent.shape(record).matrix - expected).norm() < 1e-9 * expected.norm());
    // Who stands still has no direction.
    before.tail(3).setZero();
    CHECK((extent.shape(extent.predict(record, 1, before, after)).matrix - still.shape(still.predict(record, 1)).matrix)
              .norm() < 1e-9);
}

namespace {

/// Orguner's update point by point, as it is printed: clean points N(y_j, Sigma), then kinematics, then shape; six sweeps.
struct Swept {
    VectorXd mean;
    MatrixXd covariance, scale;
    double degrees;
};
Swept swept(const Swept& prior, const MatrixXd& points, const MatrixXd& noise, double lambda) {
    const Eigen::Index n = points.cols(), c = prior.mean.size();
    MatrixXd h = MatrixXd::Zero(3, c);
    h.leftCols(3).setIdentity();
    Swept now = prior;
    for (int sweep = 0; sweep < 6; ++sweep) {
        const MatrixXd a = (now.degrees - 4) * now.scale.inverse() / lambda;  // E[(lambda X)^-1]
        const MatrixXd sigma = (a + noise.inverse()).inverse();
        MatrixXd clean(3, n);
        for (Eigen::Index j = 0; j < n; ++j)
            clean.col(j) = sigma * (a * h * now.mean + noise.inverse() * points.col(j));
        const MatrixXd information = prior.covariance.inverse();
        now.covariance = (information + static_cast<double>(n) * h.transpose() * a * h).inverse();
        now.mean = now.covariance *
                   (information * prior.mean + static_cast<double>(n) * h.transpose() * a * clean.rowwise().mean());
        now.degrees = prior.degrees + static_cast<double>(n);
        now.scale = prior.scale;
        for (Eigen::Index j = 0; j < n; ++j) {
            const VectorXd e = clean.col(j) - h * now.mean;
            now.scale += (e * e.transpose() + h * now.covariance * h.transpose() + sigma) / lambda;
        }
    }
    return now;
}

}  // namespace

TEST_CASE("random matrix: the variational update is six sweeps of the printed formulas", "[random_matrix]") {
    const double lambda = GENERATE(1.0, 0.2);
    Bench bench;
    const auto motion = part(bench, "motion", "singer", airship_motion);
    const auto radar = part(bench, "sensor", "position", "{noise: 1 m}");
    const BenchInstance instance(bench, plugin("extent", "random_matrix"),
                                 "{update: variational, start: consistent, lambda: " + std::to_string(lambda) + "}",
                                 {{"motion", "", motion}, {"sensors", "radar", radar}});
    const auto& table = instance.table<plr_extent>();
    const auto& joint = *static_cast<const plr_extent_joint*>(table.head.extension(instance.self(), PLR_EXTENT_JOINT));
    const std::int64_t r = table.info(instance.self())->record_size;
    const MatrixXd noise = diagonal({4, 1, 2});
    const Cloud first(cloud(3, 12, 1, ellipsoid), noise), second_scan(cloud(3, 12, 2, ellipsoid, 5), noise);
    const plr_extent_points scans[] = {first.c(), second_scan.c()};
    const double times[] = {0, 1};
    VectorXd mean(9), record(r), out(r);
    mean << 5, 5, 5, 5, 5, 5, 0, 0, 0;
    Call call;
    auto start = pelorus::arguments<plr_joint_init>();
    start.scans = 2;
    start.scan = scans;
    start.times = pelorus::const_view(times, 2, 1, 1);
    start.mean = pelorus::const_view(mean);
    start.record = pelorus::view(record);
    REQUIRE(joint.init(instance.self(), &static_cast<const plr_call&>(call), &start) == PLR_OK);

    const auto read = [](const VectorXd& from) {
        Swept told{from.head(9), Eigen::Map<const MatrixXd>(from.data() + 9, 9, 9),
                   Eigen::Map<const MatrixXd>(from.data() + 91, 3, 3), from(90)};
        return told;
    };
    const Swept prior = read(record);
    CHECK((prior.covariance.topLeftCorner(3, 3) - (lambda * prior.scale / (prior.degrees - 8) + noise) / 12).norm() <
          1e-9);
    const MatrixXd points = cloud(3, 15, 3, ellipsoid, 8);
    const Cloud third(points, noise);
    auto update = pelorus::arguments<plr_joint_update>();
    update.scan = third.c();
    update.record = pelorus::const_view(record);
    update.out = pelorus::view(out);
    REQUIRE(joint.update(instance.self(), &static_cast<const plr_call&>(call), &update) == PLR_OK);
    const Swept expected = swept(prior, points, noise, lambda), made = read(out);
    CHECK((made.mean - expected.mean).norm() < 1e-8 * expected.mean.norm());
    CHECK((made.covariance - expected.covariance).norm() < 1e-8 * expected.covariance.norm());
    CHECK((made.scale - expected.scale).norm() < 1e-8 * expected.scale.norm());
    CHECK(made.degrees == Approx(expected.degrees));
}
