#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "tracker_rig.hpp"

using namespace point_target;
using Places = std::vector<std::array<double, 2>>;

TEST_CASE("tracker.point_target confirms a track by M of N and tells it from then on", "[tracker.point_target]") {
    for (const char* start : {"one_point", "two_point"}) {
        Rig rig(std::string("{maximum_speed: 20 m/s, start_confirm: 3, start_of: 4, start: ") + start + "}");
        CHECK(rig.scan(0, {{0, 0}}).empty());
        CHECK(rig.scan(1, {{10, 0}}).empty());
        CHECK(rig.scan(2, {}).empty());  // one may be missing
        const auto told = rig.scan(3, {{30, 0}});
        REQUIRE(told.size() == 1);
        CHECK(told[0].status == PLR_TRACK_CONFIRMED);
        CHECK(told[0].x == Approx(30).margin(1));
        CHECK(told[0].time == 3 * second);
        CHECK(told[0].measurements == std::vector<std::uint64_t>{3});
        CHECK(rig.bench.counters["tracks_started"] == 1);
    }
}

TEST_CASE("tracker.point_target drops a start that cannot reach M of N any more", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 20 m/s, start_confirm: 3, start_of: 4}");
    rig.scan(0, {{0, 0}});
    rig.scan(1, {});
    rig.scan(2, {});        // one of three is left, two are needed
    rig.scan(3, {{0, 0}});  // so this is a new start
    rig.scan(4, {{0, 0}});
    CHECK(rig.bench.counters["tracks_started"] == 2);
    CHECK(rig.scan(5, {{0, 0}}).at(0).id == 2);
}

TEST_CASE("tracker.point_target coasts, comes back, and ends after misses in a row", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, start_confirm: 2, misses_to_delete: 3}");
    for (int k = 0; k < 20; ++k) rig.scan(k, {{10.0 * k, 5}});
    auto told = rig.scan(20, {});
    REQUIRE(told.size() == 1);
    CHECK(told[0].status == PLR_TRACK_COASTING);
    CHECK(told[0].misses == 1);
    CHECK(told[0].time == 20 * second);
    CHECK(told[0].x == Approx(200).margin(1));  // moved on
    CHECK(told[0].measurements.empty());
    CHECK(rig.scan(21, {}).empty());  // nothing has changed
    told = rig.scan(22, {{220, 5}});
    CHECK(told.at(0).status == PLR_TRACK_CONFIRMED);
    CHECK(told.at(0).misses == 0);
    CHECK(told.at(0).id == 1);
    rig.scan(23, {});
    rig.scan(24, {});
    told = rig.scan(25, {});
    REQUIRE(told.size() == 1);
    CHECK(told[0].status == PLR_TRACK_DELETED);
    CHECK(told[0].x == Approx(250).margin(2));
    CHECK(rig.scan(26, {}).empty());  // told once
    rig.scan(27, {{270, 5}});
    CHECK(rig.scan(28, {{280, 5}}).at(0).id == 2);  // ids are not used again
}

TEST_CASE("tracker.point_target ends tracks that have become too uncertain, or silent", "[tracker.point_target]") {
    Rig uncertain("{maximum_speed: 30 m/s, start_confirm: 2, misses_to_delete: 1000, maximum_deviation: 10 m}");
    Rig silent("{maximum_speed: 30 m/s, start_confirm: 2, misses_to_delete: 1000, silence: 7 s}");
    for (Rig* rig : {&uncertain, &silent}) {
        for (int k = 0; k < 20; ++k) rig->scan(k, {{0, 0}});
        int last = 20;
        while (last < 200) {
            const auto told = rig->scan(last, {});
            if (!told.empty() && told[0].status == PLR_TRACK_DELETED) break;
            ++last;
        }
        if (rig == &silent)
            CHECK(last == 27);
        else
            CHECK((last > 25 && last < 60));
    }
}

TEST_CASE("tracker.point_target does not count other objects' reports as misses when they report by themselves",
          "[tracker.point_target]") {
    Rig rig("{maximum_speed: 10 m/s, start_confirm: 2, misses: by_time, silence: 400 s}",
            "{dimension: 2, noise: 1e-6 m2/s3, prior_velocity: 1 m/s}");
    std::map<std::uint64_t, int> told;
    // One object reports every 2 s, one every 3 min, each in a scan of its own.
    for (int k = 0; k < 900; ++k) {
        for (const Entry& e : rig.scan(2.0 * k, {{2.0 * k, 0}})) ++told[e.id];
        if (k % 90 == 45)
            for (const Entry& e : rig.scan(2.0 * k + 1, {{5000, 5000}})) ++told[e.id];
    }
    REQUIRE(told.size() == 2);
    CHECK(told[1] == 899);
    CHECK(told[2] == 9);
    const auto end = rig.scan(1711 + 401, {{2112, 0}});
    REQUIRE(end.size() == 2);
    CHECK(end[1].status == PLR_TRACK_DELETED);
    CHECK(end[1].time == 1711 * second);  // where it was seen last
}

