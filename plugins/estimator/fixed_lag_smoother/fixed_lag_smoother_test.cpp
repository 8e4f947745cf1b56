#include <catch2/catch.hpp>
#include <random>

#include <Eigen/Dense>

#include "../../../tests/support/estimator_under_test.hpp"

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double density = 0.3;  // of the velocity's noise, m2/s3

struct Smoother {
    explicit Smoother(const std::string& lag, const std::string& motion_name = "constant_velocity",
                      const Values& with = {{"dimension", "2"}, {"noise", "0.3"}})
        : motion("motion", motion_name, with),
          sensor("sensor", "position", {{"dimension", "2"}}),
          kalman("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "", &sensor}}),
          instance("estimator", "fixed_lag_smoother", {{"lag", lag}},
                   {{"estimator", "", &kalman}, {"motion", "", &motion}}),
          filter(instance) {}
    Instance motion, sensor, kalman, instance;
    EstimatorUnderTest filter;
};

struct Moments {
    VectorXd mean;
    MatrixXd covariance;
};
struct Told {
    std::vector<double> ages;
    std::vector<Moments> moments;
};
Told smoothed(const EstimatorUnderTest& filter, const Batch& record) {
    const auto& extension = *filter.part().extension<plr_estimator_smoothed>(PLR_ESTIMATOR_SMOOTHED);
    const std::int64_t c = filter.c(), most = extension.most;
    Call call;
    Batch known(1, 1), age(most, 1), mean(c, most), covariance(c, c * most);
    auto args = pelorus::arguments<plr_estimator_smoothed_args>();
    args.record = record.in();
    args.known = known.out();
    args.age = age.out();
    args.mean = mean.out();
    args.covariance = covariance.out();
    const plr_call& context = call;
    REQUIRE(extension.smoothed(filter.part().self(), &context, &args) == PLR_OK);
    CHECK(call.scratch_used() == 0);
    Told told;
    const auto count = static_cast<std::int64_t>(known[0](0));
    for (std::int64_t k = 0; k < most; ++k) {
        if (k >= count) {
            CHECK(age[0](k) == 0);
            CHECK(mean[0].col(k).norm() == 0);
            CHECK(covariance[0].middleCols(k * c, c).norm() == 0);
            continue;
        }
        told.ages.push_back(age[0](k));
        told.moments.push_back({mean[0].col(k), covariance[0].middleCols(k * c, c)});
    }
    return told;
}
Moments summary(const EstimatorUnderTest& filter, const Batch& record) {
    Call call;
    Batch mean(filter.c(), 1), covariance(filter.c(), filter.c());
    REQUIRE(filter.summary(call, record, mean, covariance) == PLR_OK);
    return {mean[0], covariance[0]};
}
void predict(const EstimatorUnderTest& filter, Batch& record, double dt) {
    Call call;
    REQUIRE(filter.predict(call, pelorus::const_view(&dt, 1, 1, 1), record, record) == PLR_OK);
}
void update(const EstimatorUnderTest& filter, Batch& record, const VectorXd& z, const MatrixXd& noise) {
    Call call;
    Batch measured(z.size(), 1);
    measured[0] = z;
    EstimatorUnderTest::Told told(z.size(), 1);
    REQUIRE(filter.update(call, 0, record, measured, pelorus::const_view(noise.data(), z.size(), z.size(), 1), record,
                          told) == PLR_OK);
}
Batch started(const EstimatorUnderTest& filter, const VectorXd& mean, const MatrixXd& covariance) {
    Call call;
    const std::int64_t c = filter.c();
    Batch x(c, 1), p(c, c), record(filter.record_size(), 1);
    x[0] = mean;
    p[0] = covariance;
    std::vector<std::int32_t> all;
    for (std::int32_t k = 0; k < c; ++k) all.push_back(k);
    REQUIRE(filter.init(call, all, x, p, record) == PLR_OK);
    return record;
}

/// Constant velocity in the plane: positions, then velocities (Bar-Shalom, Li, Kirubarajan 2001, 6.2.2).
MatrixXd transition(double dt) {
    MatrixXd f = MatrixXd::Identity(4, 4);
    f(0, 2) = f(1, 3) = dt;
    return f;
}
MatrixXd process_noise(double dt) {
    MatrixXd q = MatrixXd::Zero(4, 4);
    for (int axis = 0; axis < 2; ++axis) {
        q(axis, axis) = density * dt * dt * dt / 3;
        q(axis, axis + 2) = q(axis + 2, axis) = density * dt * dt / 2;
        q(axis + 2, axis + 2) = density * dt;
    }
    return q;
}

/// A flight as simulated and measured; the first time has no measurement.
struct Flight {
    std::vector<double> steps;
    std::vector<VectorXd> states, measurements;
};
const MatrixXd prior = Eigen::Vector4d(100, 400, 25, 9).asDiagonal();
const MatrixXd noise = (Eigen::Matrix2d() << 16, 3, 3, 9).finished();
VectorXd draw(std::mt19937_64& random, const MatrixXd& covariance) {
    std::normal_distribution<double> normal;
    VectorXd white(covariance.rows());
    for (Eigen::Index k = 0; k < white.size(); ++k) white(k) = normal(random);
    return covariance.llt().matrixL() * white;
}
Flight flight(std::uint64_t seed, int count) {
    std::mt19937_64 random(seed);
    Flight made;
    VectorXd x = draw(random, prior);
    made.states.push_back(x);
    for (int k = 0; k < count; ++k) {
        const double dt = 0.5 + 0.5 * (k % 3);
        x = transition(dt) * x + draw(random, process_noise(dt));
        made.steps.push_back(dt);
        made.states.push_back(x);
        made.measurements.push_back(x.head(2) + draw(random, noise));
    }
    return made;
}
Batch run(const EstimatorUnderTest& filter, const Flight& of) {
    Batch record = started(filter, VectorXd::Zero(4), prior);
    for (std::size_t k = 0; k < of.steps.size(); ++k) {
        predict(filter, record, of.steps[k]);
        update(filter, record, of.measurements[k], noise);
    }
    return record;
}

/// The whole-interval smoother in plain Eigen: filter forward, then Rauch, Tung and Striebel's equations backward.
std::vector<Moments> rauch_tung_striebel(const Flight& of) {
    std::vector<Moments> filtered{{VectorXd::Zero(4), prior}}, predicted;
    for (std::size_t k = 0; k < of.steps.size(); ++k) {
        const MatrixXd f = transition(of.steps[k]);
        predicted.push_back(
            {f * filtered.back().mean, f * filtered.back().covariance * f.transpose() + process_noise(of.steps[k])});
        const MatrixXd& p = predicted.back().covariance;
        const MatrixXd gain = p.leftCols(2) * (p.topLeftCorner(2, 2) + noise).inverse();
        filtered.push_back({predicted.back().mean + gain * (of.measurements[k] - predicted.back().mean.head(2)),
                            p - gain * p.topRows(2)});
    }
    std::vector<Moments> all = filtered;
    for (std::size_t k = of.steps.size(); k-- > 0;) {
        const MatrixXd gain =
            filtered[k].covariance * transition(of.steps[k]).transpose() * predicted[k].covariance.inverse();
        all[k].mean = filtered[k].mean + gain * (all[k + 1].mean - predicted[k].mean);
        all[k].covariance =
            filtered[k].covariance + gain * (all[k + 1].covariance - predicted[k].covariance) * gain.transpose();
    }
    return all;
}
/// All states at once: the normal equations of the prior, the motion and the measurements.
std::vector<Moments> least_squares(const Flight& of) {
    const auto count = static_cast<Eigen::Index>(of.states.size());
    MatrixXd information = MatrixXd::Zero(4 * count, 4 * count);
    VectorXd right = VectorXd::Zero(4 * count);
    information.topLeftCorner(4, 4) = prior.inverse();
    for (Eigen::Index k = 0; k + 1 < count; ++k) {
        const double dt = of.steps[static_cast<std::size_t>(k)];
        MatrixXd row = MatrixXd::Zero(4, 4 * count);
        row.middleCols(4 * k, 4) = -transition(dt);
        row.middleCols(4 * k + 4, 4).setIdentity();
        information += row.transpose() * process_noise(dt).inverse() * row;
        information.block(4 * k + 4, 4 * k + 4, 2, 2) += noise.inverse();
        right.segment(4 * k + 4, 2) += noise.inverse() * of.measurements[static_cast<std::size_t>(k)];
    }
    const MatrixXd covariance = information.inverse();
    const VectorXd mean = information.ldlt().solve(right);
    std::vector<Moments> all;
    for (Eigen::Index k = 0; k < count; ++k)
        all.push_back({mean.segment(4 * k, 4), covariance.block(4 * k, 4 * k, 4, 4)});
    return all;
}
double difference(const Moments& a, const Moments& b) {
    return (a.mean - b.mean).norm() / b.mean.norm() + (a.covariance - b.covariance).norm() / b.covariance.norm();
}

}  // namespace

