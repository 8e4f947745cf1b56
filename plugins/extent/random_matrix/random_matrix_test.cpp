#include <catch2/catch.hpp>
#include <cmath>

#include <Eigen/Dense>

#include "../../../tests/support/airship_parts.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Points of several objects, ragged.
struct Cloud {
    std::vector<std::int64_t> offsets{0};
    std::vector<double> points, noise, weights;
    int d;

    explicit Cloud(int dimension) : d(dimension) {}
    Cloud(const MatrixXd& columns, const MatrixXd& covariance) : d(static_cast<int>(columns.rows())) {
        add(columns, covariance);
    }
    void add(const MatrixXd& columns, const MatrixXd& covariance) {
        points.insert(points.end(), columns.data(), columns.data() + columns.size());
        for (Eigen::Index k = 0; k < columns.cols(); ++k)
            noise.insert(noise.end(), covariance.data(), covariance.data() + covariance.size());
        offsets.push_back(offsets.back() + columns.cols());
    }
    plr_extent_points c() const {
        return {offsets.data(), pelorus::const_view(points.data(), d, 1, offsets.back()),
                pelorus::const_view(noise.data(), d, d, offsets.back()),
                weights.empty() ? pelorus::absent_view() : pelorus::const_view(weights.data(), 1, 1, offsets.back())};
    }
};

/// An extent plugin asked item by item or in a batch. Records are columns.
class ExtentUnderTest {
public:
    explicit ExtentUnderTest(const std::string& with) : instance_(bench_, plugin("extent", "random_matrix"), with) {}
    const plr_extent& table() const { return instance_.table<plr_extent>(); }
    const plr_extent_info& info() const { return *table().info(instance_.self()); }

    MatrixXd init(const std::vector<Cloud>& scans, Call& call, plr_status expected = PLR_OK) const {
        std::vector<plr_extent_points> raw;
        for (const Cloud& scan : scans) raw.push_back(scan.c());
        const auto count = static_cast<Eigen::Index>(scans.front().offsets.size() - 1);
        const double times[] = {0, 1};
        MatrixXd records = MatrixXd::Zero(info().record_size, count);
        auto args = pelorus::arguments<plr_extent_init>();
        args.scans = static_cast<std::uint32_t>(raw.size());
        args.scan = raw.data();
        args.times = pelorus::const_view(times, static_cast<std::int64_t>(raw.size()), 1, 1);
        args.record = out(records);
        REQUIRE(table().init(instance_.self(), &static_cast<const plr_call&>(call), &args) == expected);
        return records;
    }
    MatrixXd init(const std::vector<Cloud>& scans) const {
        Call call(64);
        return init(scans, call);
    }
    MatrixXd predict(MatrixXd records, double dt) const {
        Call call(64);
        auto args = pelorus::arguments<plr_extent_predict>();
        args.dt = pelorus::common_view(&dt, 1, 1, records.cols());
        args.record = in(records);
        args.out = out(records);
        REQUIRE(table().predict(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return records;
    }
    struct Updated {
        MatrixXd records;
        VectorXd log_likelihood;
    };
    /// Innovations as columns, covariances side by side.
    Updated update(const MatrixXd& records, const Cloud& scan, const MatrixXd& innovation,
                   const MatrixXd& covariance) const {
        Call call(64);
        const std::int64_t n = records.cols(), d = scan.d;
        Updated result{records, VectorXd::Zero(n)};
        auto args = pelorus::arguments<plr_extent_update>();
        args.scan = scan.c();
        args.innovation = pelorus::const_view(innovation.data(), d, 1, n);
        args.innovation_covariance = pelorus::const_view(covariance.data(), d, d, n);
        args.record = in(records);
        args.out = out(result.records);
        args.log_likelihood = pelorus::view(result.log_likelihood.data(), 1, 1, n);
        REQUIRE(table().update(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return result;
    }
    MatrixXd effective_noise(const MatrixXd& record, const MatrixXd& noise, double number) const {
        Call call;
        MatrixXd result = noise;
        auto args = pelorus::arguments<plr_extent_effective_noise>();
        args.record = in(record);
        args.noise = pelorus::const_view(noise);
        args.number = pelorus::const_view(&number, 1, 1, 1);
        args.out = pelorus::view(result);
        REQUIRE(table().effective_noise(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return result;
    }
    struct Shape {
        MatrixXd matrix, axes;
        VectorXd half_axes;
    };
    Shape shape(const MatrixXd& record) const {
        Call call;
        const auto d = info().dimension;
        Shape result{MatrixXd(d, d), MatrixXd(d, d), VectorXd(d)};
        auto args = pelorus::arguments<plr_extent_shape>();
        args.record = in(record);
        args.matrix = pelorus::view(result.matrix);
        args.half_axes = pelorus::view(result.half_axes);
        args.axes = pelorus::view(result.axes);
        REQUIRE(table().shape(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return result;
    }
    VectorXd gate(const MatrixXd& record, const VectorXd& centre, const MatrixXd& covariance, const Cloud& scan) const {
        Call call;
        VectorXd result(scan.offsets.back());
        auto args = pelorus::arguments<plr_extent_gate>();
        args.record = in(record);
        args.predicted = pelorus::const_view(centre);
        args.covariance = pelorus::const_view(covariance);
        args.scan = scan.c();
        args.squared_distance = pelorus::view(result.data(), 1, 1, scan.offsets.back());
        REQUIRE(table().gate(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return result;
    }

private:
    static plr_const_view in(const MatrixXd& records) {
        return pelorus::const_view(records.data(), records.rows(), 1, records.cols());
    }
    static plr_view out(MatrixXd& records) { return pelorus::view(records.data(), records.rows(), 1, records.cols()); }
    Bench bench_;
    BenchInstance instance_;
};

/// n points N(centre, X), the same for the same seed.
MatrixXd cloud(int d, int n, std::uint64_t seed, const MatrixXd& extent, double offset = 0) {
    MatrixXd unit(d, n);
    pelorus::host::random_service().normal({{seed, 1}}, 0, unit.size(), unit.data());
    const MatrixXd root = extent.llt().matrixL();
    return (root * unit).array() + offset;
}
MatrixXd scatter(const MatrixXd& points) {
    const MatrixXd centred = points.colwise() - points.rowwise().mean();
    return centred * centred.transpose();
}
MatrixXd diagonal(std::initializer_list<double> values) {
    return VectorXd(Eigen::Map<const VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()))).asDiagonal();
}
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
    CHECK(refusal("{nominal_extent: 50 m2}") == "nominal_extent: is for update: koch only");
    CHECK(refusal("{}", {{"motion", "", motion}}) ==
          "motion: is for update: koch; with this update the estimator beside the extent has it");
    CHECK(refusal("{update: koch}") == "motion: slot motion is empty");
    CHECK(refusal("{update: koch, dimension: 2}", {{"motion", "", motion}}) ==
          "motion: has 3 axes, the extent has 2 (dimension)");
    const auto uneven = part(bench, "motion", "singer", "{acceleration: [1 m/s2, 2 m/s2, 3 m/s2]}");
    CHECK(refusal("{update: koch}", {{"motion", "", uneven}}) ==
          "motion: motion.singer does not offer pelorus.motion.structure.draft/1: update: koch takes a motion F1 (x) "
          "I, Q1 (x) I");
}
