#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tracker_rig.hpp"

using namespace point_target;

namespace {

struct Plot {
    double time;
    std::array<double, 2> place;
};

/// Two objects on crossing courses, seen once a second with errors of 1 m.
std::vector<std::vector<Plot>> plots(int seconds) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::vector<std::vector<Plot>> scans;
    for (int k = 0; k < seconds; ++k)
        scans.push_back({{static_cast<double>(k), {12.0 * k + normal(random), 5 + normal(random)}},
                         {static_cast<double>(k), {300 + normal(random), 200 - 9.0 * k + normal(random)}}});
    return scans;
}
std::vector<Entry> send(Rig& rig, const std::vector<Plot>& scan) {
    std::vector<std::array<double, 2>> places;
    for (const Plot& plot : scan) places.push_back(plot.place);
    return rig.scan(scan.front().time, places);
}
/// The newest entry of each track.
std::map<std::uint64_t, Entry> newest(Rig& rig, const std::vector<std::vector<Plot>>& scans) {
    std::map<std::uint64_t, Entry> told;
    for (const auto& scan : scans)
        for (const Entry& entry : send(rig, scan)) told.insert_or_assign(entry.id, entry);
    return told;
}
/// Groups of three, turned round: the newest first. The first two scans, which start the tracks, come in time.
std::vector<std::vector<Plot>> shuffled(std::vector<std::vector<Plot>> scans) {
    for (std::size_t first = 2; first + 3 <= scans.size(); first += 3) std::swap(scans[first], scans[first + 2]);
    return scans;
}
const char* const with = "{maximum_speed: 30 m/s, start_confirm: 2, misses_to_delete: 5}";

}  // namespace

TEST_CASE("tracker.point_target uses late plots where its estimator can: tracks are those of plots in time",
          "[tracker.point_target]") {
    const auto sorted = plots(20);  // 2 + 6 groups of 3
    Rig in_time(with);
    const auto expected = newest(in_time, sorted);
    Rig late(Rig::Inside{"estimator.out_of_sequence", "{}"}, with);
    const auto told = newest(late, shuffled(sorted));
    REQUIRE(expected.size() == 2);
    REQUIRE(told.size() == 2);
    for (const auto& [id, entry] : expected) {
        CAPTURE(id);
        const Entry& own = told.at(id);
        CHECK(own.time == 19 * second);
        CHECK(own.time == entry.time);
        CHECK(own.x == Approx(entry.x).margin(1e-6));
        CHECK(own.y == Approx(entry.y).margin(1e-6));
        CHECK(own.status == PLR_TRACK_CONFIRMED);
    }
    CHECK(late.bench.counters["late_measurements_used"] == 24);  // two of three, of two objects
    CHECK(late.bench.counters["late_measurements"] == 0);
    CHECK(late.bench.counters["tracks_started"] == 2);
    CHECK(late.bench.counters["numeric_failures"] == 0);

    Rig plain(with);
    newest(plain, shuffled(sorted));
    CHECK(plain.bench.counters["late_measurements_used"] == 0);
    CHECK(plain.bench.counters["late_measurements"] > 0);
}

TEST_CASE("tracker.point_target tells a late plot's track at its newest time", "[tracker.point_target]") {
    Rig rig(Rig::Inside{"estimator.out_of_sequence", "{maximum_lag: 2 s}"}, with);
    for (int k = 0; k < 6; ++k) rig.scan(k, {{10.0 * k, 0}});
    rig.scan(7, {{70, 0}});  // nothing came of second 6 yet
    const auto told = rig.scan(6, {{60.5, 0.5}});
    REQUIRE(told.size() == 1);
    CHECK(told[0].time == 7 * second);
    CHECK(told[0].x == Approx(70).margin(1));
    CHECK(told[0].measurements == std::vector<std::uint64_t>{8});
    CHECK(rig.bench.counters["late_measurements_used"] == 1);
    // Later than the estimator allows: not used, and no harm to the track.
    CHECK(rig.scan(4.5, {{45, 0}}).empty());
    CHECK(rig.bench.counters["late_measurements"] == 1);
    CHECK(rig.bench.counters["numeric_failures"] == 0);
    CHECK(rig.scan(8, {{80, 0}}).at(0).id == 1);
    CHECK(rig.bench.counters["tracks_started"] == 1);
}

TEST_CASE("tracker.point_target takes a late plot for the miss that it was", "[tracker.point_target]") {
    Rig rig(Rig::Inside{"estimator.out_of_sequence", "{}"}, with);
    for (int k = 0; k < 6; ++k) rig.scan(k, {{10.0 * k, 0}});
    CHECK(rig.scan(6, {}).at(0).status == PLR_TRACK_COASTING);
    rig.scan(7, {});
    const auto told = rig.scan(6.5, {{65, 0}});
    REQUIRE(told.size() == 1);
    CHECK(told[0].status == PLR_TRACK_CONFIRMED);
    CHECK(told[0].misses == 0);
    CHECK(told[0].time == 7 * second);
    CHECK(told[0].x == Approx(70).margin(1));
    rig.scan(8, {});
    // One from before the last that was seen changes nothing of that.
    const auto older = rig.scan(4.5, {{45, 0}});
    REQUIRE(older.size() == 1);
    CHECK(older[0].status == PLR_TRACK_COASTING);
    CHECK(older[0].misses == 1);
}

TEST_CASE("tracker.point_target publishes smoothed tracks, as old as its estimator's lag", "[tracker.point_target]") {
    Rig rig(Rig::Inside{"estimator.fixed_lag_smoother", "{lag: 3}", true}, with);
    const auto scans = plots(15);
    double filtered = 0, smoothed = 0;
    std::map<std::pair<std::uint64_t, std::int64_t>, int> told;
    for (std::size_t k = 0; k < scans.size(); ++k) {
        for (const Entry& entry : send(rig, scans[k]))
            if (k > 5) filtered += std::pow(entry.x - (entry.id == 1 ? 12.0 * static_cast<double>(k) : 300), 2);
        const plr_tracks* past = nullptr;
        for (const auto& each : rig.bench.published)
            if (each.port == PointTargetTracker::smoothed_out) past = &each.tracks();
        CHECK((past != nullptr) == (k >= 3));
        if (past == nullptr) continue;
        REQUIRE(past->count == 2);
        for (std::int64_t i = 0; i < 2; ++i) {
            const auto then = static_cast<std::int64_t>(k) - 3;
            CHECK(past->times[i] == then * second);
            CHECK(past->status[i] == PLR_TRACK_CONFIRMED);
            ++told[{past->ids[i], past->times[i]}];
            const double x = pelorus::item(past->mean, i)(0, 0);
            if (k > 5) smoothed += std::pow(x - (past->ids[i] == 1 ? 12.0 * static_cast<double>(then) : 300), 2);
        }
    }
    CHECK(told.size() == 24);  // each once
    for (const auto& [which, times] : told) CHECK(times == 1);
    CHECK(smoothed < filtered);
    Rig plain(with);
    for (const auto& scan : scans) {
        send(plain, scan);
        for (const auto& each : plain.bench.published) CHECK(each.port != PointTargetTracker::smoothed_out);
    }
}
