// Tracks that begin with two or three points.
#include <catch2/catch.hpp>

#include "tracker_rig.hpp"

namespace {

using namespace point_target;
using namespace pelorus::test;

const std::string by_three = "{maximum_speed: 40 m/s, start: three_point, start_confirm: 3, start_of: 3, publish: all}";

/// Two objects of 20 m/s, one 15 m behind the other: the point behind is always nearer than the own one.
std::vector<std::array<double, 2>> in_line(double time) { return {{20 * time, 0}, {20 * time - 15, 0}}; }

/// tracker.point_target in space with gravity, told a fall without errors.
std::vector<double> second_state_of_fall(const char* start, int scans, double period) {
    Bench bench;
    const auto make = [&](const char* id, const char* with, std::vector<Instance::Part> parts = {}) {
        return std::make_shared<Instance>(bench, installed(id), with, std::move(parts));
    };
    const auto estimator = make("estimator.kalman", "{}",
                                {{"motion", "", make("motion.ballistic", "{axes: flat, acceleration: 0.01 m/s2}")},
                                 {"sensors", "radar", make("sensor.position", "{noise: 1 m}")}});
    StageUnderTest tracker(bench, plugin_of<PointTargetTracker>("tracker.point_target"),
                           "{maximum_speed: 2 km/s, start_of: 3, start: " + std::string(start) +
                               ", start_confirm: " + std::to_string(scans) + "}",
                           std::vector<Instance::Part>{{"estimator", "", estimator}});
    for (int k = 0; k < scans; ++k) {
        const double t = period * k, z[3] = {100 * t, 0, 1000 - 9.80665 * t * t / 2};
        pelorus::ScanBuilder scan("radar", "", pelorus::position_space(3));
        scan.add(static_cast<std::uint64_t>(k + 1), z);
        bench.published.clear();
        tracker.receive(PointTargetTracker::scans, scan.message(Rig::ns(t)));
    }
    const plr_tracks& tracks = bench.published.at(0).tracks();
    REQUIRE(tracks.count == 1);
    return {tracks.mean.data, tracks.mean.data + 6};
}

}  // namespace

TEST_CASE("Objects in line begin with three points, each with its own", "[point_target]") {
    Rig rig(by_three);
    CHECK(rig.scan(0, in_line(0)).empty());
    CHECK(rig.scan(1, in_line(1)).empty());
    const std::vector<Entry> begun = rig.scan(2, in_line(2));
    REQUIRE(begun.size() == 2);
    for (double time = 3; time < 8; ++time) {
        const std::vector<Entry> entries = rig.scan(time, in_line(time));
        REQUIRE(entries.size() == 2);
        for (const std::size_t i : {0u, 1u}) {
            CHECK(entries[i].id == begun[i].id);
            CHECK(entries[i].status == PLR_TRACK_CONFIRMED);
            CHECK(std::min(std::abs(entries[i].x - 20 * time), std::abs(entries[i].x - 20 * time + 15)) < 0.1);
        }
        CHECK(std::abs(entries[0].x - entries[1].x) == Approx(15).margin(0.2));
    }
}

TEST_CASE("Points that no third one confirms begin nothing", "[point_target]") {
    Rig rig(by_three);
    for (int k = 0; k < 20; ++k) CHECK(rig.scan(k, {{k % 2 == 0 ? 0.0 : 30.0, 10.0 * (k % 3)}}).empty());
}

TEST_CASE("A detection that a hypothesis has taken begins nothing else", "[point_target]") {
    Rig rig("{maximum_speed: 40 m/s, start: three_point, start_confirm: 3, start_of: 5, publish: all}");
    std::size_t most = 0;
    for (int k = 0; k < 20; ++k) most = std::max(most, rig.scan(k, in_line(k)).size());
    CHECK(most == 2);
}

TEST_CASE("A start from points has the velocity at the newest one", "[point_target]") {
    for (const double period : {1.0, 10.0}) {
        const std::vector<double> two = second_state_of_fall("two_point", 2, period);
        CHECK(two[2] == Approx(1000 - 9.80665 * period * period / 2));
        CHECK(two[3] == Approx(100));
        CHECK(two[5] == Approx(-9.80665 * period));
        const std::vector<double> three = second_state_of_fall("three_point", 3, period);
        CHECK(three[2] == Approx(1000 - 9.80665 * period * period * 2));
        CHECK(three[5] == Approx(-9.80665 * period * 2));
    }
}

TEST_CASE("Hypotheses that were saved go on as they would have", "[point_target]") {
    Rig rig(by_three), resumed(by_three);
    rig.scan(0, in_line(0));
    rig.scan(1, in_line(1));
    resumed.tracker->load(rig.tracker->save());
    resumed.measurements = rig.measurements;
    for (double time = 2; time < 6; ++time) {
        const std::vector<Entry> expected = rig.scan(time, in_line(time)), got = resumed.scan(time, in_line(time));
        REQUIRE(got.size() == expected.size());
        for (std::size_t i = 0; i < got.size(); ++i) {
            CHECK(got[i].id == expected[i].id);
            CHECK(got[i].x == expected[i].x);
        }
    }
}

TEST_CASE("Three points are refused where they decide nothing", "[point_target]") {
    CHECK_THROWS_WITH(Rig("{maximum_speed: 40 m/s, start: three_point, start_confirm: 2}"),
                      Catch::Contains("start_confirm: is less than 3, which start: three_point needs"));
    CHECK_THROWS_WITH(Rig("{maximum_speed: 40 m/s, start: three_point, misses: by_time, silence: 10 s}"),
                      Catch::Contains("start: three_point needs scans that show every object"));
}
