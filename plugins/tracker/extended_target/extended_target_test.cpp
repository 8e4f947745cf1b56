#include <catch2/catch.hpp>
#include <cmath>

#include <Eigen/Dense>

#include "tracking_rig.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using extended_target::Entry;
using extended_target::Tracking;

MatrixXd block(const MatrixXd& covariance, int row, int col) { return covariance.block(3 * row, 3 * col, 3, 3); }

}  // namespace

TEST_CASE("extended target: the published start differences two scans and begins at the first", "[extended_target]") {
    Tracking run;
    run.scan(0);
    CHECK(run.told().empty());
    run.scan(1);
    REQUIRE(run.bench.published.size() == 1);
    CHECK(run.bench.published[0].message->time == second);
    const auto told = run.told();
    REQUIRE(told.size() == 2);
    const VectorXd c0 = Tracking::target_points(0, 8).rowwise().mean(),
                   c1 = Tracking::target_points(1, 8).rowwise().mean();
    CHECK(told[0].time == 0);
    CHECK((told[0].mean.head(3) - c0).norm() < 1e-12);
    CHECK((told[0].mean.segment(3, 3) - (c1 - c0)).norm() < 1e-12);
    CHECK(told[0].mean.tail(3).norm() == 0);
    VectorXd variances(9);
    variances << 25, 25, 25, 1, 1, 1, .25, .25, .25;
    CHECK((told[0].covariance - MatrixXd(variances.asDiagonal())).norm() < 1e-12);
    CHECK(told[0].measurements == std::vector<std::uint64_t>{1, 2, 3, 4, 5, 6, 7, 8});
    const plr_tracks& tracks = run.bench.published[0].tracks();
    REQUIRE(tracks.measurement_distances != nullptr);
    for (int k = 0; k < 16; ++k) CHECK(tracks.measurement_distances[k] > 0);
    CHECK(told[1].time == second);
    CHECK(told[1].id == told[0].id);
    CHECK(told[1].status == PLR_TRACK_CONFIRMED);
    CHECK(told[1].measurements.front() == 101);
}

TEST_CASE("extended target: the consistent start begins at the second scan with what the shape implies",
          "[extended_target]") {
    Tracking run("{update: feldmann, start: consistent}");
    const double dt = 2;
    run.scan(0);
    run.scan(2, 10);
    const auto told = run.told();
    REQUIRE(told.size() == 2);
    const MatrixXd effective = (told[1].extent + MatrixXd::Identity(3, 3)) / 10;  // D
    CHECK((block(told[1].covariance, 0, 0) - effective).norm() < 1e-9);
    CHECK((block(told[1].covariance, 0, 1) - effective / dt).norm() < 1e-9);
    CHECK((block(told[1].covariance, 1, 1) - 2 * effective / (dt * dt)).norm() < 1e-9);
    CHECK((block(told[1].covariance, 2, 2) - 0.25 * MatrixXd::Identity(3, 3)).norm() < 1e-9);  // the motion's prior
    const VectorXd c0 = Tracking::target_points(0, 8).rowwise().mean(),
                   c2 = Tracking::target_points(2, 10).rowwise().mean();
    CHECK((told[1].mean.head(3) - c2).norm() < 1e-9);
    CHECK((told[1].mean.segment(3, 3) - (c2 - c0) / dt).norm() < 1e-9);
    CHECK(told[0].time == 0);
    CHECK((told[0].mean.head(3) - c0).norm() < 1e-9);
    CHECK(told[0].mean.tail(6) == told[1].mean.tail(6));
    CHECK(told[0].extent == told[1].extent);
    CHECK((block(told[0].covariance, 0, 1) + effective / dt).norm() < 1e-9);  // the other way round at the beginning
    run.scan(3);
    CHECK(run.told().size() == 3);
}

