// Association by joint probabilities, through the whole tracker.
#include <catch2/catch.hpp>

#include "../../../tests/support/reference.hpp"
#include "tracker_rig.hpp"

using namespace point_target;

namespace {

const plr_tracks& last_tracks(Rig& rig) { return rig.bench.published.at(0).tracks(); }

/// Weight that the entry gives to the measurement; 0 where it does not name it.
double weight_of(const plr_tracks& tracks, std::int64_t entry, std::uint64_t measurement) {
    for (std::int64_t k = tracks.measurement_offsets[entry]; k < tracks.measurement_offsets[entry + 1]; ++k)
        if (tracks.measurements[k] == measurement) return tracks.measurement_weights[k];
    return 0;
}

}  // namespace

TEST_CASE("tracker.point_target joins two tracks and three detections as the published library does",
          "[tracker.point_target]") {
    const auto entry = test_support::reference("models_and_filters.json").at("JPDA 2 tracks 3 detections");
    // As seen from a frame that moves with the tracks' velocity of 1 m/s along x, where a start from one point is at rest.
    Rig rig(
        "{maximum_speed: 100 m/s, start_confirm: 1, association: joint, gate_probability: 0.99, "
        "detection_probability: 0.9, clutter_density: 0.02}",
        "{dimension: 2, noise: 0.1 m2/s3, prior_velocity: 0.5 m/s}");
    rig.scan(0, {{0, 0}, {0, 3}});
    rig.scan(1, {{0.2, 0.4}, {-0.3, 2.5}, {0.1, 1.6}});
    const plr_tracks& tracks = last_tracks(rig);
    REQUIRE(tracks.count == 2);
    for (std::int64_t t = 0; t < 2; ++t) {
        const auto& result = entry.at("result").at(static_cast<std::size_t>(t));
        for (std::uint64_t d = 0; d < 3; ++d)
            CHECK(weight_of(tracks, t, 3 + d) ==
                  Approx(result.at("beta").at(std::to_string(d)).get<double>()).epsilon(1e-9));
        const Eigen::MatrixXd x = test_support::matrix(result.at("x")), p = test_support::matrix(result.at("P"));
        const int order[] = {0, 2, 1, 3};  // of x, vx, y, vy: x, y, vx, vy
        for (int r = 0; r < 4; ++r) {
            const double moved = r == 0 || r == 2 ? 1 : 0;
            CHECK(pelorus::item(tracks.mean, t)(r, 0) + moved == Approx(x(order[r], 0)).epsilon(1e-9));
            for (int c = 0; c < 4; ++c)
                CHECK(pelorus::item(tracks.covariance, t)(r, c) == Approx(p(order[r], order[c])).margin(1e-9));
        }
    }
}

TEST_CASE("tracker.point_target counts a shared detection as a hit of both tracks and starts none with it",
          "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, start_confirm: 2, association: joint, clutter_density: 1e-6}");
    for (int k = 0; k < 6; ++k) rig.scan(k, {{0, 0}, {0, 8}});
    const auto told = rig.scan(6, {{0, 4}, {500, 500}});
    REQUIRE(told.size() == 2);
    // One detection for two objects: each is as likely as not to be unseen.
    const plr_tracks& tracks = last_tracks(rig);
    CHECK(weight_of(tracks, 0, 13) + weight_of(tracks, 1, 13) == Approx(1).margin(1e-3));
    CHECK(rig.bench.counters["tracks_started"] == 3);
    for (int k = 7; k < 9; ++k) CHECK(rig.scan(k, {{0, 0}, {0, 8}}).size() == 2);
    CHECK(rig.bench.counters["tracks_started"] == 3);
}

TEST_CASE("tracker.point_target pulls a track by what may be its detection, and counts a miss where it hardly is",
          "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, start_confirm: 2, association: joint, clutter_density: 1, misses_to_delete: 3}");
    for (int k = 0; k < 6; ++k) rig.scan(k, {{0, 0}});
    auto told = rig.scan(6, {{3.5, 0}});  // as much clutter as that makes it a false alarm rather
    REQUIRE(told.size() == 1);
    const double weight = weight_of(last_tracks(rig), 0, 7);
    CHECK(weight > 0);
    CHECK(weight < 0.5);
    CHECK(told[0].status == PLR_TRACK_COASTING);
    CHECK(told[0].misses == 1);
    CHECK(told[0].time == Rig::ns(6));
    CHECK(told[0].x > 0.01);
    CHECK(told[0].x < 1);
    CHECK(rig.bench.published.size() == 1);  // no innovation of a detection that is hardly the track's
    told = rig.scan(7, {});
    CHECK(told.empty());
    told = rig.scan(8, {});
    REQUIRE(told.size() == 1);
    CHECK(told[0].status == PLR_TRACK_DELETED);
}