TEST_CASE(
    "fixed_lag_smoother: its estimates are those of Rauch, Tung and Striebel, and of least squares over all states",
    "[fixed_lag_smoother]") {
    const Smoother under_test("20");
    const Flight of = flight(3, 12);
    const Told told = smoothed(under_test.filter, run(under_test.filter, of));
    const auto expected = rauch_tung_striebel(of), at_once = least_squares(of);
    REQUIRE(told.moments.size() == 13);  // the start is a time, too
    double age = 0;
    for (std::size_t back = 0; back < 13; ++back) {
        CAPTURE(back);
        CHECK(told.ages[back] == Approx(age));
        CHECK(difference(told.moments[back], expected[12 - back]) < 1e-9);
        CHECK(difference(told.moments[back], at_once[12 - back]) < 1e-8);
        if (back < 12) age += of.steps[11 - back];
    }
}

TEST_CASE("fixed_lag_smoother: it remembers as many steps as its lag, and tells the newest as its filter does",
          "[fixed_lag_smoother]") {
    const Smoother under_test("4");
    const EstimatorUnderTest& filter = under_test.filter;
    const EstimatorUnderTest plain(under_test.kalman);
    const Flight of = flight(4, 15);
    Batch record = started(filter, VectorXd::Zero(4), prior), inner = started(plain, VectorXd::Zero(4), prior);
    Flight so_far = of;
    for (std::size_t k = 0; k < of.steps.size(); ++k) {
        predict(filter, record, of.steps[k]);
        predict(plain, inner, of.steps[k]);
        update(filter, record, of.measurements[k], noise);
        update(plain, inner, of.measurements[k], noise);
        predict(filter, record, 0);
        const Told told = smoothed(filter, record);
        CHECK(told.moments.size() == std::min<std::size_t>(k + 2, 5));
        CHECK(told.moments[0].mean == summary(plain, inner).mean);
        CHECK(told.moments[0].covariance == summary(plain, inner).covariance);
        so_far.steps.resize(k + 1);
        so_far.states.resize(k + 2);
        so_far.measurements.assign(of.measurements.begin(),
                                   of.measurements.begin() + static_cast<std::ptrdiff_t>(k) + 1);
        const auto expected = rauch_tung_striebel(so_far);
        for (std::size_t back = 0; back < told.moments.size(); ++back)
            CHECK(difference(told.moments[back], expected[k + 1 - back]) < 1e-9);
        so_far = of;
    }
}

