#include <catch2/catch.hpp>

#include <Eigen/Dense>

#include "group_rig.hpp"

using namespace group;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Ids = std::vector<std::uint64_t>;

namespace {

/// A square that moves by 10 m a second along x, seen from scan `from` to scan `to`.
std::vector<Entry> fly(Rig& rig, int from, int to, double y = 0) {
    std::vector<Entry> told;
    for (int k = from; k <= to; ++k) told = rig.scan(k, square(10 * k, y));
    return told;
}

}  // namespace

TEST_CASE("tracker.group starts at the third centre with what three centres tell", "[tracker.group]") {
    Rig rig;
    CHECK(rig.scan(0, square(0, 0)).empty());
    CHECK(rig.scan(1, square(10, 1)).empty());
    const auto told = rig.scan(2, square(20, 2));
    REQUIRE(told.size() == 1);
    const Entry& group = told[0];
    CHECK(group.id == 1);
    CHECK(group.status == PLR_TRACK_CONFIRMED);
    CHECK(group.measurements == Ids{9, 10, 11, 12});
    CHECK(group.parents.empty());
    VectorXd mean(6);
    mean << 20, 2, 0, 10, 1, 0;
    CHECK((group.mean - mean).norm() < 1e-9);
    // R = 4 m2 on each axis, T13 = 2 s: P_pp = R3, P_pv = R3/(2 T), P_vv = (R1 + R3)/(2 T)^2.
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    MatrixXd covariance(6, 6);
    covariance << 4 * one, 2 * one, 2 * one, 2 * one;
    CHECK((group.covariance - covariance).norm() < 1e-9);
    // The square's scatter over n, and the smallest half axis squared.
    CHECK((group.extent - MatrixXd(Vector3d(109, 109, 9).asDiagonal())).norm() < 1e-9);
    CHECK(rig.innovations().empty());
}

TEST_CASE("tracker.group updates a centre as one measurement of the mean covariance", "[tracker.group]") {
    Rig rig;
    const Entry before = fly(rig, 0, 2).at(0);
    const auto told = rig.scan(3, square(31, 2));
    REQUIRE(told.size() == 1);
    MatrixXd f = MatrixXd::Identity(6, 6), q(6, 6);
    f.topRightCorner(3, 3).setIdentity();
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    q << 0.1 / 3 * one, 0.05 * one, 0.05 * one, 0.1 * one;
    const MatrixXd p = f * before.covariance * f.transpose() + q;
    const MatrixXd s = p.topLeftCorner(3, 3) + 4 * one, gain = p.leftCols(3) * s.inverse();
    const VectorXd predicted = f * before.mean, e = Vector3d(31, 2, 0) - predicted.head(3);
    CHECK((told[0].mean - (predicted + gain * e)).norm() < 1e-9);
    CHECK((told[0].covariance - (p - gain * s * gain.transpose())).norm() < 1e-9);
    REQUIRE(rig.innovations().size() == 1);
    CHECK(rig.innovations()[0] == Approx(e.dot(s.inverse() * e)));
}

TEST_CASE("tracker.group takes a centre for as good as the extent says, if it is to", "[tracker.group]") {
    Rig mean, effective("{maximum_speed: 100 m/s, centroid_noise: effective}");
    const double trusted = fly(effective, 0, 6).at(0).covariance.trace(),
                 plain = fly(mean, 0, 6).at(0).covariance.trace();
    CHECK(trusted != Approx(plain));
}

TEST_CASE("tracker.group weighs members as the partitioner does", "[tracker.group]") {
    Rig rig(Rig::slow, &Rig::about_predictions());
    const Entry before = fly(rig, 0, 2).at(0);
    // Expected at (30, 0, 0): the first point there is nearest and weighs 2/4, the two others 1/4 each.
    const auto told = rig.scan(3, {{30, 2, 0}, {34, 10, 0}, {38, -10, 0}});
    REQUIRE(told.size() == 1);
    const Vector3d centre(0.5 * 30 + 0.25 * 34 + 0.25 * 38, 0.5 * 2, 0);
    const VectorXd expected = before.mean.head(3) + before.mean.tail(3);
    const VectorXd moved = told[0].mean.head(3) - expected;
    CHECK(moved.normalized().dot((centre - Vector3d(expected)).normalized()) == Approx(1));
}

