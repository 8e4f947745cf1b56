// The filter on motions that the Pelorus plugins do not cover yet: a state that is not Cartesian, a record of its own.
#include "../../../tests/support/estimator_under_test.hpp"
#include "../../../tests/support/log_polar_motion.hpp"

#include <catch2/catch.hpp>
#include <Eigen/LU>
#include <pelorus/abi/record.h>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

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
    Batch extents(2, 2, count);
    for (std::int64_t i = 0; i < count; ++i) extents[i] = (2.0 + static_cast<double>(i)) * Eigen::Matrix2d::Identity();
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
            transition * p0 * transition.transpose() + p0(0, 0) * extents[i](0, 0) * dt * Eigen::Matrix3d::Identity();
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
