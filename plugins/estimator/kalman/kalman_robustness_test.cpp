// The filter where numbers, items or parts are difficult.
#include "../../../tests/support/estimator_under_test.hpp"
#include "kalman_kernels.hpp"

#include <catch2/catch.hpp>
#include <pelorus/motion.hpp>
#include <pelorus/small_matrix.hpp>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Small = pelorus::small::Bounded<12, 12>;

bool positive_definite(const MatrixXd& p) {
    Small l = p;
    return pelorus::small::cholesky(Small(p), l);
}

struct Filter {
    Filter(const Values& motion_values, const std::string& sensor_name, const Values& sensor_values,
           const std::string& motion_name = "constant_velocity")
        : motion("motion", motion_name, motion_values),
          sensor("sensor", sensor_name, sensor_values),
          instance("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}),
          filter(instance) {}
    Filter(const plr_plugin& motion_plugin, const std::string& sensor_name, const Values& sensor_values)
        : motion(motion_plugin, {}, {}, 0),
          sensor("sensor", sensor_name, sensor_values),
          instance("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}),
          filter(instance) {}

    VectorXd mean(Batch& record, std::int64_t i = 0) const { return record[i].topRows(filter.n()); }
    MatrixXd covariance(Batch& record, std::int64_t i = 0) const {
        return Eigen::Map<MatrixXd>(record[i].data() + filter.n(), filter.n(), filter.n());
    }
    void predict(double dt, Batch& record) const {
        Call call(record.count);
        if (filter.predict(call, pelorus::common_view(&dt, 1, 1, record.count), record, record) != PLR_OK)
            throw std::runtime_error(call.message());
    }
    void update(const VectorXd& z, const MatrixXd& noise, Batch& record) const {
        Call call;
        Batch measured(z.size(), 1);
        measured[0] = z;
        EstimatorUnderTest::Told told(z.size(), 1);
        if (filter.update(call, 0, record, measured, pelorus::const_view(noise.data(), z.size(), z.size(), 1), record,
                          told) != PLR_OK)
            throw std::runtime_error(call.message());
    }

    Instance motion, sensor, instance;
    EstimatorUnderTest filter;
};

}  // namespace

TEST_CASE("a covariance of 1e24 survives prediction and update and is forgotten", "[kalman]") {
    // What is certain of a velocity of which nothing is known: 1e12 m/s.
    const MatrixXd noise = MatrixXd::Identity(3, 3);
    for (const bool spherical : {false, true}) {
        CAPTURE(spherical);
        const Filter f({{"noise", "0.01"}}, spherical ? "spherical" : "position", {});
        const Filter modest({{"noise", "0.01"}}, spherical ? "spherical" : "position", {});
        const MatrixXd r = spherical ? MatrixXd(Eigen::Vector3d(1.0, 1e-8, 1e-8).asDiagonal()) : noise;
        const auto seen = [&](double t) -> Eigen::Vector3d {
            const Eigen::Vector3d p(3000.0 + 10.0 * t, 4000.0 - 20.0 * t, 500.0 + t);
            if (!spherical) return p;
            return {p.norm(), std::atan2(p(1), p(0)), std::asin(p(2) / p.norm())};
        };
        VectorXd start(6);
        start << 3001.0, 3999.0, 500.5, 0.0, 0.0, 0.0;
        for (const double position_variance : {1.0, 1e24}) {
            VectorXd variances(6);
            variances << VectorXd::Constant(3, position_variance), VectorXd::Constant(3, 1e24);
            Batch record = f.filter.record_of(start, variances.asDiagonal());
            Batch plain = modest.filter.record_of(
                start,
                (VectorXd(6) << VectorXd::Constant(3, std::min(position_variance, 1e8)), VectorXd::Constant(3, 1e6))
                    .finished()
                    .asDiagonal());
            for (int k = 1; k <= 40; ++k) {
                f.predict(1.0, record);
                f.update(seen(k), r, record);
                modest.predict(1.0, plain);
                modest.update(seen(k), r, plain);
                CAPTURE(k, position_variance);
                REQUIRE(positive_definite(f.covariance(record)));
                // Never surer than a filter that knew more to begin with, but for rounding.
                for (int c = 0; c < 6; ++c) REQUIRE(f.covariance(record)(c, c) > 0.98 * modest.covariance(plain)(c, c));
            }
            const MatrixXd p = f.covariance(record);
            CHECK((p - modest.covariance(plain)).cwiseAbs().maxCoeff() < 1e-2 * p.cwiseAbs().maxCoeff());
            CHECK((f.mean(record) - modest.mean(plain)).cwiseAbs().maxCoeff() < 0.05);
        }
    }
}

TEST_CASE("measurements of no noise leave a singular covariance, with which the filter goes on", "[kalman]") {
    const Filter f({{"dimension", "1"}, {"noise", "0.5"}}, "position", {{"dimension", "1"}});
    Batch record = f.filter.record_of(VectorXd::Zero(2), MatrixXd::Identity(2, 2));
    const MatrixXd none = MatrixXd::Zero(1, 1);
    for (int k = 1; k <= 20; ++k) {
        f.predict(1.0, record);
        f.update(VectorXd::Constant(1, 3.0 * k), none, record);
        CHECK(f.mean(record)(0) == Approx(3.0 * k));
        CHECK(f.covariance(record)(0, 0) < 1e-14);
        CHECK(f.covariance(record)(1, 1) > 0.0);
    }
    CHECK(f.mean(record)(1) == Approx(3.0).margin(1e-6));
}

TEST_CASE("items that cannot be worked out fail alone, by name", "[kalman]") {
    const Filter f({{"noise", "1"}}, "spherical", {});
    const auto& filter = f.filter;
    const std::int64_t count = 20;
    VectorXd good(6);
    good << 3000, 4000, 500, 10, 20, 30;
    VectorXd above = good;
    above.head(3) << 0, 0, 500;
    Batch records(filter.record_size(), 1, count), z(3, 1, count), out(filter.record_size(), 1, count),
        noises(3, 3, count);
    for (std::int64_t i = 0; i < count; ++i) {
        records[i] = filter.record_of(good, MatrixXd::Identity(6, 6))[0];
        z[i] << 5025.0, 0.93, 0.1;
        noises[i].setIdentity();
    }
    records[2] = filter.record_of(above, MatrixXd::Identity(6, 6))[0];
    records[17](6) = -1.0;  // variance of x
    noises[3](0, 0) = -1.0;
    z[18](1) = std::numeric_limits<double>::quiet_NaN();
    EstimatorUnderTest::Told told(3, count);
    Call call(count);
    CHECK(filter.update(call, 0, records, z, noises.in(), out, told) == PLR_ITEMS_FAILED);
    for (std::int64_t i = 0; i < count; ++i) {
        const bool bad = i == 2 || i == 3 || i == 17 || i == 18;
        CHECK(call.status(static_cast<std::size_t>(i)) == (bad ? PLR_E_NUMERIC : PLR_OK));
        if (!bad) CHECK(out[i] == out[0]);
    }
    CHECK(call.error().item == 2);
    CHECK(call.message() == "the object is on the sensor's vertical axis, where azimuth has no derivative");
    CHECK(call.scratch_used() == 0);

    // A caller who keeps no statuses gets the first failure.
    Call strict(count);
    strict.raw().item_status = nullptr;
    CHECK(filter.update(strict, 0, records, z, noises.in(), out, told) == PLR_E_NUMERIC);
    CHECK(strict.error().item == 2);

    // Single causes.
    const auto message = [&](std::int64_t item) {
        Call one;
        Batch record(filter.record_size(), 1), measured(3, 1);
        record[0] = records[item];
        measured[0] = z[item];
        EstimatorUnderTest::Told told_one(3, 1);
        filter.update(one, 0, record, measured, pelorus::const_view(noises[item].data(), 3, 3, 1), record, told_one);
        return one.message();
    };
    CHECK(message(3) == "the measurement noise covariance is not positive semidefinite");
    CHECK(message(17) == "the state's covariance is not positive semidefinite");
}

TEST_CASE("a step that one item cannot make leaves the others, by structure and by full matrices", "[kalman]") {
    for (const char* const acceleration : {"1", "[1, 2, 3]"}) {
        const Filter f({{"form", "truncated"}, {"acceleration", acceleration}}, "position", {}, "singer");
        const auto& filter = f.filter;
        CHECK((filter.info().flags & PLR_ESTIMATOR_BACKWARD) == 0);
        Batch records(filter.record_size(), 1, 3), out(filter.record_size(), 1, 3);
        for (std::int64_t i = 0; i < 3; ++i)
            records[i] = filter.record_of(VectorXd::Ones(9), MatrixXd::Identity(9, 9))[0];
        const double dt[] = {1.0, -1.0, 1.0};
        Call call(3);
        CHECK(filter.predict(call, pelorus::const_view(dt, 1, 1, 3), records, out) == PLR_ITEMS_FAILED);
        CHECK(call.status(0) == PLR_OK);
        CHECK(call.status(1) == PLR_E_UNSUPPORTED);
        CHECK(call.status(2) == PLR_OK);
        CHECK(out[0] == out[2]);
        CHECK(call.message() == "cannot move backward in time (dt < 0)");
        Call common(3);
        const double back = -1.0;
        CHECK(filter.predict(common, pelorus::common_view(&back, 1, 1, 3), records, out) == PLR_ITEMS_FAILED);
        for (std::size_t i = 0; i < 3; ++i) CHECK(common.status(i) == PLR_E_UNSUPPORTED);
    }
}

TEST_CASE("without noise, backward undoes forward", "[kalman]") {
    for (const char* const noise : {"0", "[0, 0, 1e-30]"}) {
        const Filter f({{"noise", noise}}, "position", {});
        CHECK((f.filter.info().flags & PLR_ESTIMATOR_BACKWARD) != 0);
        const VectorXd x = VectorXd::LinSpaced(6, 1.0, 6.0);
        Batch record = f.filter.record_of(x, 2.0 * MatrixXd::Identity(6, 6));
        f.predict(3.0, record);
        CHECK(f.mean(record)(0) == Approx(13.0));
        f.predict(-3.0, record);
        CHECK((f.mean(record) - x).norm() < 1e-13);
        CHECK((f.covariance(record) - 2.0 * MatrixXd::Identity(6, 6)).norm() < 1e-12);
    }
}

TEST_CASE("a start takes what is known and priors for the rest", "[kalman]") {
    const Filter f({{"prior_velocity", "15 m/s"}}, "position", {});
    const auto& filter = f.filter;
    Call call;
    Batch mean(3, 1), covariance(3, 3), record(filter.record_size(), 1);
    mean[0] << 1.0, 2.0, 40.0;
    covariance[0] << 4.0, 1.0, 0.5, 1.0, 9.0, 0.25, 0.5, 0.25, 16.0;
    REQUIRE(filter.init(call, {0, 1, 4}, mean, covariance, record) == PLR_OK);
    CHECK(f.mean(record) == (VectorXd(6) << 1.0, 2.0, 0.0, 0.0, 40.0, 0.0).finished());
    MatrixXd expected = MatrixXd::Zero(6, 6);
    expected.diagonal() << 4.0, 9.0, 1e12, 225.0, 16.0, 225.0;
    expected(0, 1) = expected(1, 0) = 1.0;
    expected(0, 4) = expected(4, 0) = 0.5;
    expected(1, 4) = expected(4, 1) = 0.25;
    CHECK(f.covariance(record) == expected);

    CHECK(filter.init(call, {1, 0, 4}, mean, covariance, record) == PLR_E_ARGUMENT);
    Call other;
    CHECK(filter.init(other, {0, 1, 6}, mean, covariance, record) == PLR_E_ARGUMENT);
    CHECK(other.message() == "components: are not ascending indices below 6");
    mean[0](1) = std::numeric_limits<double>::infinity();
    Call third;
    CHECK(filter.init(third, {0, 1, 4}, mean, covariance, record) == PLR_ITEMS_FAILED);
    CHECK(third.status() == PLR_E_NUMERIC);
}

TEST_CASE("moments, summary and assign speak of the record", "[kalman]") {
    const Filter f({{"dimension", "2"}}, "position", {{"dimension", "2"}});
    const auto& filter = f.filter;
    const VectorXd x = VectorXd::LinSpaced(4, 1.0, 4.0);
    const MatrixXd p = (MatrixXd(4, 4) << 4, 1, 0, 0, 1, 5, 1, 0, 0, 1, 6, 1, 0, 0, 1, 7).finished();
    Batch record = filter.record_of(x, p), mean(4, 1), covariance(4, 4);
    Call call;
    REQUIRE(filter.moments(call, record, mean, covariance) == PLR_OK);
    CHECK(mean[0] == x);
    CHECK(covariance[0] == p);
    REQUIRE(filter.summary(call, record, mean, covariance) == PLR_OK);
    CHECK(mean[0] == x);
    CHECK(covariance[0] == p);
    mean[0](2) = std::numeric_limits<double>::quiet_NaN();
    CHECK(filter.assign(call, record, mean, covariance, record) == PLR_ITEMS_FAILED);
    CHECK(call.message() == "the mean or covariance to assign is not finite");
}

TEST_CASE("a mixture keeps mean and spread of its hypotheses", "[kalman]") {
    const Filter f({{"dimension", "1"}}, "position", {{"dimension", "1"}});
    const auto& filter = f.filter;
    const auto* const mix = filter.part().extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX);
    REQUIRE(mix != nullptr);
    const VectorXd a = Eigen::Vector2d(1.0, 2.0), b = Eigen::Vector2d(5.0, -2.0);
    const MatrixXd pa = (MatrixXd(2, 2) << 2, 1, 1, 3).finished(), pb = MatrixXd::Identity(2, 2);
    Batch records(filter.record_size(), 2), out(filter.record_size(), 1), weights(2, 1);
    records[0].col(0) = filter.record_of(a, pa)[0];
    records[0].col(1) = filter.record_of(b, pb)[0];
    weights[0] << 0.25, 0.75;
    plr_estimator_mix_args args{sizeof args, 0, weights.in(), records.in(), out.out()};
    Call call;
    REQUIRE(mix->mix(filter.part().self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
    const VectorXd mean = 0.25 * a + 0.75 * b;
    CHECK((f.mean(out) - mean).norm() < 1e-14);
    const MatrixXd spread =
        0.25 * (pa + (a - mean) * (a - mean).transpose()) + 0.75 * (pb + (b - mean) * (b - mean).transpose());
    CHECK((f.covariance(out) - spread).norm() < 1e-13);
    weights[0] << 0.25, 0.5;
    CHECK(mix->mix(filter.part().self(), &static_cast<const plr_call&>(call), &args) == PLR_ITEMS_FAILED);
    CHECK(call.message() == "the weights do not sum to 1");
}

TEST_CASE("a filter refuses sensors that look at what its motion lacks, and says so", "[kalman]") {
    const Instance motion("motion", "constant_velocity", {{"dimension", "2"}}), sensor("sensor", "spherical");
    try {
        const Instance refused("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "radar", &sensor}});
        FAIL("was accepted");
    } catch (const Refused& error) {
        CHECK(error.where == "sensors");
        CHECK(error.code == PLR_E_PART);
        CHECK(std::string(error.what()) ==
              "sensor.spherical looks at position.z [m], which motion.constant_velocity does not have: position.x [m], "
              "position.y [m], velocity.x [m/s], velocity.y [m/s]");
    }
}

TEST_CASE("several sensors are told apart by their number", "[kalman]") {
    const Instance motion("motion", "constant_velocity"), radar("sensor", "spherical"),
        camera("sensor", "position", {{"dimension", "2"}});
    const Instance instance("estimator", "kalman", {},
                            {{"motion", "", &motion}, {"sensors", "radar", &radar}, {"sensors", "camera", &camera}});
    const EstimatorUnderTest filter(instance);
    REQUIRE(filter.info().sensor_count == 2);
    CHECK(std::string(filter.info().sensors[0].name) == "radar");
    CHECK(std::string(filter.info().sensors[1].name) == "camera");
    CHECK(filter.m(0) == 3);
    CHECK(filter.m(1) == 2);
    Batch record = filter.record_of(VectorXd::LinSpaced(6, 1.0, 6.0), MatrixXd::Identity(6, 6)), seen(2, 1),
          projected(2, 2), cross(6, 2);
    Call call;
    REQUIRE(filter.project(call, 1, record, seen, projected, cross) == PLR_OK);
    CHECK(seen[0] == Eigen::Vector2d(1.0, 2.0));
    CHECK(filter.project(call, 2, record, seen, projected, cross) == PLR_E_ARGUMENT);
    CHECK(call.message() == "sensor: is 2, expected 0 to 1");
}

TEST_CASE("too little scratch memory is told, not overrun", "[kalman]") {
    const Filter f({{"noise", "[1, 2, 3]"}}, "spherical", {});
    Batch record = f.filter.record_of(VectorXd::Ones(6), MatrixXd::Identity(6, 6));
    Call call;
    call.raw().scratch->size = 1000;
    const double dt = 1.0;
    CHECK(f.filter.predict(call, pelorus::const_view(&dt, 1, 1, 1), record, record) == PLR_E_SCRATCH);
    CHECK(f.filter.info().scratch_bytes < 200000);
}

TEST_CASE("Kalman filter: a sum and a difference tell both of two states, however little one of them was known",
          "[kalman]") {
    // P = diag(p, 1) and R = I, H = [1 1; 1 -1]: P+ = (P^-1 + H' H)^-1 = diag(1 / (2 + 1/p), 1/3).
    using namespace kalman;
    const double jacobian[] = {1, 1, 1, -1}, noise[] = {1, 0, 0, 1}, innovation[] = {0, 0};
    for (const lanes::InstructionSet set : lanes::instruction_sets) {
        if (!lanes::is_supported(set)) continue;
        for (const double p : {1.0, 1e6, 1e12, 1e18, 1e24}) {
            CAPTURE(static_cast<int>(set), p);
            const double record[] = {0, 0, p, 0, 0, 1};
            double out[6], likelihood = 0.0;
            Outcome outcome = Outcome::done;
            kernels(set).measurement(2, 2, 2).update({2,
                                                      2,
                                                      2,
                                                      1,
                                                      {record, 6},
                                                      {jacobian, 0},
                                                      {noise, 0},
                                                      {innovation, 2},
                                                      {out, 6},
                                                      {&likelihood, 1},
                                                      {nullptr, 0},
                                                      &outcome});
            REQUIRE(outcome == Outcome::done);
            CHECK(out[2] == Approx(1 / (2 + 1 / p)).epsilon(1e-11));
            CHECK(out[5] == Approx(1.0 / 3).epsilon(1e-14));
            CHECK(std::fabs(out[3]) < 1e-11);
        }
    }
}