TEST_CASE("tracker.group lets a measurement serve several groups where cells overlap", "[tracker.group]") {
    Rig rig(Rig::slow, &Rig::about_predictions());
    std::vector<Entry> told;
    for (int k = 0; k <= 3; ++k)
        told = rig.scan(k, {{10.0 * k, -40, 0}, {10.0 * k, 40 - 10.0 * k, 0}});  // 80, 70, 60, 50 m apart
    REQUIRE(told.size() == 2);
    CHECK(told[0].measurements == Ids{7, 8});
    CHECK(told[1].measurements == Ids{7, 8});
}

TEST_CASE("tracker.group coasts without a cell, and ends at the last miss in a row", "[tracker.group]") {
    Rig rig("{maximum_speed: 100 m/s, misses_to_delete: 3}");
    const Entry last = fly(rig, 0, 5).at(0);
    for (int k = 6; k <= 8; ++k) {
        const auto told = rig.scan(k, {});
        REQUIRE(told.size() == 1);
        CHECK(told[0].misses == k - 5);
        CHECK(told[0].status == (k < 8 ? PLR_TRACK_COASTING : PLR_TRACK_DELETED));
        CHECK((told[0].mean.head(3) - (last.mean.head(3) + (k - 5) * last.mean.tail(3))).norm() < 1e-9);
        CHECK(told[0].measurements.empty());
    }
    CHECK(rig.scan(9, {}).empty());
    Rig seen("{maximum_speed: 100 m/s, misses_to_delete: 3}");
    fly(seen, 0, 5);
    seen.scan(6, {});
    seen.scan(7, {});
    CHECK(seen.scan(8, square(80, 0)).at(0).misses == 0);
    CHECK(seen.scan(9, {}).at(0).misses == 1);
}

TEST_CASE("tracker.group keeps the identity of a group that splits, and tells where the rest came from",
          "[tracker.group]") {
    // A centre that jumps by 20 m is within the gate with coarse measurements, or does not matter.
    const auto& [with, variance] = GENERATE(table<std::string, double>(
        {{Rig::slow, 100}, {"{maximum_speed: 100 m/s, association: members, duplicate_distance: 0 m}", 1}}));
    Rig rig(with);
    rig.variance = variance;
    std::vector<Entry> told;
    // Four and two, which leave the four at 6 m/s from the tenth scan on.
    for (int k = 0; k < 30; ++k) {
        const double apart = 25 + std::max(0, k - 10) * 6.0;
        told = rig.scan(k, both(square(10 * k, 0), {{10.0 * k, 10 + apart, 0}, {10.0 * k + 5, 10 + apart, 0}}));
        if (k < 10) CHECK(told.size() == (k < 2 ? 0 : 1));
    }
    REQUIRE(told.size() == 2);
    CHECK(told[0].id == 1);
    CHECK(told[0].parents.empty());
    CHECK(told[0].measurements.size() == 4);
    CHECK(told[1].parents == Ids{1});
    CHECK(told[1].measurements.size() == 2);
}

TEST_CASE("tracker.group tells which group went into which", "[tracker.group]") {
    // A centre that jumps by 20 m is within the gate with coarse measurements, or does not matter.
    const auto& [with, variance] = GENERATE(table<std::string, double>(
        {{Rig::slow, 100}, {"{maximum_speed: 100 m/s, association: members, duplicate_distance: 0 m}", 1}}));
    Rig rig(with);
    rig.variance = variance;
    std::vector<Entry> told;
    bool is_ended = false;
    // The second group comes near and stays.
    for (int k = 0; k < 40; ++k) {
        told = rig.scan(k, both(square(10 * k, 0), square(10 * k, std::max(40.0, 200 - 8.0 * k))));
        for (const Entry& entry : told) is_ended = is_ended || (entry.id == 2 && entry.status == PLR_TRACK_DELETED);
    }
    CHECK(is_ended);
    REQUIRE(told.size() == 1);
    CHECK(told[0].id == 1);
    CHECK(told[0].parents == Ids{2});
    CHECK(told[0].measurements.size() == 8);
}

