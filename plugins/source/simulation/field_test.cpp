// Sensors as they are in the field: clocks that are off, lines that lose and delay. What turns and biases them is tried in
// tests/integration/simulation_field_test.cpp.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "simulation_rig.hpp"
#include "ticks.hpp"

namespace {

using namespace simulation_rig;

Part sensor(const std::string& model, const std::string& with, const std::string& slot) {
    return {"sensors", "eye", part(parts_bench(), "sensor", model, with), slot};
}

std::string refusal(const std::string& model, const std::string& slot, const std::string& with = "{scans: 3}") {
    try {
        const Simulated run(with, {target("a", dot), sensor(model, "{}", slot)});
        return "";
    } catch (const std::exception& problem) {
        return problem.what();
    }
}

}  // namespace

TEST_CASE("simulation: an error that a sensor's model cannot have is refused", "[simulation]") {
    CHECK(refusal("position", "{attitude_error: [0 mrad, 0 mrad, 1 mrad]}") ==
          "sensors: sensor eye has a value for `attitude_error`, but sensor.position has no input of that name");
    CHECK(refusal("bearings", "{attitude_error: 1 mrad}") ==
          "sensors: sensor eye has a value for `attitude_error`, which of sensor.bearings has 3 numbers, not 1");
}

TEST_CASE("simulation: a clock that is fast stamps later, and nothing else changes", "[simulation]") {
    const auto run = [](const std::string& slot) {
        auto out =
            std::make_unique<Simulated>("{scans: 5}", std::vector<Part>{target("a", dot), radar("r", "{}", slot)});
        out->source->run();
        return out;
    };
    const auto right = run("{}"), fast = run("{clock_offset: 20 ms}"), slow = run("{clock_offset: -20 ms}");
    for (std::size_t k = 0; k < 5; ++k) {
        const Seen one = right->seen("r")[k], early = slow->seen("r")[k], late = fast->seen("r")[k];
        CHECK(late.time == one.time + 20'000'000);
        CHECK(early.time == one.time - 20'000'000);
        CHECK(late.arrival == one.time);
        CHECK(late.points == one.points);
    }
    for (const auto& published : fast->bench.published)
        if (published.port == truth) CHECK(published.message->time % second == 0);
}

TEST_CASE("simulation: jitter moves the times of measuring, and stamps and truth tell them", "[simulation]") {
    Simulated run("{scans: 2000}", {target("a", "{start: [0 m, 0 m, 0 m], speed: 100 m/s}"),
                                    radar("r", "{noise: 1e-9 m}", "{jitter: 0.1 s}")});
    run.source->run();
    double sum = 0, squares = 0;
    const auto seen = run.seen("r");
    REQUIRE(seen.size() > 1990);
    for (std::size_t k = 0; k < seen.size(); ++k) {
        const double off = static_cast<double>(seen[k].time) * 1e-9 - static_cast<double>(k);
        CHECK(std::fabs(off) < 0.5);
        CHECK(seen[k].points(0, 0) == Approx(100 * (static_cast<double>(k) + off)).margin(1e-6));
        sum += off;
        squares += off * off;
    }
    CHECK(sum / 2000 == Approx(0).margin(0.01));
    CHECK(std::sqrt(squares / 2000) == Approx(0.1).epsilon(0.05));
    std::vector<std::int64_t> told;
    for (const auto& published : run.bench.published)
        if (published.port == truth) told.push_back(published.message->time);
    CHECK(told == times_of(seen));
}

TEST_CASE("simulation: ticks keep their order and their place in time, however large the jitter", "[simulation]") {
    const simulation::Clock wild(1.0, [](std::uint64_t tick) { return tick % 2 == 0 ? 1e12 : -1e12; });
    CHECK(wild.time(0) == 499'999'999);
    CHECK(wild.time(1) == 500'000'001);
    CHECK(simulation::Clock(1.0, [](std::uint64_t) { return -1e12; }).time(0) == 0);
    CHECK(simulation::Clock(9e9, [](std::uint64_t) { return 1e30; }).time(1) ==
          std::numeric_limits<std::int64_t>::max());
}

TEST_CASE("simulation: in an outage nothing is told, and what comes after it is as without it", "[simulation]") {
    const auto run = [](const std::string& slot) {
        Simulated out("{scans: 20}", {target("a", dot), radar("r", "{}", slot)});
        out.source->run();
        return out.seen("r");
    };
    const auto whole = run("{}"), parts = run("{outage: [3 s, 5 s, 10 s, 10.5 s]}");
    std::vector<Seen> expected;
    for (std::size_t k = 0; k < 20; ++k)
        if (k != 3 && k != 4 && k != 10) expected.push_back(whole[k]);
    REQUIRE(parts.size() == expected.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
        CHECK(parts[k].time == expected[k].time);
        CHECK(parts[k].points == expected[k].points);
    }
    CHECK(refusal("spherical", "{outage: [1 s, 2 s, 3 s]}") ==
          "sensors: outage of sensor eye is in pairs of from and to; the last one has no end");
    CHECK(refusal("spherical", "{outage: [2 s, 2 s]}") == "sensors: outage of sensor eye ends before it begins");
}

TEST_CASE("simulation: delayed scans keep their stamps, and with a wide spread they overtake each other",
          "[simulation]") {
    Simulated run("{scans: 3000}", {target("a", dot), radar("r", "{}", "{delay: 0.5 s, delay_spread: 2 s}")});
    run.source->run();
    const auto seen = run.seen("r");
    REQUIRE(seen.size() == 3000);
    double mean = 0;
    int overtaken = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
        CHECK(seen[k].time == static_cast<std::int64_t>(k) * second);
        const double delay = static_cast<double>(seen[k].arrival - seen[k].time) * 1e-9;
        CHECK(delay >= 0.5);
        CHECK(delay <= 2.5);
        mean += delay / 3000;
        overtaken += k > 0 && seen[k].arrival < seen[k - 1].arrival;
    }
    CHECK(mean == Approx(1.5).epsilon(0.02));
    CHECK(overtaken / 3000.0 == Approx(0.125).epsilon(0.2));  // P(u - v > 1) of two uniform on 0 .. 2
}