TEST_CASE("fixed_lag_smoother: smoothed errors are smaller, and as large as it tells", "[fixed_lag_smoother]") {
    const Smoother under_test("6");
    constexpr int runs = 400;
    double nees = 0, filtered_error = 0, smoothed_error = 0;
    for (int run_index = 0; run_index < runs; ++run_index) {
        const Flight of = flight(100 + static_cast<std::uint64_t>(run_index), 25);
        Batch record = started(under_test.filter, VectorXd::Zero(4), prior);
        Moments then{};
        for (std::size_t k = 0; k < of.steps.size(); ++k) {
            predict(under_test.filter, record, of.steps[k]);
            update(under_test.filter, record, of.measurements[k], noise);
            if (k == 18) then = summary(under_test.filter, record);
        }
        const Told told = smoothed(under_test.filter, record);
        const VectorXd error = told.moments[6].mean - of.states[19];
        nees += error.dot(told.moments[6].covariance.ldlt().solve(error)) / runs;
        smoothed_error += error.head(2).squaredNorm() / runs;
        filtered_error += (then.mean - of.states[19]).head(2).squaredNorm() / runs;
    }
    // chi-square of 4 x 400 degrees: deviation sqrt(2 x 4 / 400) = 0.14 of the mean.
    CHECK(nees == Approx(4).margin(5 * 0.142));
    CHECK(smoothed_error < 0.75 * filtered_error);
}

TEST_CASE("fixed_lag_smoother: a motion whose noise remembers is smoothed, too", "[fixed_lag_smoother]") {
    const Smoother under_test("3", "singer", {{"dimension", "2"}, {"form", "truncated"}, {"acceleration", "3"}});
    const EstimatorUnderTest& filter = under_test.filter;
    Batch record = started(filter, VectorXd::Constant(6, 1), 100 * MatrixXd::Identity(6, 6));
    Moments before{};
    for (int k = 0; k < 8; ++k) {
        predict(filter, record, 1);
        update(filter, record, Eigen::Vector2d(10 * k, 0.5 * k * k), noise);
        if (k == 4) before = summary(filter, record);
    }
    const Told told = smoothed(filter, record);
    REQUIRE(told.moments.size() == 4);
    const MatrixXd less = before.covariance - told.moments[3].covariance;
    CHECK(Eigen::SelfAdjointEigenSolver<MatrixXd>(less).eigenvalues().minCoeff() > -1e-9 * before.covariance.norm());
    CHECK(less.trace() > 0);
}

TEST_CASE("fixed_lag_smoother: it refuses to step back, and a motion that is not the filter's",
          "[fixed_lag_smoother]") {
    const Smoother under_test("3");
    Batch record = started(under_test.filter, VectorXd::Zero(4), prior), out = record;
    const double back = -1;
    Call call;
    CHECK(under_test.filter.predict(call, pelorus::const_view(&back, 1, 1, 1), record, out) == PLR_ITEMS_FAILED);
    CHECK(call.status() == PLR_E_UNSUPPORTED);
    const Instance other("motion", "constant_acceleration", {{"dimension", "2"}});
    try {
        const Instance wrong("estimator", "fixed_lag_smoother", {},
                             {{"estimator", "", &under_test.kalman}, {"motion", "", &other}});
        FAIL("made");
    } catch (const Refused& refused) {
        CHECK(refused.where == "motion");
        CHECK_THAT(refused.what(), Catch::Contains("motion.constant_acceleration moves position.x [m]"));
    }
}
