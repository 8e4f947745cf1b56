// A plugin in C runs like any other, and plugins that fail are told of. (sdk/examples has one of another compiler: example_figures_test.cpp.)
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"
#include "project_build.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

/// A turning target, followed with the motion that `motion` names.
std::string turning_config(const std::string& motion) {
    return R"(pelorus: 1
run: {seed: 3}
graph:
  world:
    use: source.simulation
    with: {scans: 80, period: 1 s}
    parts:
      targets:
        aircraft:
          use: trajectory.legs
          with: {start: [0 m, 0 m, 1 km], speed: 100 m/s, heading: 0 deg, legs: [{turn_rate: 3 deg/s}]}
      sensors:
        radar: {use: sensor.position, with: {noise: 10 m}}
  tracker:
    use: tracker.point_target
    with: {maximum_speed: 300 m/s}
    in: {scans: world.scans}
    parts:
      estimator:
        use: estimator.kalman
        parts:
          motion: )" +
           motion + R"(
          sensors: {radar: {like: world.sensors.radar}}
  errors:
    use: analyzer.tracking_error
    in: {tracks: tracker.tracks, truth: world.truth}
)";
}

double position_rmse(const TemporaryFolder& folder, const std::string& out) {
    const auto summary = nlohmann::json::parse(folder.read(out + "/summary.json"));
    return summary["cells"][0]["scalars"]["errors.position_rmse"]["value"].get<double>();
}

}  // namespace

TEST_CASE("a plugin in C11, built with the installed headers alone, runs in a pipeline and tells its errors") {
    const std::string host_before = host_sha256();
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "plugins");
    const Ended built = run({"cc", "-std=c11", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC",
                             "-fvisibility=hidden", "-I", PELORUS_SDK_INSTALL "/include",
                             PELORUS_SOURCE_DIR "/tests/plugins/known_turn.c", "-o", folder / "plugins/known_turn.so",
                             "-Wl,-z,defs", "-lm"});
    CAPTURE(built.err);
    REQUIRE(built.exit == 0);

    const auto follow = [&](const std::string& name, const std::string& motion) {
        const std::string config = folder.write(name + ".yaml", turning_config(motion));
        return pelorus_command({"run", config, "--out", folder / name, "--plugins", folder / "plugins"});
    };
    const Ended ended =
        follow("known", "{use: org.example.motion.known_turn, with: {turn_rate: 3 deg/s, noise: 0.01 m2/s3}}");
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    REQUIRE(follow("straight", "{use: motion.constant_velocity, with: {noise: 10 m2/s3}}").exit == 0);
    // Knowing the turn is worth a good deal: so the C code really moved the states.
    CHECK(position_rmse(folder, "known") < 0.7 * position_rmse(folder, "straight"));

    const Ended refused =
        follow("refused", "{use: org.example.motion.known_turn, with: {axes: 1, turn_rate: 3 deg/s}}");
    CHECK(refused.exit == 2);
    CHECK_THAT(refused.err, Contains("refused.yaml:22:") && Contains("a turn needs two axes at least"));
    CHECK(host_sha256() == host_before);
}

TEST_CASE("a motion that throws ends the run with its own words, one that has no result is warned of and counted") {
    const TemporaryFolder folder;
    const auto follow = [&](const std::string& failure) {
        const std::string config = folder.write(
            failure + ".yaml", turning_config("{use: org.example.motion.failing, with: {failure: " + failure + "}}"));
        return pelorus_command({"run", config, "--out", folder / failure, "--plugins", PELORUS_TEST_PLUGINS});
    };
    const Ended thrown = follow("exception");
    CHECK(thrown.exit == 1);
    CHECK_THAT(thrown.err, Contains("node tracker (tracker.point_target)") && Contains("boom"));
    const Ended numeric = follow("numeric");
    CHECK(numeric.exit == 0);
    CHECK_THAT(numeric.err, Contains("no such root") && Contains("numeric_failures"));
    CHECK(count(numeric.err, "no such root") == 1);
}