TEST_CASE("tracker.point_target keeps crossing objects apart", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, start_confirm: 3}");
    std::mt19937 random(7);
    std::normal_distribution<double> noise;
    std::map<std::uint64_t, std::set<int>> who;
    for (int k = 0; k < 60; ++k) {
        Places places;
        for (int object = 0; object < 5; ++object) {
            const double angle = object * 1.2566370614359172, s = (k - 30) * 12.0;  // all meet at the origin at k = 30
            places.push_back({s * std::cos(angle) + 8 * object + noise(random), s * std::sin(angle) + noise(random)});
        }
        for (const Entry& e : rig.scan(k, places))
            for (const std::uint64_t m : e.measurements) who[e.id].insert(static_cast<int>((m - 1) % 5));
    }
    CHECK(who.size() == 5);
    for (const auto& [id, objects] : who) CHECK(objects.size() == 1);
}

TEST_CASE("tracker.point_target lets confirmed tracks choose before false alarms' tracks do",
          "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, start_confirm: 5, start_of: 6}");
    for (int k = 0; k < 10; ++k) rig.scan(k, {{0, 0}});
    rig.scan(10, {{0, 0}, {3, 0}});              // a false alarm beside it
    const auto told = rig.scan(11, {{2.5, 0}});  // nearer to the false alarm's start
    REQUIRE(told.size() == 1);
    CHECK(told[0].id == 1);
    CHECK(told[0].status == PLR_TRACK_CONFIRMED);
}

TEST_CASE("tracker.point_target believes in no object beyond the maximum speed", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 20 m/s, start_confirm: 2}", "{dimension: 2, noise: 100 m2/s3, prior_velocity: 500 m/s}");
    rig.scan(0, {{0, 0}});
    CHECK(rig.scan(1, {{100, 0}}).empty());  // well within 500 m/s
    CHECK(rig.bench.counters["tracks_started"] == 2);
    CHECK(rig.scan(2, {{120, 0}}).size() == 1);
}

TEST_CASE("tracker.point_target starts with the velocity between two points", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 50 m/s, start: two_point, start_confirm: 2}");
    rig.scan(0, {{0, 0}});
    rig.scan(2, {{60, -20}});
    const plr_tracks& tracks = rig.bench.published.at(0).tracks();
    REQUIRE(tracks.count == 1);
    const auto mean = pelorus::item(tracks.mean, 0), covariance = pelorus::item(tracks.covariance, 0);
    CHECK(mean(0, 0) == Approx(60));
    CHECK(mean(1, 0) == Approx(-20));
    CHECK(mean(2, 0) == Approx(30));
    CHECK(mean(3, 0) == Approx(-10));
    CHECK(covariance(0, 0) == Approx(1));
    CHECK(covariance(0, 2) == Approx(0.5));
    CHECK(covariance(2, 2) == Approx(0.5));  // (1 + 1) / 2^2
    CHECK(covariance(0, 3) == Approx(0).margin(1e-12));
}

TEST_CASE("tracker.point_target pairs each point with the right second one", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 50 m/s, start: two_point, start_confirm: 2}");
    rig.scan(0, {{0, 0}, {30, 0}, {60, 0}});
    const auto told = rig.scan(1, {{61, 1}, {1, 1}, {31, 1}});
    REQUIRE(told.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) CHECK(told[i].x == Approx(30.0 * static_cast<double>(i) + 1));
}

TEST_CASE("tracker.point_target works at the times of the single measurements", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 60 m/s, start_confirm: 2}", "{dimension: 2, noise: 1e-4 m2/s3, prior_velocity: 60 m/s}");
    for (int k = 0; k < 20; ++k) {  // an antenna that sees one object early and one late in each turn
        const double early = 4 * k + 0.5, late = 4 * k + 3.5;
        const auto told = rig.scan(4 * k + 3.9, {{50 * early, 0}, {50 * late, 4000}}, {early, late});
        if (k < 5) continue;
        REQUIRE(told.size() == 2);
        CHECK(told[0].time == Rig::ns(early));
        CHECK(told[0].x == Approx(50 * early).margin(0.5));
        CHECK(told[1].time == Rig::ns(late));
        CHECK(told[1].x == Approx(50 * late).margin(0.5));
    }
    const auto missed = rig.scan(83.9, {{50 * 80.5, 0}}, {80.5});
    REQUIRE(missed.size() == 2);
    CHECK(missed[1].status == PLR_TRACK_COASTING);
    CHECK(missed[1].time == Rig::ns(83.9));
    CHECK(missed[1].x == Approx(50 * 83.9).margin(1));
}

TEST_CASE("tracker.point_target takes late measurements only where they still help", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, start_confirm: 2, misses: by_time, silence: 100 s}");
    for (int k = 0; k < 5; ++k) rig.scan(10 * k, {{0, 0}});
    rig.scan(45, {{500, 500}});
    CHECK(rig.scan(42, {{0, 0}}).size() == 1);  // newer than the track it belongs to
    CHECK(rig.scan(30, {{0, 0}}).empty());      // older: left out
    CHECK(rig.scan(31, {{-900, 0}}).empty());   // tells of no new object
    CHECK(rig.bench.counters["late_measurements"] == 2);
    CHECK(rig.bench.counters["tracks_started"] == 2);
}