TEST_CASE("tracker.group keeps the identity of the larger group in a merger, by its members", "[tracker.group]") {
    Rig rig("{maximum_speed: 100 m/s, association: members, duplicate_distance: 0 m}");
    rig.variance = 1;
    std::vector<Entry> told;
    // Two that are older meet four: the place where all are then is nearer to neither centre.
    for (int k = 0; k < 40; ++k) {
        const double y = std::max(40.0, 200 - 8.0 * k);
        const std::vector<Place> two{{10.0 * k, 0, 0}, {10.0 * k + 5, 0, 0}};
        told = rig.scan(k, k < 3 ? two : both(two, square(10 * k, y)));
    }
    REQUIRE(told.size() == 1);
    CHECK(told[0].id == 2);
    CHECK(told[0].parents == Ids{1});
}

TEST_CASE("tracker.group ends the younger of two groups at one place, unless it is not to", "[tracker.group]") {
    for (const auto& [distance, left] : {std::pair{"20 m", std::size_t{1}}, std::pair{"0 m", std::size_t{2}}}) {
        Rig rig(std::string("{maximum_speed: 100 m/s, duplicate_distance: ") + distance + "}",
                &Rig::about_predictions());
        std::vector<Entry> told;
        // Two single objects come together; both groups then live on both measurements.
        for (int k = 0; k < 30; ++k)
            told = rig.scan(k, {{10.0 * k, 0, 0}, {10.0 * k, std::max(2.0, 100 - 5.0 * k), 0}});
        REQUIRE(told.size() == left);
        CHECK(told[0].id == 1);
        CHECK(told[0].parents == (left == 1 ? Ids{2} : Ids{}));
    }
}

TEST_CASE("tracker.group wants a partitioner that takes its threshold", "[tracker.group]") {
    CHECK_THROWS_WITH(Rig("{maximum_speed: 100 m/s, threshold: 15 m}", &Rig::about_predictions()),
                      Catch::Contains("threshold: the partitioner (org.example.partitioner.about_predictions) has no "
                                      "input `threshold`"));
}

TEST_CASE("tracker.group takes the thresholds that partitions by distance take", "[tracker.group]") {
    const auto rig = [](const std::string& threshold) {
        Rig("{maximum_speed: 100 m/s, threshold: " + threshold + "}", &Rig::about_predictions());
    };
    for (const std::string threshold : {"0 m", "-1 m", "1e-10 m", "1e16 m", ".inf m", ".nan m"})
        CHECK_THROWS_WITH(rig(threshold), Catch::Contains("threshold") && !Catch::Contains("has no input"));
    // What is within the bounds meets this partitioner, which has no such input.
    for (const std::string threshold : {"1e-9 m", "50 m", "1e15 m"})
        CHECK_THROWS_WITH(rig(threshold), Catch::Contains("has no input `threshold`"));
}

TEST_CASE("tracker.group takes a scan of the time of the last one, and starts nothing from it", "[tracker.group]") {
    Rig rig;
    fly(rig, 0, 2);
    const auto again = rig.scan(2, both(square(20, 0), square(20, 200)));
    REQUIRE(again.size() == 1);
    CHECK((again[0].mean.head(3) - Vector3d(20, 0, 0)).norm() < 1e-9);
    CHECK(rig.bench.counters["scans_not_used_to_start"] == 1);
}

TEST_CASE("tracker.group refuses scans that it cannot use", "[tracker.group]") {
    Rig rig;
    fly(rig, 0, 3);
    CHECK_THROWS_WITH(rig.scan(2, square(20, 0)),
                      "a scan of sensor radar is older than the newest one; sort them first");
    pelorus::ScanBuilder other("sonar", "", pelorus::position_space(3));
    CHECK_THROWS_WITH(rig.send(other.message(9 * second)), "there is no sensor sonar in the slot `sensors`");
    CHECK(rig.scan(4, square(40, 0)).size() == 1);
}
