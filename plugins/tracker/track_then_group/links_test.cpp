#include "links.hpp"

#include <catch2/catch.hpp>
#include <random>

namespace {

using namespace track_then_group;

constexpr std::int64_t second = 1'000'000'000;

/// Two members, so far apart on the x axis and so different in velocity there.
std::vector<Member> two(double distance, double velocity = 0) {
    return {{1, {0, 0, 0}, {0, 0, 0}}, {2, {distance, 0, 0}, {velocity, 0, 0}}};
}

std::vector<IndexPair> brute_force(const std::vector<Member>& members, double distance) {
    std::vector<IndexPair> pairs;
    for (std::size_t i = 0; i < members.size(); ++i)
        for (std::size_t j = i + 1; j < members.size(); ++j) {
            double squares = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const double difference = members[i].position[a] - members[j].position[a];
                squares += difference * difference;
            }
            if (squares < distance * distance) pairs.emplace_back(i, j);
        }
    return pairs;
}

}  // namespace

TEST_CASE("Near pairs are those that a comparison of all with all finds", "[track_then_group]") {
    std::mt19937 random(7);
    const auto draw = [&](double least, double most) { return std::uniform_real_distribution<>(least, most)(random); };
    const auto check = [](const std::vector<Member>& members, double distance) {
        CHECK(near_pairs(members, distance) == brute_force(members, distance));
    };
    std::vector<Member> members;
    check(members, 1);
    SECTION("at random, in one to three dimensions") {
        for (std::size_t axes = 1; axes <= 3; ++axes) {
            members.assign(300, {});
            for (Member& member : members)
                for (std::size_t a = 0; a < axes; ++a) member.position[a] = draw(-50, 50);
            check(members, 5);
        }
    }
    SECTION("on a lattice, where neighbours are exactly at the distance, and twice in one place") {
        for (int x = -4; x <= 4; ++x)
            for (int y = -4; y <= 4; ++y)
                for (int twice = 0; twice < 2; ++twice) members.push_back({0, {1.0 * x, 1.0 * y, 0}, {}});
        check(members, 1);
        check(members, std::nextafter(1.0, 2.0));
    }
    SECTION("all in one ball, and in a range of astronomical size") {
        members.assign(100, {});
        for (Member& member : members) member.position = {draw(0, 1), draw(0, 1), draw(0, 1)};
        check(members, 10);
        for (std::size_t i = 0; i < 50; ++i) members[i].position[2] += 1e20 * static_cast<double>(i);
        check(members, 1);
    }
}

TEST_CASE("A pair links below the threshold and unlinks above it, with hysteresis between", "[track_then_group]") {
    Links links;
    links.setup({100, 0.1, {}, 0});
    const auto linked = [&](double distance) { return links.update(0, two(distance)).size() == 1; };
    CHECK_FALSE(linked(95));
    CHECK(linked(89));
    CHECK(linked(95));
    CHECK(linked(109));
    CHECK_FALSE(linked(111));
    CHECK_FALSE(linked(95));
    CHECK(linked(50));
    CHECK_FALSE(linked(1e6));
}

TEST_CASE("Without hysteresis a pair is linked where it is nearer than the threshold", "[track_then_group]") {
    Links links;
    links.setup({100, 0, {}, 0});
    CHECK(links.update(0, two(std::nextafter(100, 0))).size() == 1);
    CHECK(links.update(0, two(100)).empty());
}

TEST_CASE("Tracks of different velocities do not belong together", "[track_then_group]") {
    Links links;
    links.setup({100, 0.1, 10.0, 0});
    const auto linked = [&](double velocity) { return links.update(0, two(50, velocity)).size() == 1; };
    CHECK_FALSE(linked(9.5));
    CHECK(linked(8.5));
    CHECK(linked(10.5));
    CHECK_FALSE(linked(11.5));
}

TEST_CASE("What is to link or unlink must last", "[track_then_group]") {
    Links links;
    links.setup({100, 0.1, {}, 3 * second});
    const auto linked = [&](std::int64_t time, double distance) {
        return links.update(time * second, two(distance)).size() == 1;
    };
    CHECK_FALSE(linked(0, 50));
    CHECK_FALSE(linked(2, 105));  // near enough to go on waiting
    CHECK(linked(3, 50));
    CHECK(linked(4, 200));
    CHECK(linked(6, 50));  // back in time
    CHECK(linked(7, 200));
    CHECK(linked(9, 200));
    CHECK_FALSE(linked(10, 200));
    CHECK_FALSE(linked(11, 50));
    CHECK_FALSE(linked(12, 200));  // the wait begins anew
    CHECK_FALSE(linked(14, 50));
    CHECK_FALSE(linked(16, 50));
    CHECK(linked(17, 50));
}

TEST_CASE("A member that is away loses its links", "[track_then_group]") {
    Links links;
    links.setup({100, 0.1, {}, 0});
    CHECK(links.update(0, two(50)).size() == 1);
    CHECK(links.update(0, {two(50).front()}).empty());
    CHECK(links.update(0, two(95)).empty());
}

TEST_CASE("Components are chains of links", "[track_then_group]") {
    using Lists = std::vector<std::vector<std::size_t>>;
    CHECK(components(0, {}) == Lists{});
    CHECK(components(3, {}) == Lists{{0}, {1}, {2}});
    CHECK(components(6, {{1, 4}, {3, 4}, {2, 5}}) == Lists{{0}, {1, 3, 4}, {2, 5}});
}