TEST_CASE("tracker.point_target publishes all tracks and tentative ones on request", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, publish: all, tentative: show, start_confirm: 2}");
    CHECK(rig.scan(0, {{0, 0}, {500, 0}}).size() == 2);
    rig.scan(1, {{0, 0}, {500, 0}});
    for (int k = 2; k < 5; ++k) {
        const auto told = rig.scan(k, {{0, 0}});
        REQUIRE(told.size() == 2);
        CHECK(told[1].status == PLR_TRACK_COASTING);
        CHECK(told[1].time == k * second);
    }
    Rig by_time("{maximum_speed: 30 m/s, publish: all, misses: by_time, silence: 99 s, start_confirm: 2}");
    by_time.scan(0, {{0, 0}, {500, 0}});
    by_time.scan(1, {{0, 0}, {500, 0}});
    const auto told = by_time.scan(2, {{0, 0}});
    REQUIRE(told.size() == 2);
    CHECK(told[1].status == PLR_TRACK_COASTING);
    CHECK(told[1].time == 2 * second);
}

TEST_CASE("tracker.point_target uses the covariances that a scan carries", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 30 m/s, start_confirm: 1}");
    pelorus::ScanBuilder builder("radar", "", pelorus::position_space(2));
    const double place[] = {3, 4}, covariance[] = {25, 5, 5, 16};
    builder.add(1, place, covariance);
    rig.send(builder.message(0));
    const auto told = pelorus::item(rig.bench.published.at(0).tracks().covariance, 0);
    CHECK(told(0, 0) == 25);
    CHECK(told(0, 1) == 5);
    CHECK(told(1, 1) == 16);
}

TEST_CASE("tracker.point_target follows a thousand objects among a thousand false alarms", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 20 m/s, start_confirm: 3, start_of: 4}",
            "{dimension: 2, noise: 0.01 m2/s3, prior_velocity: 7 m/s}");
    std::mt19937 random(11);
    std::uniform_real_distribution<double> area(0, 20000), speed(-10, 10), unit(0, 1);
    std::normal_distribution<double> noise;
    struct Object {
        double x, y, vx, vy;
    };
    std::vector<Object> objects(1000);
    for (Object& o : objects) o = {area(random), area(random), speed(random), speed(random)};
    std::map<std::uint64_t, std::map<std::uint64_t, int>> used;  // by track: of each object
    for (int k = 0; k < 20; ++k) {
        Places places;
        const std::uint64_t first = rig.measurements + 1;
        std::vector<std::uint64_t> seen;
        for (std::size_t i = 0; i < objects.size(); ++i) {
            if (unit(random) > 0.95) continue;
            places.push_back(
                {objects[i].x + objects[i].vx * k + noise(random), objects[i].y + objects[i].vy * k + noise(random)});
            seen.push_back(i);
        }
        for (int i = 0; i < 1000; ++i) places.push_back({area(random), area(random)});
        for (const Entry& e : rig.scan(k, places))
            for (const std::uint64_t m : e.measurements)
                ++used[e.id][m - first < seen.size() ? seen[m - first] : 1000000];
    }
    std::set<std::uint64_t> followed;
    int pure = 0;
    for (const auto& [track, counts] : used)
        for (const auto& [object, count] : counts)
            if (count >= 12 && object < 1000) {
                followed.insert(object);
                pure += counts.size() == 1 ? 1 : 0;
            }
    CHECK(followed.size() > 980);
    CHECK(pure > 950);
}

TEST_CASE("tracker.point_target tells the innovation of each update, not of what a track starts with",
          "[tracker.point_target]") {
    Rig rig("{maximum_speed: 50 m/s, start_confirm: 2, tentative: show}");
    const auto innovations = [&] {
        std::vector<pelorus::Innovation> out;
        for (const auto& published : rig.bench.published)
            if (published.port == PointTargetTracker::innovations_out)
                pelorus::for_each_innovation(*published.message->body.values,
                                             [&](const pelorus::Innovation& one) { out.push_back(one); });
        return out;
    };
    rig.scan(0, {{0, 0}});
    CHECK(innovations().empty());
    rig.scan(1, {{3, 0}, {500, 0}});
    REQUIRE(innovations().size() == 1);
    CHECK(innovations()[0].track == 1);
    CHECK(innovations()[0].time == Rig::ns(1));
    CHECK(innovations()[0].components == 2);
    const plr_tracks& tracks = rig.bench.published.at(0).tracks();
    CHECK(innovations()[0].squared == tracks.measurement_distances[0]);
    CHECK(innovations()[0].squared > 0);
    rig.scan(2, {});
    CHECK(innovations().empty());
}
