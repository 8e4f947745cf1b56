#include <catch2/catch.hpp>
#include <random>

#include "tracker_rig.hpp"

using namespace point_target;
using pelorus::test::CallFailed;

namespace {

/// What a scan of a busy place gives, made from its number alone.
std::vector<Entry> busy_scan(Rig& rig, int k) {
    std::mt19937 random(static_cast<unsigned>(k) + 100);
    std::uniform_real_distribution<double> area(0, 300), unit(0, 1);
    std::normal_distribution<double> noise;
    std::vector<std::array<double, 2>> places;
    for (int object = 0; object < 8; ++object)
        if (unit(random) < 0.8)
            places.push_back({40.0 * object + 2 * k + noise(random), 30.0 * object - k + noise(random)});
    for (int i = 0; i < 4; ++i) places.push_back({area(random), area(random)});
    rig.measurements = static_cast<std::uint64_t>(k) * 100;
    return rig.scan(k, places);
}

bool same(const std::vector<Entry>& a, const std::vector<Entry>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Entry& x, const Entry& y) {
               return x.id == y.id && x.status == y.status && x.time == y.time && x.x == y.x && x.y == y.y &&
                      x.misses == y.misses && x.measurements == y.measurements;
           });
}

}  // namespace

TEST_CASE("tracker.point_target goes on bit for bit where its saved state left off", "[tracker.point_target]") {
    for (const char* with :
         {"{maximum_speed: 20 m/s, misses_to_delete: 3}", "{maximum_speed: 20 m/s, start: two_point, publish: all}",
          "{maximum_speed: 20 m/s, misses: by_time, silence: 4 s, maximum_deviation: 6 m}",
          "{maximum_speed: 20 m/s, association: joint, detection_probability: 0.8}"}) {
        Rig whole(with), first(with), second(with);
        for (int k = 0; k < 25; ++k) {
            busy_scan(whole, k);
            busy_scan(first, k);
        }
        second.tracker->load(first.tracker->save());
        bool anything = false;
        for (int k = 25; k < 60; ++k) {
            const auto told = busy_scan(whole, k);
            REQUIRE(same(told, busy_scan(second, k)));
            anything = anything || !told.empty();
        }
        CHECK(anything);
        CHECK(whole.tracker->save() == second.tracker->save());
    }
}

TEST_CASE("tracker.point_target keeps its tracks when a state cannot be taken over", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 20 m/s}"), other(Rig::Spherical{}, "{maximum_speed: 20 m/s}");
    for (int k = 0; k < 10; ++k) busy_scan(rig, k);
    auto state = rig.tracker->save();
    try {
        other.tracker->load(state);
        FAIL("taken");
    } catch (const CallFailed& failed) {
        CHECK(failed.status == PLR_E_STATE_VERSION);
        CHECK_THAT(failed.what(), Catch::StartsWith("saved tracks have records of another estimator"));
    }
    const auto before = state;
    for (std::size_t cut : {std::size_t{0}, std::size_t{10}, state.size() / 2, state.size() - 1})
        CHECK_THROWS_AS(rig.tracker->load({state.begin(), state.begin() + static_cast<std::ptrdiff_t>(cut)}),
                        CallFailed);
    state[state.size() / 2] ^= 1;
    CHECK_THROWS_AS(rig.tracker->load(state), CallFailed);
    CHECK(rig.tracker->save() == before);
}

TEST_CASE("tracker.point_target refuses parameters and parts that cannot work", "[tracker.point_target]") {
    CHECK_THROWS_WITH(Rig("{maximum_speed: 20 m/s, start_confirm: 4, start_of: 3}"),
                      Catch::StartsWith("start_confirm: is greater than start_of"));
    CHECK_THROWS_WITH(Rig("{maximum_speed: 20 m/s, misses: by_time}"), Catch::StartsWith("silence: is required with"));
    CHECK_THROWS(Rig("{}"));                                            // maximum_speed is required
    CHECK_THROWS(Rig("{maximum_speed: 20 m/s, gate_probability: 1}"));  // an infinite gate
}

TEST_CASE("tracker.point_target refuses scans of sensors that its estimator does not hold", "[tracker.point_target]") {
    Rig rig("{maximum_speed: 20 m/s}");
    try {
        rig.scan(0, {{0, 0}}, {}, "sonar");
        FAIL("taken");
    } catch (const CallFailed& failed) {
        CHECK(failed.status == PLR_E_DATA);  // the run goes on
        CHECK(std::string(failed.what()) == "a scan of sensor sonar came, which the estimator does not hold");
    }
}

TEST_CASE("tracker.point_target follows objects in range, azimuth and elevation", "[tracker.point_target]") {
    Rig rig(Rig::Spherical{}, "{maximum_speed: 300 m/s, start_confirm: 3}");
    std::vector<Entry> told;
    for (int k = 0; k < 30; ++k) {
        pelorus::ScanBuilder builder(
            "radar", "",
            pelorus::Space(
                {{"range", "m", 0, 0, false}, {"azimuth", "rad", 0, 0, true}, {"elevation", "rad", 0, 0, true}}));
        // One flies past in the west, through azimuth +-180 deg; one stands.
        const double x = -20000, y = 3000 - 200.0 * k, z = 3000;
        const double flying[] = {std::sqrt(x * x + y * y + z * z), std::atan2(y, x), std::atan2(z, std::hypot(x, y))};
        const double standing[] = {8000, 1, 0.1};
        builder.add(static_cast<std::uint64_t>(2 * k), flying);
        builder.add(static_cast<std::uint64_t>(2 * k + 1), standing);
        told = rig.send(builder.message(k * second));
    }
    REQUIRE(told.size() == 2);
    CHECK(told[0].id == 1);
    CHECK(told[0].x == Approx(-20000).margin(30));
    CHECK(told[0].y == Approx(3000 - 200.0 * 29).margin(30));
    CHECK(rig.bench.counters["tracks_started"] == 2);
}

TEST_CASE("tracker.point_target goes on with the other tracks when the models fail for one", "[tracker.point_target]") {
    Rig rig(Rig::Spherical{}, "{maximum_speed: 300 m/s, start_confirm: 2, misses_to_delete: 3}");
    const pelorus::Space space(
        {{"range", "m", 0, 0, false}, {"azimuth", "rad", 0, 0, true}, {"elevation", "rad", 0, 0, true}});
    std::size_t told = 0;
    for (int k = 0; k < 12; ++k) {
        pelorus::ScanBuilder builder("radar", "", space);
        const double here[] = {0, 0, 0}, there[] = {5000, 1, 0.1};  // at the sensor itself no angle can be predicted
        builder.add(static_cast<std::uint64_t>(2 * k), here);
        builder.add(static_cast<std::uint64_t>(2 * k + 1), there);
        const auto entries = rig.send(builder.message(k * second));
        for (const Entry& e : entries) told += e.id == 2 && e.status == PLR_TRACK_CONFIRMED ? 1 : 0;
    }
    CHECK(told == 11);
}
