// The filter on motions that the Pelorus plugins do not cover yet: a state that is not Cartesian, a record of its own.
#include "../../../tests/support/estimator_under_test.hpp"

#include <catch2/catch.hpp>
#include <Eigen/LU>
#include <pelorus/abi/record.h>
#include <pelorus/motion.hpp>
#include <pelorus/sensor.hpp>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A point that stands still, in the plane: state (ln range, azimuth, drift); drift, which nothing Cartesian tells of, adds to
/// the azimuth. The noise grows with the number of steps made so far, which the record holds, and with the extent.
struct LogPolar : pelorus::Motion<LogPolar, 3, 2> {
    static constexpr bool cartesian = false;
    static constexpr int record_size = 2;
    static constexpr std::uint32_t flags = PLR_MOTION_USES_EXTENT;
    using Record = pelorus::Vector<2>;
    using pelorus::Motion<LogPolar, 3, 2>::Cartesian;

    static void describe(pelorus::Describe<LogPolar>& plugin) { plugin.title("test"); }
    pelorus::Space space() const {
        return pelorus::Space({{"log_range", "1", 0.0, 1.0, false},
                               {"azimuth", "rad", 0.0, 1.0, true},
                               {"drift", "rad/s", 0.0, 0.3, false}});
    }
    pelorus::Space cartesian_space() const { return pelorus::position_space(2); }
    State propagate(const State& x, const pelorus::Step& step) const {
        return {x(0), pelorus::wrap_angle(x(1) + x(2) * step.dt), x(2)};
    }
    Transition jacobian(const State&, const pelorus::Step& step) const {
        Transition f = Transition::Identity();
        f(1, 2) = step.dt;
        return f;
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        if (posterior.predicted(2) != posterior.mean(2))
            throw pelorus::NumericError("predicted does not belong to mean");
        return (step.record[0] + posterior.covariance(0, 0)) * posterior.extent[0] * step.dt * Transition::Identity();
    }
    Record init_record(const State& x, const Transition&) const { return {0.0, x(0)}; }
    Record advance_record(const State&, const Transition& p, const pelorus::Step& step) const {
        return {step.record[0] + 1.0, p(1, 1)};
    }
    Cartesian to_cartesian(const State& x) const { return std::exp(x(0)) * Cartesian(std::cos(x(1)), std::sin(x(1))); }
    pelorus::Matrix<2, 3> to_cartesian_jacobian(const State& x) const {
        const Cartesian p = to_cartesian(x);
        pelorus::Matrix<2, 3> j;
        j << p(0), -p(1), 0.0, p(1), p(0), 0.0;
        return j;
    }
    State from_cartesian(const Cartesian& p) const { return {std::log(p.norm()), std::atan2(p(1), p(0)), 0.0}; }
    pelorus::Matrix<3, 2> from_cartesian_jacobian(const Cartesian& p) const {
        const double square = p.squaredNorm();
        pelorus::Matrix<3, 2> j;
        j << p(0) / square, p(1) / square, -p(1) / square, p(0) / square, 0.0, 0.0;
        return j;
    }
};

const plr_plugin& log_polar() {
    return *pelorus::detail::plugin<LogPolar>("motion.test_log_polar", "motion.test_log_polar");
}

struct Filter {
    Instance motion{log_polar(), {}, {}, 0};
    Instance sensor{"sensor", "position", {{"dimension", "2"}}};
    Instance instance{"estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}};
    EstimatorUnderTest filter{instance};

    /// A track at (3, 4), whose position has the covariance [0.04 0.01; 0.01 0.09].
    Batch start() const {
        Call call;
        Batch mean(2, 1), covariance(2, 2), record(filter.record_size(), 1);
        mean[0] << 3.0, 4.0;
        covariance[0] << 0.04, 0.01, 0.01, 0.09;
        if (filter.init(call, {0, 1}, mean, covariance, record) != PLR_OK) throw std::runtime_error(call.message());
        return record;
    }
};

}  // namespace

TEST_CASE("a filter whose state is not Cartesian starts from, looks at and tells of Cartesian components", "[kalman]") {
    const Filter f;
    const auto& filter = f.filter;
    CHECK(filter.n() == 3);
    CHECK(filter.c() == 2);
    CHECK(filter.record_size() == 3 + 9 + 2);
    Batch record = f.start(), mean(2, 1), covariance(2, 2);
    CHECK(record[0](0) == Approx(std::log(5.0)));
    CHECK(record[0](1) == Approx(std::atan2(4.0, 3.0)));
    CHECK(record[0](3 + 8) == Approx(0.09));  // the drift's prior
    CHECK(record[0](12) == 0.0);
    CHECK(record[0](13) == record[0](0));

    Call call;
    REQUIRE(filter.summary(call, record, mean, covariance) == PLR_OK);
    const Eigen::Matrix2d given = (Eigen::Matrix2d() << 0.04, 0.01, 0.01, 0.09).finished();
    CHECK((mean[0] - Eigen::Vector2d(3.0, 4.0)).norm() < 1e-14);
    CHECK((covariance[0] - given).norm() < 1e-14);  // there and back

    Batch seen(2, 1), projected(2, 2), cross(3, 2), cartesian_cross(2, 2);
    REQUIRE(filter.project(call, 0, record, seen, projected, cross, &cartesian_cross) == PLR_OK);
    CHECK((cartesian_cross[0] - given).norm() < 1e-14);  // the sensor sees the Cartesian position itself
    CHECK((seen[0] - mean[0]).norm() < 1e-14);
    CHECK((projected[0] - given).norm() < 1e-14);

    Batch z(2, 1), out(filter.record_size(), 1);
    z[0] << 3.001, 4.0;
    EstimatorUnderTest::Told told(2, 1);
    const Eigen::Matrix2d noise = 0.05 * Eigen::Matrix2d::Identity();
    REQUIRE(filter.update(call, 0, record, z, pelorus::const_view(noise), out, told) == PLR_OK);
    REQUIRE(filter.summary(call, out, mean, covariance) == PLR_OK);
    // Close to the linearisation point the filter is that of the Cartesian plane.
    const Eigen::Matrix2d s = given + noise;
    const Eigen::Vector2d expected = Eigen::Vector2d(3.0, 4.0) + given * s.inverse() * Eigen::Vector2d(0.001, 0.0);
    CHECK((mean[0] - expected).norm() < 1e-6);
    CHECK((covariance[0] - (given - given * s.inverse() * given)).norm() < 1e-4);
    CHECK(out[0].bottomRows(2) == record[0].bottomRows(2));  // an update leaves the motion's record alone
}

