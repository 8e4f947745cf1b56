#include <random>

#include <catch2/catch.hpp>

#include "group_rig.hpp"

using namespace group;
using pelorus::test::CallFailed;

namespace {

/// Three groups that drift apart, with misses and clutter, made from the scan's number alone.
std::vector<Entry> busy_scan(Rig& rig, int k) {
    std::mt19937 random(static_cast<unsigned>(k) + 100);
    std::uniform_real_distribution<double> area(-500, 500), unit(0, 1);
    std::normal_distribution<double> noise(0, 2);
    std::vector<Place> places;
    for (int object = 0; object < 9; ++object)
        if (unit(random) < 0.8)
            places.push_back({10.0 * k + noise(random), (object - 4) * (20 + 1.0 * k) + noise(random), noise(random)});
    for (int i = 0; i < 3; ++i) places.push_back({10 * k + area(random), area(random), area(random)});
    rig.measurements = static_cast<std::uint64_t>(k) * 100;
    return rig.scan(k, places);
}

bool same(const std::vector<Entry>& a, const std::vector<Entry>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Entry& x, const Entry& y) {
               return x.id == y.id && x.status == y.status && x.misses == y.misses && x.mean == y.mean &&
                      x.covariance == y.covariance && x.extent == y.extent && x.parents == y.parents &&
                      x.measurements == y.measurements;
           });
}

}  // namespace

TEST_CASE("tracker.group goes on bit for bit where its saved state left off", "[tracker.group]") {
    for (const plr_plugin* partitioner : {&Rig::by_distance(), &Rig::about_predictions()}) {
        Rig whole(Rig::slow, partitioner), first(Rig::slow, partitioner), second_half(Rig::slow, partitioner);
        for (int k = 0; k < 25; ++k) {
            busy_scan(whole, k);
            busy_scan(first, k);
        }
        second_half.tracker->load(first.tracker->save());
        bool is_anything = false;
        for (int k = 25; k < 60; ++k) {
            const auto told = busy_scan(whole, k);
            REQUIRE(same(told, busy_scan(second_half, k)));
            is_anything = is_anything || told.size() > 2;
        }
        CHECK(is_anything);
        CHECK(whole.tracker->save() == second_half.tracker->save());
    }
}

TEST_CASE("tracker.group keeps its groups when a state cannot be taken over", "[tracker.group]") {
    Rig rig;
    for (int k = 0; k < 10; ++k) busy_scan(rig, k);
    auto state = rig.tracker->save();
    const auto before = state;
    for (std::size_t cut : {std::size_t{0}, std::size_t{10}, state.size() / 2, state.size() - 1})
        CHECK_THROWS_AS(rig.tracker->load({state.begin(), state.begin() + static_cast<std::ptrdiff_t>(cut)}),
                        CallFailed);
    state[state.size() / 2] ^= 1;
    CHECK_THROWS_AS(rig.tracker->load(state), CallFailed);
    CHECK(rig.tracker->save() == before);
}
