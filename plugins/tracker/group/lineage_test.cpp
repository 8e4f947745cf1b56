#include "lineage.hpp"

#include <catch2/catch.hpp>

using namespace group;
using Eigen::Vector3d;

namespace {

constexpr std::int64_t second = 1'000'000'000;
using Owners = std::vector<std::vector<std::uint64_t>>;
using Ids = std::vector<std::uint64_t>;

Points points_at(int k, const std::vector<Vector3d>& places) {
    Points points;
    points.time = k * second;
    points.dimension = 3;
    const Eigen::Matrix3d noise = Eigen::Matrix3d::Identity();
    for (const Vector3d& place : places) {
        points.positions.insert(points.positions.end(), place.data(), place.data() + 3);
        points.noise.insert(points.noise.end(), noise.data(), noise.data() + 9);
        points.ids.push_back(points.ids.size() + 1);
    }
    return points;
}

/// Three scans from k on of points that move by 10 m a second along x.
Start moving(int k, const std::vector<Vector3d>& first) {
    const auto then = [&](int later) {
        std::vector<Vector3d> places = first;
        for (Vector3d& place : places) place.x() += 10.0 * later;
        return centre_of(points_at(k + later, places), 0);
    };
    return {then(0), then(1), then(2), Vector3d(10, 0, 0), 1};
}

}  // namespace

TEST_CASE("group lineage: a group comes from those whose members its members were", "[tracker.group]") {
    Lineage lineage;
    lineage.setup(11.345);
    lineage.see({points_at(0, {{0, 0, 0}, {0, 50, 0}, {0, 100, 0}}), {{7}, {7}, {9}}});
    lineage.see({points_at(1, {{10, 0, 0}, {10, 50, 0}, {10, 100, 0}}), Owners(3)});
    lineage.see({points_at(2, {{20, 0, 0}}), {{7}}});
    CHECK(lineage.parents_of(moving(1, {{10, 50, 0}})) == Ids{7});
    CHECK(lineage.parents_of(moving(1, {{10, 51, 0}, {10, 99, 0}})) == Ids{7, 9});
    CHECK(lineage.parents_of(moving(1, {{10, 70, 0}})).empty());  // near nothing that was there before
    CHECK(lineage.parents_of(moving(2, {{20, 50, 0}})).empty());  // near what nobody had
    CHECK(lineage.parents_of(moving(0, {{0, 0, 0}})).empty());    // nothing is known from before
}

TEST_CASE("group lineage: scans of several sensors at one time do not displace the scan before a start",
          "[tracker.group]") {
    Lineage lineage;
    lineage.setup(11.345);
    lineage.see({points_at(0, {{0, 0, 0}}), {{7}}});
    for (int k = 1; k < 3; ++k)
        for (int sensor = 0; sensor < 3; ++sensor) lineage.see({points_at(k, {{10.0 * k, 0, 0}}), Owners(1)});
    CHECK(lineage.parents_of(moving(1, {{10, 0, 0}})) == Ids{7});
    lineage.see({points_at(3, {{30, 0, 0}}), Owners(1)});  // no start reaches so far back any more
    CHECK(lineage.parents_of(moving(1, {{10, 0, 0}})).empty());
}

TEST_CASE("group lineage: a point of two groups leads to both", "[tracker.group]") {
    Lineage lineage;
    lineage.setup(11.345);
    lineage.see({points_at(0, {{0, 0, 0}}), {{3, 5}}});
    CHECK(lineage.parents_of(moving(1, {{10, 0, 0}})) == Ids{3, 5});
}

TEST_CASE("group lineage: how near a point must be grows with what is not known of the velocity", "[tracker.group]") {
    // Carried back one of two seconds: S = (1.5^2 + 0.5^2 + 1) I = 3.5 m2.
    Lineage lineage;
    lineage.setup(4.0);
    lineage.see({points_at(0, {{0, 0, 0}}), {{3}}});
    CHECK(lineage.parents_of(moving(1, {{10, 1.99 * std::sqrt(3.5), 0}})) == Ids{3});
    CHECK(lineage.parents_of(moving(1, {{10, 2.01 * std::sqrt(3.5), 0}})).empty());
}

TEST_CASE("group lineage: the nearest owned point within the gate tells who took it", "[tracker.group]") {
    const Sighting sighting{points_at(0, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), {{}, {4}, {2, 6}}};
    CHECK(owner_of_nearest(sighting, {1, 3, 2}, 10) == 2);
    CHECK(owner_of_nearest(sighting, {1, 3, 4}, 10) == 4);
    CHECK(owner_of_nearest(sighting, {1, 30, 40}, 10) == 0);
}
