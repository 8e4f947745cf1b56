#include <catch2/catch.hpp>

#include "grouping_rig.hpp"

namespace {

using namespace track_then_group;

auto near(const std::vector<double>& numbers) { return Catch::Matchers::Approx(numbers); }

}  // namespace

TEST_CASE("Tracks are passed on as they are, with the ids of their groups", "[track_then_group]") {
    GroupingRig rig("{threshold: 100 m}");
    TrackAt first{5, 10, 20, 1, 2};
    first.parents = {3, 4};
    first.measurements = {77, 78};
    const auto answer = rig.send(1, {first, {6, 50, 20}, {9, 500, 0}});
    REQUIRE(answer.tracks.size() == 3);
    CHECK(answer.track_groups() == Ids{1, 1, 2});
    CHECK(answer.tracks[0].id == 5);
    CHECK(answer.tracks[0].mean == std::vector<double>{10, 20, 1, 2});
    CHECK(answer.tracks[0].parents == Ids{3, 4});
    CHECK(answer.tracks[0].measurements == Ids{77, 78});
}

TEST_CASE("A group is told with centre, its covariance and an ellipse of the members' second moments",
          "[track_then_group]") {
    GroupingRig rig("{threshold: 100 m, member_radius: 3 m}");
    TrackAt left{1, -30, 5, 2, 0}, right{2, 30, 5, 4, 2};
    left.measurements = {11};
    right.measurements = {12, 13};
    const auto answer = rig.send(1, {left, right, {3, 1000, 0}});
    REQUIRE(answer.groups.size() == 2);
    const Entry& pair = answer.groups[0];
    CHECK(pair.id == 1);
    CHECK(pair.status == PLR_TRACK_CONFIRMED);
    CHECK(pair.measurements == Ids{11, 12, 13});
    CHECK_THAT(pair.mean, near({0, 5, 3, 1}));
    // The mean of two independent errors has half the variance.
    CHECK_THAT(pair.covariance, near({2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5}));
    // Scatter 30^2 along x; an even ellipse of half axis a has the variance a^2/4.
    CHECK_THAT(pair.extent, near({4 * 900 + 9, 0, 0, 9}));
    CHECK_THAT(answer.groups[1].extent, near({9, 0, 0, 9}));
}

TEST_CASE("A split and a merger are told by the parents of groups", "[track_then_group]") {
    GroupingRig rig("{threshold: 100 m}");
    const auto with_third_at = [&](double time, double x) {
        return rig.send(time, {{1, 0, 0}, {2, 10, 0}, {3, x, 0}});
    };
    CHECK(with_third_at(1, 20).track_groups() == Ids{1, 1, 1});
    CHECK(with_third_at(2, 115).track_groups() == Ids{1, 1, 1});
    const auto split = with_third_at(3, 121);
    CHECK(split.track_groups() == Ids{1, 1, 2});
    REQUIRE(split.groups.size() == 2);
    CHECK(split.groups[0].parents.empty());
    CHECK(split.groups[1].parents == Ids{1});
    const auto merged = with_third_at(4, 90);
    CHECK(merged.track_groups() == Ids{1, 1, 1});
    REQUIRE(merged.groups.size() == 1);
    CHECK(merged.groups[0].parents == Ids{2});
    const auto apart = with_third_at(5, 130);
    CHECK(apart.track_groups() == Ids{1, 1, 2});
    CHECK(apart.groups[1].parents == Ids{1});
}

TEST_CASE("Attempts are in no group, and tracks that end are told in theirs", "[track_then_group]") {
    GroupingRig rig("{threshold: 100 m}");
    CHECK(rig.send(1, {{1, 0, 0}, {2, 10, 0, 0, 0, PLR_TRACK_TENTATIVE}}).track_groups() == Ids{1, 0});
    const auto coasting = rig.send(2, {{1, 0, 0, 0, 0, PLR_TRACK_COASTING}, {2, 10, 0, 0, 0, PLR_TRACK_COASTING}});
    CHECK(coasting.track_groups() == Ids{1, 1});
    CHECK(coasting.groups.at(0).status == PLR_TRACK_COASTING);
    const auto one_left = rig.send(3, {{1, 0, 0, 0, 0, PLR_TRACK_DELETED}, {2, 10, 0}});
    CHECK(one_left.track_groups() == Ids{1, 1});
    CHECK_THAT(one_left.groups.at(0).mean, near({10, 0, 0, 0}));
    const auto none_left = rig.send(4, {{2, 10, 0, 0, 0, PLR_TRACK_DELETED}});
    CHECK(none_left.track_groups() == Ids{1});
    REQUIRE(none_left.groups.size() == 1);
    CHECK(none_left.groups[0].status == PLR_TRACK_DELETED);
    CHECK(rig.send(5, {}).groups.empty());
}

