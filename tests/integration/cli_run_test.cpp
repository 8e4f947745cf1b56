// `pelorus run` and `check`: result folders, determinism, snapshots, and orderly ends.
#include <csignal>

#include <chrono>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

/// Two aircraft, missed detections and false alarms: tracks start, coast and end on random numbers.
const char* const config_text = R"(pelorus: 1
title: two aircraft
run: {seed: 7}
graph:
  world:
    use: source.simulation
    with: {scans: 60, period: 1 s}
    parts:
      targets:
        one: {use: trajectory.legs, with: {start: [-3 km, 0 m, 1 km], speed: 80 m/s, heading: 10 deg}}
        two: {use: trajectory.legs, with: {start: [3 km, 500 m, 1 km], speed: 60 m/s, heading: 170 deg}}
      sensors:
        radar:
          use: sensor.position
          with:
            noise: 10 m
            detection_probability: 0.9
            clutter: 2
            clutter_min: [-5 km, -5 km, 0 m]
            clutter_max: [5 km, 5 km, 2 km]
  tracker:
    use: tracker.point_target
    with: {maximum_speed: 300 m/s}
    in: {scans: world.scans}
    parts:
      estimator:
        use: estimator.kalman
        parts:
          motion: {use: motion.constant_velocity, with: {noise: 1 m2/s3}}
          sensors: {radar: {like: world.sensors.radar}}
  errors:
    use: analyzer.tracking_error
    in: {tracks: tracker.tracks, truth: world.truth}
  files:
    use: sink.csv
    in: {tracks: tracker.tracks, truth: world.truth}
)";

/// A folder with that config, and runs of it.
struct Bench {
    TemporaryFolder folder;
    std::string config = folder.write("two.yaml", config_text);

    Ended run(const std::string& out, std::vector<std::string> flags = {}) const {
        flags.insert(flags.begin(), {"run", config, "--out", folder / out});
        return pelorus_command(flags);
    }
    std::string summary(const std::string& out) const { return folder.read(out + "/summary.json"); }
    nlohmann::json provenance(const std::string& out) const {
        return nlohmann::json::parse(folder.read(out + "/provenance.json"));
    }
};

}  // namespace

TEST_CASE("a run prints its figures and leaves a result folder") {
    const Bench bench;
    const Ended ended = bench.run("out");
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    CHECK_THAT(ended.out, StartsWith("two aircraft\n") && Contains("errors.position_rmse") && Contains("summary.json"));
    for (const char* name : {"summary.json", "provenance.json", "timing.json", "tracks.csv", "truth.csv"})
        CHECK(bench.folder.has(std::string("out/") + name));
    const auto cell = nlohmann::json::parse(bench.summary("out"))["cells"][0];
    CHECK(cell["variant"] == "default");
    CHECK(cell["runs"] == 1);
    const double rmse = cell["scalars"]["errors.position_rmse"]["value"];
    CHECK(rmse > 1);
    CHECK(rmse < 20);
    CHECK(bench.provenance("out")["seed"] == 7);
    CHECK(bench.provenance("out")["completed"] == true);
}

TEST_CASE("results go to ./results/CONFIG-NAME unless a folder is named") {
    const Bench bench;
    ProcessOptions options;
    options.folder = bench.folder.path();
    REQUIRE(pelorus_command({"run", "two.yaml"}, options).exit == 0);
    CHECK(bench.folder.has("results/two/summary.json"));
}

TEST_CASE("the same seed gives the same bytes, with any number of threads, and another seed does not") {
    const Bench bench;
    REQUIRE(bench.run("a").exit == 0);
    REQUIRE(bench.run("b", {"--threads", "2"}).exit == 0);
    REQUIRE(bench.run("c", {"--seed", "8"}).exit == 0);
    CHECK(bench.summary("a") == bench.summary("b"));
    CHECK(bench.folder.read("a/tracks.csv") == bench.folder.read("b/tracks.csv"));
    CHECK(bench.summary("a") != bench.summary("c"));
    CHECK(bench.provenance("c")["seed"] == 8);
}

TEST_CASE("a run that is ended at a snapshot and resumed gives the same bytes as one that was not") {
    const Bench bench;
    REQUIRE(bench.run("whole").exit == 0);
    const Ended half = bench.run("half", {"--snapshot-at", "30.5 s", "--stop-at-snapshot"});
    CHECK(half.exit == 0);
    CHECK_THAT(half.err, Contains("stopped at the snapshot") && Contains("--resume"));
    REQUIRE(bench.folder.has("half/snapshot.plrsnap"));
    CHECK(bench.summary("half") != bench.summary("whole"));
    CHECK(bench.provenance("half")["completed"] == false);

    const Ended rest = pelorus_command({"run", bench.config, "--resume", bench.folder / "half"});
    CAPTURE(rest.err);
    REQUIRE(rest.exit == 0);
    CHECK(bench.summary("half") == bench.summary("whole"));
    CHECK(bench.folder.read("half/tracks.csv") == bench.folder.read("whole/tracks.csv"));
    CHECK(bench.folder.read("half/truth.csv") == bench.folder.read("whole/truth.csv"));

    const Ended elsewhere = bench.run("elsewhere", {"--resume", bench.folder / "half"});
    REQUIRE(elsewhere.exit == 0);
    CHECK(bench.summary("elsewhere") == bench.summary("whole"));
    CHECK(bench.folder.read("elsewhere/tracks.csv") == bench.folder.read("whole/tracks.csv"));
}