TEST_CASE("extended target: Koch's joint extent starts both ways, and its covariance is a multiple of the shape",
          "[extended_target]") {
    const bool consistent = GENERATE(false, true);
    Tracking run(consistent ? "{update: koch, start: consistent}" : "{update: koch}");
    for (int k = 0; k < 30; ++k) run.scan(k);
    const auto told = run.told();
    REQUIRE(told.size() == 30);
    const Entry& last = told.back();
    const double factor = block(last.covariance, 0, 0)(0, 0) / last.extent(0, 0);
    CHECK((block(last.covariance, 0, 0) - factor * last.extent).norm() < 1e-9 * last.extent.norm());
    CHECK((last.mean.head(3) - Tracking::centre(29)).norm() < 8);
    CHECK((last.mean.segment(3, 3) - Vector3d(20, 0, -2)).norm() < 2);
    if (consistent) CHECK((block(told[1].covariance, 0, 0) - told[1].extent / 8).norm() < 1e-9 * told[1].extent.norm());
}

TEST_CASE("extended target: it coasts through empty scans, gives up, and starts anew under another id",
          "[extended_target]") {
    Tracking run("{}", "{misses_to_delete: 3}");
    for (int k = 0; k < 4; ++k) run.scan(k);
    for (int k = 4; k < 8; ++k) run.empty(k);
    for (int k = 8; k < 10; ++k) run.scan(k);
    const auto told = run.told();
    REQUIRE(told.size() == 9);  // 0..3, coasting 4 and 5, deleted 6, nothing at 7, 8 and 9
    CHECK(told[4].status == PLR_TRACK_COASTING);
    CHECK(told[4].misses == 1);
    CHECK(told[4].measurements.empty());
    CHECK((told[5].mean.head(3) - told[4].mean.head(3) - told[4].mean.segment(3, 3) - told[4].mean.tail(3) / 2).norm() <
          1e-9);
    CHECK(told[6].status == PLR_TRACK_DELETED);
    CHECK(told[6].time == 6 * second);
    CHECK(told[7].id != told[6].id);
    CHECK(told[7].time == 8 * second);
    CHECK(told[8].status == PLR_TRACK_CONFIRMED);
}

TEST_CASE("extended target: a first scan does not wait for ever for its second", "[extended_target]") {
    Tracking run("{}", "{misses_to_delete: 2}");
    run.scan(0);
    run.empty(1);
    run.empty(2);
    run.scan(3);
    CHECK(run.told().empty());
    run.scan(4);
    REQUIRE(run.told().size() == 2);
    CHECK(run.told()[0].time == 3 * second);
}

TEST_CASE("extended target: scans that make no shape start nothing and are counted", "[extended_target]") {
    Tracking run;
    run.scan(0, 3);  // too few
    CHECK(run.bench.counters["scans_not_used_to_start"] == 1);
    MatrixXd flat = Tracking::target_points(1, 6);
    flat.row(0).setConstant(20);
    run.scan_at(1, flat);
    run.scan(2);  // the flat one makes no shape: this one is the first now
    CHECK(run.told().empty());
    CHECK(run.bench.counters["starts_failed"] == 1);
    REQUIRE(run.bench.log.size() == 1);
    CHECK(run.bench.log[0] ==
          "no start: extent, init: the points lie in a plane, on a line or in one place: they make no shape (item 0)");
    run.scan(3, 2);  // with the published start, any second scan will do
    REQUIRE(run.told().size() == 2);
    CHECK(run.told()[0].time == 2 * second);
}

TEST_CASE("extended target: points outside the gate are left out", "[extended_target]") {
    Tracking with("{}", "{gate: 4}"), clean;
    for (int k = 0; k < 12; ++k) {
        MatrixXd points = Tracking::target_points(k, 8);
        clean.scan_at(k, points);
        if (k > 5) {
            points.conservativeResize(3, 9);
            points.col(8) = Tracking::centre(k) + Vector3d(0, 400, 0);
        }
        with.scan_at(k, points);
    }
    CHECK(with.bench.counters["points_outside_gate"] == 6);
    CHECK((with.told().back().mean - clean.told().back().mean).norm() < 1e-12);
    CHECK(with.told().back().measurements.size() == 8);
}