TEST_CASE("Tracks told at different times meet at the newest one, along their velocities", "[track_then_group]") {
    GroupingRig rig("{threshold: 100 m}");
    TrackAt old{1, 0, 0, 10, 0};
    old.age = 20;
    const auto answer = rig.send(30, {old, {2, 230, 0, 10, 0}});
    CHECK(answer.track_groups() == Ids{1, 1});
    CHECK_THAT(answer.groups.at(0).mean, near({215, 0, 10, 0}));
    // The same by two messages.
    GroupingRig other("{threshold: 100 m}");
    other.send(10, {{1, 0, 0, 10, 0}});
    CHECK(other.send(30, {{2, 230, 0, 10, 0}}).track_groups() == Ids{1});
}

TEST_CASE("A group is told when a member is, or when it has other members", "[track_then_group]") {
    GroupingRig rig("{threshold: 100 m}");
    rig.send(1, {{1, 0, 0}, {2, 10, 0}, {3, 1000, 0}, {4, 1010, 0}});
    const auto first = rig.send(2, {{1, 0, 0}});
    REQUIRE(first.groups.size() == 1);
    CHECK(first.groups[0].id == 1);
    const auto moved = rig.send(3, {{2, 1005, 0}});
    REQUIRE(moved.groups.size() == 2);
    CHECK_THAT(moved.groups[1].mean, near({1005, 0, 0, 0}));
    CHECK(moved.groups[1].parents == Ids{1});
}

TEST_CASE("Vessels that move together are a convoy, those at their berths are not", "[track_then_group]") {
    GroupingRig rig("{threshold: 500 m, velocity_threshold: 2 m/s, minimum_speed: 2 m/s, persistence: 60 s}");
    const auto at = [&](double time) {
        return rig.send(time, {{1, 8 * time, 0, 8, 0},
                               {2, 8.5 * time, 300, 8.5, 0},
                               {3, 4000 - 8 * time, 100, -8, 0},  // meets both at 250 s
                               {4, 2000, 50, 0.1, 0},             // moored
                               {5, 2000, 60, 0, 0.1}});
    };
    CHECK(at(0).track_groups() == Ids{1, 2, 3, 0, 0});
    CHECK(at(50).track_groups() == Ids{1, 2, 3, 0, 0});
    CHECK(at(60).track_groups() == Ids{1, 1, 3, 0, 0});
    for (double time = 70; time <= 400; time += 10) CHECK(at(time).track_groups() == Ids{1, 1, 3, 0, 0});
}

TEST_CASE("What comes late changes no group", "[track_then_group]") {
    GroupingRig rig("{threshold: 100 m}");
    rig.send(10, {{1, 0, 0}, {2, 50, 0}});
    CHECK(rig.send(5, {{2, 5000, 0}}).track_groups() == Ids{1});
    CHECK(rig.send(11, {{1, 0, 0}}).track_groups() == Ids{1});
}

TEST_CASE("Tracks without a velocity are refused where velocities are asked for", "[track_then_group]") {
    GroupingRig rig("{threshold: 100 m, minimum_speed: 1 m/s}");
    pelorus::TracksBuilder builder("", pelorus::position_space(2));
    const double mean[] = {0, 0}, covariance[] = {1, 0, 0, 1};
    builder.add({1, 0, PLR_TRACK_CONFIRMED, 0, mean, covariance, nullptr, {}, 0, {}, {}});
    CHECK_THROWS_WITH(rig.send(builder.message(0)), Catch::Contains("tracks tell no velocity"));
}

TEST_CASE("Groups that were saved go on as they would have", "[track_then_group]") {
    const std::string with = "{threshold: 100 m, persistence: 2 s, minimum_speed: 0.5 m/s}";
    GroupingRig rig(with);
    const auto feed = [](GroupingRig& to, int k) {
        return to.send(k, {{1, 0, 0, 1, 0}, {2, 50 + 20 * std::sin(k), 0, 1, 0}, {3, 140 + 60 * std::sin(k), 0, 1, 0}});
    };
    for (int k = 0; k < 7; ++k) feed(rig, k);
    GroupingRig resumed(with);
    resumed.tracker.load(rig.tracker.save());
    for (int k = 7; k < 30; ++k) {
        const auto expected = feed(rig, k), got = feed(resumed, k);
        CHECK(got.track_groups() == expected.track_groups());
        REQUIRE(got.groups.size() == expected.groups.size());
        for (std::size_t i = 0; i < got.groups.size(); ++i) {
            CHECK(got.groups[i].mean == expected.groups[i].mean);
            CHECK(got.groups[i].parents == expected.groups[i].parents);
        }
    }
    CHECK(rig.tracker.save() == resumed.tracker.save());
}
