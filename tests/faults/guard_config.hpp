/// A small pipeline with one plugin of the zoo (tests/plugins/zoo*.cpp) in it, as the command runs it.
#pragma once

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

namespace pelorus::test {

/// A target, a tracker and a CSV of its tracks.
struct ZooConfig {
    std::string motion = "{use: motion.constant_velocity, with: {noise: 1 m2/s3}}";
    std::string sensor = "{use: sensor.position, with: {noise: 10 m}}";
    std::string trajectory = "{use: trajectory.legs, with: {start: [0 m, 0 m, 1 km], speed: 100 m/s, heading: 0 deg}}";
    std::string outer = "";    ///< wrapped around the estimator: `org.example.estimator.zoo, with: {...}`
    std::string further = "";  ///< nodes

    std::string text() const {
        const std::string kalman =
            "{use: estimator.kalman, parts: {motion: " + motion + ", sensors: {radar: " + sensor + "}}}";
        const std::string estimator = outer.empty() ? kalman : "{use: " + outer + ", parts: {inner: " + kalman + "}}";
        return R"(pelorus: 1
run: {seed: 3}
graph:
  world:
    use: source.simulation
    with: {scans: 40, period: 1 s}
    parts:
      targets:
        aircraft: )" +
               trajectory + R"(
      sensors:
        radar: {use: sensor.position, with: {noise: 10 m}}
  tracker:
    use: tracker.point_target
    with: {maximum_speed: 300 m/s}
    in: {scans: world.scans}
    parts:
      estimator: )" +
               estimator + R"(
  files:
    use: sink.csv
    in: {tracks: tracker.tracks, truth: world.truth}
)" + further;
    }
};

inline std::string zoo_part(const std::string& kind, const std::string& fault, const std::string& in) {
    return "{use: org.example." + kind + ".zoo, with: {fault: " + fault + ", call: " + in + "}}";
}

inline Ended run_zoo(const TemporaryFolder& folder, const ZooConfig& config, const std::vector<std::string>& more = {},
                     ProcessOptions options = {}) {
    std::vector<std::string> words{
        "run", folder.write("zoo.yaml", config.text()), "--out", folder / "out", "--plugins", PELORUS_TEST_PLUGINS};
    words.insert(words.end(), more.begin(), more.end());
    return pelorus_command(words, options);
}

/// The first line of what was told.
inline std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// The fault's line, the line that says how far the run came and where its results are, and nothing else.
inline void check_told(const TemporaryFolder& folder, const Ended& ended, const std::string& place,
                       const std::string& line) {
    CHECK(ended.exit == 1);
    CHECK(first_line(ended.err) == "pelorus: node " + place + ": " + line);
    const std::string rest = ended.err.substr(ended.err.find('\n') + 1);
    CHECK_THAT(rest, Catch::StartsWith("pelorus: the run failed at "));
    CHECK_THAT(first_line(rest), Catch::EndsWith("; results up to there are in " + folder / "out"));
    CHECK_THAT(rest.substr(rest.find('\n') + 1), !Catch::Contains("pelorus:"));
    CHECK(folder.has("out/summary.json"));
    CHECK(folder.has("out/provenance.json"));
    CHECK(folder.has("out/truth.csv"));
    CHECK(!folder.has("out/truth.csv.part"));
}

}  // namespace pelorus::test