TEST_CASE("tracker.point_target mixes hypotheses of different times at the latest of them", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, start_confirm: 2, association: joint}");
    for (int k = 0; k < 12; ++k) rig.scan(k, {{10.0 * k, 0}}, {1.0 * k});
    // Both stand on the track's way.
    const auto told = rig.scan(12.5, {{120, 0}, {124, 0}}, {12, 12.4});
    REQUIRE(told.size() == 1);
    CHECK(told[0].time == Rig::ns(12.4));
    CHECK(told[0].x == Approx(124).margin(0.3));
    CHECK(told[0].measurements.size() == 2);
    const auto next = rig.scan(13, {{130, 0}}, {13});
    REQUIRE(next.size() == 1);
    CHECK(next[0].x == Approx(130).margin(0.3));
}

TEST_CASE("tracker.point_target leaves out pairs of a cluster beyond its limit and counts them",
          "[tracker.point_target]") {
    const std::string with = "{maximum_speed: 30 m/s, start_confirm: 1, association: joint, most_joint_events: ";
    Rig whole(with + "100000}"), limited(with + "4}");
    for (Rig* rig : {&whole, &limited}) {
        rig->scan(0, {{0, 0}, {0, 4}, {0, 8}});
        CHECK(rig->scan(1, {{0, 0}, {0, 4}, {0, 8}}).size() == 3);
    }
    CHECK(whole.bench.counters["dropped_pairs"] == 0);
    CHECK(limited.bench.counters["dropped_pairs"] > 0);
}

TEST_CASE("tracker.point_target refuses joint association that its parts cannot give", "[tracker.point_target]") {
    using namespace pelorus::test;
    Bench bench;
    const auto make = [&](const std::string& id, const std::string& with, std::vector<Instance::Part> parts = {}) {
        return std::make_shared<Instance>(bench, installed(id), with, std::move(parts));
    };
    const auto motion = make("motion.constant_velocity", "{}");
    const auto position = make("sensor.position", "{}"), spherical = make("sensor.spherical", "{}");
    const auto tracker = [&](const std::shared_ptr<Instance>& estimator, const std::string& with) {
        StageUnderTest(bench, plugin_of<PointTargetTracker>("tracker.point_target"),
                       "{maximum_speed: 9 m/s, association: joint" + with + "}",
                       std::vector<Instance::Part>{{"estimator", "", estimator}});
    };
    const auto kalman = make("estimator.kalman", "{}",
                             {{"motion", "", motion}, {"sensors", "one", position}, {"sensors", "two", spherical}});
    CHECK_NOTHROW(tracker(kalman, ""));
    CHECK_THROWS_WITH(tracker(kalman, ", clutter_density: 1"),
                      Catch::StartsWith("clutter_density: sensors one and two measure different components"));
    const auto single = make("estimator.kalman", "{}", {{"motion", "", motion}, {"sensors", "one", position}});
    const auto imm = make("estimator.imm", "{}", {{"estimators", "only", single}});
    CHECK_THROWS_WITH(tracker(imm, ""), Catch::Contains("cannot mix hypotheses"));
}

TEST_CASE("A density of clutter estimated from the gates is near the true one", "[tracker.point_target]") {
    // 40 gates of 2 components, S = 4 I: the gate's area is pi gate 4. 0.9 * 0.99 of the tracks see themselves, and 2 false alarms each.
    SensorModel sensor;
    sensor.m = 2;
    sensor.gate = 9.21;
    std::vector<GatedPair> pairs;
    for (std::size_t t = 0; t < 40; ++t)
        for (std::size_t d = 0; d < (t % 10 == 0 ? 2U : 3U); ++d) pairs.push_back({t, 3 * t + d, 0, 1, std::log(16.0)});
    const double area = 3.14159265358979 * 9.21 * 4;
    CHECK(estimated_clutter_density(pairs, sensor, 0.9, 0.99) == Approx(2 / area).epsilon(0.02));
    CHECK(estimated_clutter_density({{0, 0, 0, 1, std::log(16.0)}}, sensor, 0.9, 0.99) ==
          Approx((1 + 1 - 0.9 * 0.99) / area));
}
