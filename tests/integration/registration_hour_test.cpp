// An hour of data of a stream that is not tidy, through each stage of registration in time.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include <pelorus/pelorus.hpp>

#include "../fixtures/stage_bench.hpp"

using namespace pelorus::test;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::int64_t second = 1'000'000'000;

/// A frame of the fast sensor or a scan of the slow one.
struct Look {
    bool is_fast;
    std::int64_t time, arrival;
};

/// 20 frames a second about their ticks, 0.1 to 0.4 s late, a fifth of them lost, one in fifty twice, a minute away every quarter of an
/// hour; the other sensor every 2 s, up to 0.2 s late.
std::vector<Look> hour() {
    std::mt19937_64 random(7);
    const auto uniform = [&](double from, double to) {
        return from + (to - from) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    const auto ns = [](double seconds) { return std::llround(seconds * 1e9); };
    std::vector<Look> looks;
    for (int i = 1; i <= 72000; ++i) {
        const std::int64_t time = i * (second / 20) + ns(uniform(-0.01, 0.01));
        const std::int64_t arrival = time + ns(uniform(0.1, 0.4));
        if (uniform(0, 1) < 0.2 || i % 18000 > 16800) continue;
        looks.push_back({true, time, arrival});
        if (uniform(0, 1) < 0.02) looks.push_back({true, time, arrival + ns(0.02)});
    }
    for (int k = 1; k <= 1800; ++k) looks.push_back({false, 2 * k * second, 2 * k * second + ns(uniform(0, 0.2))});
    std::stable_sort(looks.begin(), looks.end(),
                     [](const Look& one, const Look& other) { return one.arrival < other.arrival; });
    return looks;
}

/// What the fast sensor sees without noise: two components, the second an angle that goes round.
VectorXd seen(std::int64_t time) {
    const double t = static_cast<double>(time) * 1e-9, pi = std::acos(-1.0);
    return Eigen::Vector2d(5000 - 0.5 * t, std::remainder(0.01 * t, 2 * pi));
}

struct Outcome {
    std::vector<Published> published;
    std::vector<std::size_t> state;  ///< bytes, every 7.3 s: at all phases of the slow sensor
    std::map<std::string, std::int64_t> counters;
};

Outcome play(const std::string& id, const std::string& with) {
    Bench bench;
    StageUnderTest stage(bench, installed(id), with);
    const pelorus::Space space({{"range", "m"}, {"azimuth", "rad", 0, 0, true}});
    const MatrixXd covariance = Eigen::Vector2d(25, 1e-10).asDiagonal();
    Outcome outcome;
    std::uint64_t next_id = 1;
    std::int64_t next_save = 0;
    for (const Look& look : hour()) {
        pelorus::ScanBuilder scan(look.is_fast ? "eo" : "radar", "", space);
        scan.add(next_id++, seen(look.time).data(), covariance.data());
        stage.receive(0, scan.message(look.time), look.arrival);
        if (look.arrival < next_save) continue;
        outcome.state.push_back(stage.save().size());
        next_save += 73 * (second / 10);
    }
    stage.finish(3601 * second);
    outcome.published = bench.published;
    outcome.counters = bench.counters;
    return outcome;
}

/// The largest errors of what is told of the fast sensor in [from, to] s, in standard deviations of one frame.
double largest_error(const Outcome& outcome, double from, double to) {
    double largest = 0;
    for (const Published& each : outcome.published) {
        const double t = static_cast<double>(each.message->time) * 1e-9;
        if (std::string(each.scan().sensor) != "eo" || t < from || t > to) continue;
        const VectorXd error = pelorus::item(each.scan().measurements, 0) - seen(each.message->time);
        largest =
            std::max({largest, std::abs(error(0)) / 5, std::abs(std::remainder(error(1), 2 * std::acos(-1.0))) / 1e-5});
    }
    return largest;
}

std::size_t told(const Outcome& outcome, const std::string& sensor) {
    return static_cast<std::size_t>(std::count_if(outcome.published.begin(), outcome.published.end(),
                                                  [&](const Published& each) { return sensor == each.scan().sensor; }));
}

bool same_bytes(const plr_scan& one, const plr_scan& other) {
    return std::string(one.sensor) == other.sensor && one.ids[0] == other.ids[0] &&
           std::memcmp(one.measurements.data, other.measurements.data, 2 * sizeof(double)) == 0 &&
           std::memcmp(one.covariances.data, other.covariances.data, 4 * sizeof(double)) == 0;
}

}  // namespace

TEST_CASE(
    "An hour of untidy data goes through registration in time in bounded memory, without drift, and alike twice") {
    struct Case {
        const char *id, *with;
        std::size_t estimates;
    };
    // Four minutes of the hour are without frames: 120 times of the radar, 480 blocks.
    const auto [id, with, estimates] =
        GENERATE(Case{"registration.least_squares", "{sensor: eo, onto: radar, lateness: 0.5 s}", 1680},
                 Case{"registration.block_mean", "{sensor: eo, lateness: 0.5 s}", 6720},
                 Case{"registration.interpolate", "{sensor: eo, onto: radar, lateness: 0.5 s}", 1680});
    CAPTURE(id);
    const Outcome outcome = play(id, with), again = play(id, with);

    // All that a stage keeps is in its state: 3 s of frames at most, 16 a second of less than 100 bytes.
    REQUIRE(outcome.state.size() > 490);
    CHECK(*std::max_element(outcome.state.begin(), outcome.state.end()) < 6000);

    CHECK(told(outcome, "radar") == 1800);
    CHECK(std::abs(static_cast<double>(told(outcome, "eo")) - static_cast<double>(estimates)) <= 8);
    CHECK(largest_error(outcome, 0, 600) < 1e-6);
    CHECK(largest_error(outcome, 3000, 3600) < 1e-6);
    CHECK(outcome.counters.at("duplicates") > 1000);
    CHECK(outcome.counters.at("out_of_order") > 10000);
    CHECK(outcome.counters.count("late") == 0);

    std::int64_t last = 0;
    for (const Published& each : outcome.published) {
        CHECK_FALSE(each.message->time < last);  // all leaves in the order of stamps
        last = each.message->time;
    }
    REQUIRE(again.published.size() == outcome.published.size());
    for (std::size_t i = 0; i < again.published.size(); ++i)
        if (!same_bytes(again.published[i].scan(), outcome.published[i].scan())) FAIL("message " << i << " differs");
}