TEST_CASE(
    "a motion's record advances with the posterior that the step starts from, and its noise sees the record as it "
    "stood",
    "[kalman]") {
    const Filter f;
    const auto& filter = f.filter;
    CHECK((filter.info().flags & PLR_ESTIMATOR_USES_EXTENT) != 0);
    const std::int64_t count = 19;
    Batch records(filter.record_size(), 1, count);
    for (std::int64_t i = 0; i < count; ++i) records[i] = f.start()[0];
    const Batch before = records;
    const double dt = 0.5;
    Batch extents(1, 1, count);
    for (std::int64_t i = 0; i < count; ++i) extents[i](0) = 2.0 + static_cast<double>(i);
    auto args = pelorus::arguments<plr_estimator_predict>();
    args.dt = pelorus::common_view(&dt, 1, 1, count);
    args.extent = extents.in();
    args.record = records.in();
    args.out = records.out();
    Call call(count);
    REQUIRE(filter.part().call(&plr_estimator::predict, call, args) == PLR_OK);
    Batch start = f.start();
    const Eigen::Map<const Eigen::Matrix3d> p0(start[0].data() + 3);
    Eigen::Matrix3d transition = Eigen::Matrix3d::Identity();
    transition(1, 2) = dt;
    for (std::int64_t i = 0; i < count; ++i) {
        const Eigen::Map<const Eigen::Matrix3d> p(records[i].data() + 3);
        const Eigen::Matrix3d expected =
            transition * p0 * transition.transpose() + p0(0, 0) * extents[i](0) * dt * Eigen::Matrix3d::Identity();
        CHECK((p - expected).norm() < 1e-14);
        CHECK(records[i](12) == 1.0);
        CHECK(records[i](13) == p0(1, 1));
    }
    REQUIRE(filter.part().call(&plr_estimator::predict, call, args) == PLR_OK);
    CHECK(records[0](12) == 2.0);
}

TEST_CASE("angles of the state are wrapped after an update and averaged around the circle", "[kalman]") {
    const Filter f;
    const auto& filter = f.filter;
    const double pi = std::acos(-1.0);
    Batch start = f.start();
    const auto at_azimuth = [&](double azimuth) {
        Batch record = start;
        record[0](1) = azimuth;
        return record;
    };
    Batch record = at_azimuth(pi - 0.01), z(2, 1);
    const double beyond = -pi + 0.02;
    z[0] << 5.0 * std::cos(beyond), 5.0 * std::sin(beyond);
    Call call;
    EstimatorUnderTest::Told told(2, 1);
    const Eigen::Matrix2d noise = 1e-6 * Eigen::Matrix2d::Identity();
    REQUIRE(filter.update(call, 0, record, z, pelorus::const_view(noise), record, told) == PLR_OK);
    CHECK(record[0](1) == Approx(beyond).margin(1e-3));

    const auto* const mix = filter.part().extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX);
    Batch both(filter.record_size(), 2), weights(2, 1), out(filter.record_size(), 1);
    both[0].col(0) = at_azimuth(pi - 0.1)[0];
    both[0].col(1) = at_azimuth(-pi + 0.3)[0];
    both[0](12, 1) = 9.0;
    weights[0] << 0.4, 0.6;
    const plr_estimator_mix_args args{sizeof args, 0, weights.in(), both.in(), out.out()};
    REQUIRE(mix->mix(filter.part().self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
    CHECK(out[0](1) == Approx(-pi + 0.14));
    CHECK(out[0](12) == 9.0);  // the likelier one's record
    const double expected = start[0](3 + 4) + 0.4 * 0.24 * 0.24 + 0.6 * 0.16 * 0.16;
    CHECK(out[0](3 + 4) == Approx(expected));
}

TEST_CASE("a record's version tells the motion's layout too", "[kalman]") {
    const Filter f;
    const Instance motion("motion", "constant_velocity", {{"dimension", "2"}});
    CHECK(f.filter.info().record_version == plr_mix_version(1, 1));
}
