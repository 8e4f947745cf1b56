#include "starts.hpp"

#include <catch2/catch.hpp>

using namespace group;

namespace {

constexpr std::int64_t second = 1'000'000'000;

/// Single points at a time in s, each of covariance `variance` I.
Centres at(double time, const std::vector<Eigen::Vector3d>& places, double variance = 1) {
    Centres out{static_cast<std::int64_t>(time * second), {}};
    for (std::size_t k = 0; k < places.size(); ++k) {
        Points one;
        one.time = out.time;
        one.dimension = 3;
        one.positions.assign(places[k].data(), places[k].data() + 3);
        const Eigen::Matrix3d noise = variance * Eigen::Matrix3d::Identity();
        one.noise.assign(noise.data(), noise.data() + 9);
        one.ids = {100 * static_cast<std::uint64_t>(time) + k};
        out.centres.push_back(centre_of(one, k));
    }
    return out;
}

Starts of(double maximum_speed, double squared_distance) {
    Starts starts;
    starts.setup({maximum_speed, squared_distance});
    return starts;
}

}  // namespace

TEST_CASE("group starts: three centres on a line begin a group at the third", "[tracker.group]") {
    Starts starts = of(100, 11.345);
    CHECK(starts.take(at(0, {{0, 0, 0}})).empty());
    CHECK(starts.take(at(1, {{10, 0, 0}})).empty());
    const auto begun = starts.take(at(2, {{20, 1, 0}}));
    REQUIRE(begun.size() == 1);
    CHECK((begun[0].velocity - Eigen::Vector3d(10, 0.5, 0)).norm() < 1e-12);
    CHECK(begun[0].half_time == Approx(1));
    CHECK(begun[0].third.points.ids == std::vector<std::uint64_t>{200});
}

TEST_CASE("group starts: the third is tried against R3 + 4 R2 + R1", "[tracker.group]") {
    // With R1, R2, R3 of 1, 4, 9 m2: S = 26 m2 on each axis. 4.9 sqrt(26) m off is within the gate of 24.02, 4.91 sqrt(26) m is not.
    for (const auto& [off, count] : {std::pair{4.9, std::size_t{1}}, std::pair{4.91, std::size_t{0}}}) {
        Starts starts = of(100, 24.02);
        starts.take(at(0, {{0, 0, 0}}, 1));
        starts.take(at(1, {{0, 10, 0}}, 4));
        CHECK(starts.take(at(2, {{off * std::sqrt(26.0), 20, 0}}, 9)).size() == count);
    }
}

TEST_CASE("group starts: with unequal steps the line is followed as long as the second lasts", "[tracker.group]") {
    // Steps of 1 and 3 s: prediction z2 + 3 (z2 - z1), S = R3 + 16 R2 + 9 R1 = 26 m2.
    for (const auto& [off, count] : {std::pair{4.9, std::size_t{1}}, std::pair{4.91, std::size_t{0}}}) {
        Starts starts = of(100, 24.02);
        starts.take(at(0, {{0, 0, 0}}, 1));
        starts.take(at(1, {{0, 10, 0}}, 1));
        const auto begun = starts.take(at(4, {{off * std::sqrt(26.0), 40, 0}}, 1));
        REQUIRE(begun.size() == count);
        if (count == 1) CHECK(begun[0].half_time == Approx(2));
    }
}

TEST_CASE("group starts: nobody is faster than the maximum speed", "[tracker.group]") {
    for (const auto& [speed, count] : {std::pair{100.0, std::size_t{1}}, std::pair{99.9, std::size_t{0}}}) {
        Starts starts = of(speed, 11.345);
        starts.take(at(0, {{0, 0, 0}}));
        starts.take(at(1, {{60, 80, 0}}));
        CHECK(starts.take(at(2, {{120, 160, 0}})).size() == count);
    }
}

TEST_CASE("group starts: the best fit goes first, and a centre serves once", "[tracker.group]") {
    Starts starts = of(100, 11.345);
    starts.take(at(0, {{0, 0, 0}, {0, 3, 0}}));
    starts.take(at(1, {{10, 0, 0}}));
    const auto begun = starts.take(at(2, {{20, 1, 0}, {20, 0.1, 0}}));
    REQUIRE(begun.size() == 1);
    CHECK(begun[0].first.cell == 0);
    CHECK(begun[0].third.cell == 1);
    // What is left, (0, 3), is too old now; the third that was not taken is the second of the next.
    CHECK(starts.take(at(3, {{30, 1, 0}})).empty());
}

TEST_CASE("group starts: a scan without centres ends what had begun", "[tracker.group]") {
    Starts starts = of(100, 11.345);
    starts.take(at(0, {{0, 0, 0}}));
    starts.take(at(1, {{10, 0, 0}}));
    starts.take(at(2, {}));
    CHECK(starts.take(at(3, {{30, 0, 0}})).empty());
    CHECK(starts.take(at(4, {{40, 0, 0}})).empty());
    CHECK(starts.take(at(5, {{50, 0, 0}})).size() == 1);
}