TEST_CASE("a snapshot does not change the run that writes it") {
    const Bench bench;
    REQUIRE(bench.run("plain").exit == 0);
    REQUIRE(bench.run("snapped", {"--snapshot-at", "20s"}).exit == 0);
    CHECK(bench.summary("snapped") == bench.summary("plain"));
    CHECK(bench.folder.has("snapped/snapshot.plrsnap"));
}

TEST_CASE("a snapshot of another config, a damaged one and none at all are refused") {
    const Bench bench;
    REQUIRE(bench.run("half", {"--snapshot-at", "30s", "--stop-at-snapshot"}).exit == 0);
    const std::string summary = bench.summary("half");
    const Ended other = bench.run("x", {"--resume", bench.folder / "half", "--set", "world.sensors.radar.noise=20m"});
    CHECK(other.exit == 1);
    CHECK_THAT(other.err, Contains("snapshot"));
    CHECK_FALSE(bench.folder.has("x"));

    const Ended none = bench.run("x", {"--resume", bench.folder / "nothing"});
    CHECK(none.exit == 2);
    CHECK_THAT(none.err, Contains("--resume: cannot open"));

    std::string bytes = bench.folder.read("half/snapshot.plrsnap");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    bench.folder.write("half/snapshot.plrsnap", bytes);
    CHECK(bench.run("x", {"--resume", bench.folder / "half"}).exit == 1);
    bench.folder.write("half/snapshot.plrsnap", bytes.substr(0, bytes.size() / 3));
    CHECK(bench.run("x", {"--resume", bench.folder / "half"}).exit == 1);
    CHECK(bench.summary("half") == summary);
}

TEST_CASE("an override by --set changes a value, and a wrong one is told with its place") {
    const Bench bench;
    REQUIRE(bench.run("a").exit == 0);
    REQUIRE(bench.run("b", {"--set", "world.sensors.radar.noise=50m", "--set", "world.scans=30"}).exit == 0);
    CHECK(bench.summary("a") != bench.summary("b"));
    const Ended wrong = bench.run("c", {"--set", "world.sensors.radar.noise=-3 s", "--set", "world.speed=3"});
    CHECK(wrong.exit == 2);
    CHECK_THAT(wrong.err, Contains("--set world.sensors.radar.noise") && Contains("--set world.speed"));
    CHECK_FALSE(bench.folder.has("c"));
}

TEST_CASE("check confirms a good config and tells everything that is wrong with another") {
    const Bench bench;
    const Ended good = pelorus_command({"check", bench.config});
    CHECK(good.exit == 0);
    CHECK(good.err.empty());
    CHECK_THAT(good.out, Contains("good: 4 nodes, 5 edges") && Contains("scans <- world.scans"));
    CHECK_FALSE(bench.folder.has("results"));

    std::string text = config_text;
    text.replace(text.find("period: 1 s"), 11, "period: 1 m");
    text.replace(text.find("speed: 80"), 5, "sped_");
    text.replace(text.find("in: {scans: world.scans}"), 24, "in: {scans: world.scan}");
    const std::string bad = bench.folder.write("bad.yaml", text);
    const Ended ended = pelorus_command({"check", bad});
    CHECK(ended.exit == 2);
    CHECK(ended.out.empty());
    for (const char* place : {":7:", ":10:", ":24:"}) CHECK_THAT(ended.err, Contains(bad + place));
    CHECK(count(ended.err, bad + ":") == count(ended.err, "\n"));
}

TEST_CASE("SIGINT and SIGTERM end a run in an orderly way and keep what is there") {
    for (const int signal : {SIGINT, SIGTERM}) {
        const Bench bench;
        Process process({PELORUS_EXECUTABLE, "run", bench.config, "--out", bench.folder / "out", "--set",
                         "world.scans=10000000", "--set", "errors=~"});
        while (!bench.folder.has("out") && process.running())
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        process.send(signal);
        const Ended ended = process.wait();
        CAPTURE(ended.err);
        CHECK(ended.exit == 1);
        CHECK_THAT(ended.err, Contains(signal == SIGINT ? "stopped by SIGINT" : "stopped by SIGTERM"));
        CHECK_THAT(ended.err, Contains("results up to there are in"));
        CHECK(bench.provenance("out")["completed"] == false);
        CHECK(bench.folder.has("out/tracks.csv"));
    }
}

TEST_CASE("a run that fails says where and why, and keeps what is there") {
    const Bench bench;
    bench.folder.write("summary.json", "of an earlier run");
    const Ended ended = bench.run("", {"--set", "files.tracks=/proc/nothing/tracks.csv"});
    CAPTURE(ended.err);
    CHECK(ended.exit == 1);
    for (const char* part : {"files", "sink.csv", "/proc/nothing/tracks.csv", "the run failed at "})
        CHECK_THAT(ended.err, Contains(part));
    const auto provenance = nlohmann::json::parse(bench.folder.read("provenance.json"));
    CHECK(provenance["completed"] == false);
    CHECK_THAT(bench.folder.read("summary.json"), StartsWith("{"));
}

TEST_CASE("a result folder that cannot be written is told before the run") {
    const Bench bench;
    bench.folder.write("file", "");
    const Ended ended = bench.run("file");
    CHECK(ended.exit == 1);
    CHECK_THAT(ended.err, Contains("cannot make the result folder"));
}
