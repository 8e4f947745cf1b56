#include "gathering.hpp"

#include <catch2/catch.hpp>

namespace {

using namespace fusion;

constexpr std::int64_t second = 1'000'000'000;

Gathering gathering(double tolerance, double patience, int sensors = 2) {
    GatheringParameters parameters;
    parameters.tolerance = tolerance;
    parameters.patience = patience;
    Gathering out;
    out.setup(parameters, sensors);
    return out;
}
Sight sight(int sensor, std::int64_t time) { return {sensor, time, {}}; }

/// Times in ns, and how many sensors told of each.
using Given = std::vector<std::pair<std::int64_t, std::size_t>>;
Given given(Gathering& from, std::int64_t arrival) {
    Given out;
    while (auto meeting = from.next(arrival)) out.emplace_back(meeting->time, meeting->sights.size());
    return out;
}

}  // namespace

TEST_CASE("gathering: a time is given back as soon as all sensors have told of it", "[fusion]") {
    Gathering all = gathering(0, 10);
    all.add(second, sight(1, second));
    CHECK(given(all, second).empty());
    CHECK(all.has(1, second));
    CHECK_FALSE(all.has(0, second));
    all.add(2 * second, sight(0, second));
    CHECK(given(all, 2 * second) == Given{{second, 2}});
    CHECK(all.is_late(second));
    CHECK_FALSE(all.is_late(second + 1));
}

TEST_CASE("gathering: who does not come is waited for as long as was said, and times keep their order", "[fusion]") {
    Gathering all = gathering(0, 1.5);
    all.add(second, sight(0, second));
    all.add(2 * second, sight(0, 2 * second));
    all.add(2 * second, sight(1, 2 * second));
    CHECK(given(all, 2 * second).empty());  // the later one is whole, the earlier one may still become so
    CHECK(given(all, 5 * second / 2).empty());
    CHECK(given(all, 5 * second / 2 + 1) == Given{{second, 1}, {2 * second, 2}});
}

TEST_CASE("gathering: without patience only what arrives together meets", "[fusion]") {
    Gathering all = gathering(0, 0);
    all.add(second, sight(0, second));
    CHECK(given(all, second).empty());
    CHECK(given(all, second + 1) == Given{{second, 1}});
}

TEST_CASE("gathering: stamps within the tolerance are of one time, that of the first sensor", "[fusion]") {
    Gathering all = gathering(0.01, 0);
    all.add(second, sight(1, second + second / 200));
    all.add(second, sight(0, second));
    CHECK(given(all, second) == Given{{second, 2}});
    all.add(2 * second, sight(0, 2 * second));
    all.add(2 * second, sight(0, 2 * second + second / 200));  // the same sensor: another time
    all.add(2 * second, sight(1, 2 * second + second / 250));  // meets the nearer one
    CHECK(given(all, 3 * second) == Given{{2 * second, 1}, {2 * second + second / 200, 2}});
}

TEST_CASE("gathering: it holds no more than it says, however patient it is", "[fusion]") {
    Gathering all = gathering(0, 1e6);
    std::size_t out = 0;
    for (std::int64_t k = 1; k <= 200; ++k) {
        all.add(k * second, sight(0, k * second));
        out += given(all, k * second).size();
    }
    CHECK(out == 200 - Gathering::most_held);
    std::size_t rest = 0;
    while (all.last()) ++rest;
    CHECK(rest == Gathering::most_held);
}
