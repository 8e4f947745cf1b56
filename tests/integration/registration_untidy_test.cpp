// Registration in time of streams as they are in the field: frames lost, late, in disorder, at odd rates, by a wrong clock, not at
// all for a while. The scene of Xiang et al., Computer Measurement & Control 31(5), 2023: a radar every 2 s and an electro-optical
// head 20 times a second follow a small drone.
#include <catch2/catch.hpp>
#include <cmath>

#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;

namespace {

using Settings = std::vector<std::string>;

const char* const scene = R"(pelorus: 1
graph:
  world:
    use: source.simulation
    with: {duration: 600 s, period: 2 s, first_scan: 1}
    parts:
      targets:
        drone:
          use: trajectory.legs
          with:
            start: [500 m, 500 m, 600 m]
            velocity: [3 m/s, 5 m/s, 3 m/s]
            legs:
              - {duration: 150 s}
              - {duration: 75 s, turn_rate: -0.5 deg/s}
              - {duration: 65 s, turn_rate: 0.25 deg/s}
              - {duration: 160 s}
              - {duration: 75 s, turn_rate: -0.5 deg/s}
              - {duration: 75 s, turn_rate: 0.25 deg/s}
      sensors:
        radar: {use: sensor.spherical, with: {angle: zenith, noise: [5 m, 3 mrad, 3 mrad]}}
        eo:
          use: sensor.spherical
          with:
            angle: zenith
            noise: [5 m, 10 urad, 10 urad]
            position: [10 m, 5 m, 3 m]
            attitude: [-1 deg, 2 deg, -3 deg]
            period: 50 ms
  time: {use: registration.least_squares, in: {scans: world.scans}, with: {sensor: eo, onto: radar}}
  tracker:
    use: tracker.single_target
    in: {scans: time.scans}
    parts:
      estimator:
        use: estimator.kalman
        parts:
          motion: {use: motion.constant_velocity, with: {noise: 1.6e-4 m2/s3, prior_velocity: 10 m/s}}
          sensors: {radar: {like: world.sensors.radar}, eo: {like: world.sensors.eo}}
  errors: {use: analyzer.tracking_error, in: {tracks: tracker.tracks, truth: world.truth}}
)";

/// Square of the position error at the radar's times, by time.
std::vector<std::pair<double, double>> errors_of(int seed, const Settings& settings) {
    const TemporaryFolder folder;
    std::vector<std::string> words{
        "run", folder.write("scene.yaml", scene), "--out", folder / "out", "--seed", std::to_string(seed)};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    const Ended ended = pelorus_command(words);
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    const auto cell = nlohmann::json::parse(folder.read("out/summary.json")).at("cells").at(0);
    const auto& table = cell.at("tables").at("errors.by_time");
    std::vector<std::pair<double, double>> errors;
    for (const auto& row : table.at("rows"))
        if (row.at(1).is_number()) errors.emplace_back(row.at(0).get<double>(), std::pow(row.at(1).get<double>(), 2));
    REQUIRE(table.at("columns").at(1).at("name") == "position");
    return errors;
}

/// Root mean square of the position error, over two seeds and the times after `from` s.
double rms(const Settings& settings, double from = 0) {
    double sum = 0;
    std::size_t count = 0;
    for (int seed = 1; seed <= 2; ++seed)
        for (const auto& [time, square] : errors_of(seed, settings)) {
            if (time < from) continue;
            sum += square;
            ++count;
        }
    return std::sqrt(sum / static_cast<double>(count));
}

double tidy() {
    static const double value = rms({});
    return value;
}

const std::string eo = "world.sensors.eo.";

}  // namespace

TEST_CASE("Frames that are late or in disorder cost nothing if they are waited for, and little if not") {
    CHECK(rms({eo + "delay=0.3 s", "time.lateness=0.3 s"}) == tidy());
    CHECK(rms({eo + "delay_spread=0.3 s", "time.lateness=0.35 s"}) == tidy());
    CHECK(rms({eo + "delay=0.3 s"}) < 1.3 * tidy());  // told from what had come by then: 6 of 40 frames are lost
    CHECK(rms({eo + "delay_spread=0.3 s"}) < 1.2 * tidy());
}

TEST_CASE("Frames that are lost and other rates cost what their number costs") {
    // The variance of a mean goes with 1/n. What the filter adds of its own does not, so it is less than that.
    CHECK(rms({eo + "drop=0.3"}) < std::sqrt(1 / 0.7) * tidy());
    CHECK(rms({eo + "period=125 ms"}) < std::sqrt(20.0 / 8.0) * tidy());
    CHECK(rms({eo + "period=37 ms"}) < tidy());
    CHECK(rms({"world.sensors.radar.drop=0.3"}) < 1.2 * tidy());  // longer windows, fewer of them
}

TEST_CASE("Frames about their ticks, and a clock that is wrong by little against the motion, cost little") {
    CHECK(rms({eo + "jitter=10 ms"}) < 1.1 * tidy());
    CHECK(rms({eo + "clock_offset=10 ms"}) < 1.1 * tidy());
    CHECK(rms({eo + "clock_offset=50 ms"}) < 1.2 * tidy());
    CHECK(rms({eo + "clock_offset=-50 ms"}) < 1.2 * tidy());
}

TEST_CASE("Outages are bridged, or leave the radar alone until they end") {
    CHECK(rms({eo + "outage=[100.5 s, 102 s, 200.3 s, 201.9 s]"}) < 1.05 * tidy());  // within one window
    const std::string minute = eo + "outage=[200 s, 260 s]";
    CHECK(rms({minute}) < rms({eo + "outage=[0 s, 601 s]"}));
    CHECK(rms({minute}, 320) == Approx(rms({}, 320)).epsilon(0.01));  // a minute later nothing is left of it
}

TEST_CASE("All of it at once") {
    CHECK(rms({eo + "drop=0.2", eo + "jitter=10 ms", eo + "delay=0.1 s", eo + "delay_spread=0.3 s",
               eo + "clock_offset=10 ms", "time.lateness=0.45 s"}) < 1.2 * tidy());
}