TEST_CASE("extended target: any sensor that can be inverted will do", "[extended_target]") {
    // A radar 2 km away whose errors are about those of the position sensor: the tracks nearly agree.
    const std::string radar = "{noise: [1 m, 0.5 mrad, 0.5 mrad], position: [0 m, 2000 m, 0 m]}";
    Tracking polar("{update: feldmann}", "{}", "spherical", radar), straight("{update: feldmann}");
    const auto sensor = part(polar.bench, "sensor", "spherical", radar);
    const auto& table = sensor->table<plr_sensor>();
    const auto* info = table.info(sensor->self());
    for (int k = 0; k < 20; ++k) {
        const MatrixXd points = Tracking::target_points(k, 8);
        MatrixXd measured(3, 8);
        Call call;
        auto args = pelorus::arguments<plr_sensor_measure>();
        args.cartesian = pelorus::const_view(points.data(), 3, 8, 1);
        args.out = pelorus::view(measured.data(), 3, 8, 1);
        REQUIRE(table.measure(sensor->self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        pelorus::ScanBuilder scan("radar", "", pelorus::Space(*info->measurement));
        for (int i = 0; i < 8; ++i)
            scan.add(static_cast<std::uint64_t>(100 * k + i + 1), measured.col(i).data());  // no covariances
        polar.tracker.receive(0, scan.message(k * second));
        straight.scan_at(k, points);
    }
    const auto one = polar.told(), other = straight.told();
    REQUIRE(one.size() == 20);
    CHECK((one.back().mean.head(3) - other.back().mean.head(3)).norm() < 0.05);
    CHECK((one.back().mean.segment(3, 3) - other.back().mean.segment(3, 3)).norm() < 0.02);
    CHECK((one.back().extent - other.back().extent).norm() < 0.01 * other.back().extent.norm());
}

TEST_CASE("extended target: the sensor's own noise serves scans without covariances", "[extended_target]") {
    Tracking told("{update: feldmann}"), silent("{update: feldmann}", "{}", "position", "{noise: 2 m}");
    for (int k = 0; k < 6; ++k) {
        told.scan_at(k, Tracking::target_points(k, 8), 4 * MatrixXd::Identity(3, 3));
        silent.scan_at(k, Tracking::target_points(k, 8), {});
    }
    CHECK(told.told().back().mean == silent.told().back().mean);
    CHECK(told.told().back().extent == silent.told().back().extent);
}

TEST_CASE("extended target: a measurement whose noise the sensor cannot tell is left out", "[extended_target]") {
    const std::string radar = "{noise: [1 m, 0.5 mrad, 0.5 mrad], snr: 10}";
    Tracking run("{update: feldmann}", "{}", "spherical", radar), clean("{update: feldmann}", "{}", "spherical", radar);
    const auto sensor = part(run.bench, "sensor", "spherical", radar);
    const pelorus::Space space(*sensor->table<plr_sensor>().info(sensor->self())->measurement);
    const auto scan_without_noise = [&](Tracking& to, int k, bool with_ninth) {
        pelorus::ScanBuilder scan("radar", "", space);
        for (int i = 0; i < (with_ninth ? 9 : 8); ++i) {
            const double measured[] = {2000 + 3.0 * (i % 3), 0.1 + 1e-3 * i, 0.2 + 1e-3 * (i % 4)};
            scan.add(static_cast<std::uint64_t>(100 * k + i + 1), measured);
            scan.set_snr(i == 8 ? 0.0 : 20.0);  // no power ratio: the sensor refuses it
        }
        to.tracker.receive(0, scan.message(k * second));
    };
    for (int k = 0; k < 6; ++k) {
        scan_without_noise(run, k, true);
        scan_without_noise(clean, k, false);
    }
    REQUIRE(!run.told().empty());
    CHECK(run.bench.counters["points_not_converted"] == 6);
    CHECK(clean.bench.counters["points_not_converted"] == 0);
    CHECK(run.told().back().mean == clean.told().back().mean);
    CHECK(run.told().back().extent == clean.told().back().extent);
    CHECK(run.told().back().measurements.size() == 8);
}

TEST_CASE("extended target: two scans of one time make two updates of one prediction", "[extended_target]") {
    Tracking run;
    for (int k = 0; k < 5; ++k) run.scan(k);
    run.scan_at(4, Tracking::target_points(40, 8).colwise() - 36 * Vector3d(20, 0, -2));
    const auto told = run.told();
    REQUIRE(told.size() == 6);
    CHECK(told[5].time == told[4].time);
    CHECK(block(told[5].covariance, 0, 0).trace() < block(told[4].covariance, 0, 0).trace());
    CHECK(block(told[5].covariance, 2, 2).trace() <= block(told[4].covariance, 2, 2).trace());
}

TEST_CASE("extended target: an old scan and one of an unknown sensor are refused, and nothing changes",
          "[extended_target]") {
    Tracking run;
    for (int k = 0; k < 5; ++k) run.scan(k);
    const auto before = run.tracker.save();
    CHECK_THROWS_WITH(run.scan(3), "a scan of sensor radar is older than the newest one; sort them first");
    pelorus::ScanBuilder foreign("sonar", "", pelorus::position_space(3));
    CHECK_THROWS_WITH(run.tracker.receive(0, foreign.message(9 * second)),
                      "there is no sensor sonar in the slot `sensors`");
    CHECK(run.tracker.save() == before);
}

TEST_CASE("extended target: a saved tracker goes on bit for bit", "[extended_target]") {
    const std::string extent = GENERATE("{}", "{update: feldmann, start: consistent}", "{update: koch}");
    for (const int at : {0, 1, 2, 7}) {
        Tracking whole(extent), first(extent), second_half(extent);
        for (int k = 0; k < 12; ++k) whole.scan(k);
        for (int k = 0; k < at; ++k) first.scan(k);
        second_half.tracker.load(first.tracker.save());
        for (int k = at; k < 12; ++k) second_half.scan(k);
        CHECK(second_half.tracker.save() == whole.tracker.save());
        CHECK(second_half.told().back().mean == whole.told().back().mean);
    }
    Tracking run(extent);
    for (int k = 0; k < 4; ++k) run.scan(k);
    Tracking other(extent == "{update: koch}" ? "{}" : "{update: koch}");
    try {
        other.tracker.load(run.tracker.save());
        FAIL("state of other models was taken");
    } catch (const pelorus::test::CallFailed& failure) {
        CHECK(failure.status == PLR_E_STATE_VERSION);
    }
}

TEST_CASE("extended target: parts that do not fit are refused by slot", "[extended_target]") {
    Bench bench;
    const auto refusal = [&](std::vector<Part> parts) -> std::string {
        try {
            const StageUnderTest tracker(bench, plugin("tracker", "extended_target"), "{}", std::move(parts));
            return "";
        } catch (const std::exception& problem) {
            return problem.what();
        }
    };
    const auto separate = airship_tracker_parts(bench, "{}"), joint = airship_tracker_parts(bench, "{update: koch}");
    CHECK(refusal({separate[1]}) ==
          "estimator: is empty: the extent (extent.random_matrix) has no kinematics of its own");
    CHECK(refusal({separate[0], joint[0]}) ==
          "estimator: must be empty: the extent (extent.random_matrix) owns the kinematics, too");
    const Part flat{"extent", "", part(bench, "extent", "random_matrix", "{dimension: 2}")};
    CHECK(refusal({separate[0], flat}) == "extent: has 2 dimensions, the kinematics have 3 axes");
    const auto motion = part(bench, "motion", "singer", airship_motion);
    const Part blind{"extent", "", part(bench, "extent", "random_matrix", "{update: koch}", {{"motion", "", motion}})};
    CHECK(refusal({blind}) == "extent: has no sensors; fill its slot `sensors` with those of the scans");
}

namespace {

/// Root mean square of the position's error, and mean short half axis, of an airship whose points share a sensor error of 5 m.
struct SharedErrors {
    double position = 0, short_axis = 0, spread = 0;
};
SharedErrors with_shared_errors(const std::string& with, bool is_shared) {
    Tracking run("{update: feldmann, start: consistent}", with, "position", "{noise: 5 m}");
    constexpr int scans = 60;
    for (int k = 0; k < scans; ++k) {
        MatrixXd unit(3, 16), points = Tracking::target_points(k, 16);
        pelorus::host::random_service().normal({{99, static_cast<std::uint64_t>(k)}}, 0, unit.size(), unit.data());
        for (Eigen::Index p = 0; p < 16; ++p) points.col(p) += 5 * unit.col(is_shared ? 0 : p);
        run.scan_at(k, points, 25 * MatrixXd::Identity(3, 3));
    }
    SharedErrors out;
    const auto told = run.told();
    for (const Entry& entry : told) {
        const int k = static_cast<int>(entry.time / second);
        if (k < 20) continue;
        out.position += (entry.mean.head(3) - Tracking::centre(k)).squaredNorm() / (scans - 20);
        const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(entry.extent).eigenvalues();
        out.short_axis += 0.5 * (std::sqrt(values(0)) + std::sqrt(values(1))) / (scans - 20);
        out.spread += std::sqrt(entry.covariance.topLeftCorner(3, 3).trace()) / (scans - 20);
    }
    out.position = std::sqrt(out.position);
    return out;
}

}  // namespace

TEST_CASE("extended target: a sensor error that all points share is found out", "[extended_target]") {
    const SharedErrors told = with_shared_errors("{shared_error: [0, 1]}", true),
                       not_told = with_shared_errors("{}", true);
    CHECK(told.position < 0.95 * not_told.position);
    CHECK(told.short_axis == Approx(5).margin(0.4));
    CHECK(not_told.short_axis < 4.3);  // it takes noise out that is not in the spread
    CHECK(told.spread > 1.5 * not_told.spread);
    // And one that they do not share is not taken for one.
    const SharedErrors own = with_shared_errors("{shared_error: [0, 1]}", false),
                       plain = with_shared_errors("{}", false);
    CHECK(own.position == Approx(plain.position).epsilon(0.02));
    CHECK(own.short_axis == Approx(plain.short_axis).epsilon(0.02));
}

TEST_CASE("extended target: with a single share the filter is told what is shared", "[extended_target]") {
    const SharedErrors known = with_shared_errors("{shared_error: [1]}", true),
                       found = with_shared_errors("{shared_error: [0, 1]}", true);
    CHECK(known.position == Approx(found.position).epsilon(0.02));
    const SharedErrors none = with_shared_errors("{shared_error: [0]}", true), plain = with_shared_errors("{}", true);
    CHECK(none.position == Approx(plain.position).epsilon(1e-12));
}

TEST_CASE("extended target: a tracker that weighs shared errors is saved whole, and a joint extent cannot",
          "[extended_target]") {
    const std::string extent = "{update: feldmann, start: consistent}", with = "{shared_error: [0, 0.5, 1]}";
    Tracking whole(extent, with), first(extent, with), second_half(extent, with);
    for (int k = 0; k < 12; ++k) whole.scan(k);
    for (int k = 0; k < 7; ++k) first.scan(k);
    second_half.tracker.load(first.tracker.save());
    for (int k = 7; k < 12; ++k) second_half.scan(k);
    CHECK(second_half.tracker.save() == whole.tracker.save());
    Tracking fewer(extent, "{shared_error: [0, 1]}");
    CHECK_THROWS(fewer.tracker.load(first.tracker.save()));
    CHECK_THROWS_WITH(Tracking("{update: koch}", with),
                      "shared_error: needs an estimator beside the extent; here the extent (extent.random_matrix) owns "
                      "the kinematics");
}
