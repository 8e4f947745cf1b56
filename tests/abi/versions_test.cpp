// Plugins of one age in hosts of another: only headers differ, everything else is the build under test.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include <pelorus/abi/threads.h>

#include "support.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

const std::string programs = PELORUS_SOURCE_DIR "/tests/abi/programs/";
const std::string known_turn = PELORUS_SOURCE_DIR "/tests/plugins/known_turn.c";

/// A turning target, followed with a motion and counted by a stage, both in C.
const char* const config = R"(pelorus: 1
run: {seed: 3}
graph:
  world:
    use: source.simulation
    with: {scans: 40, period: 1 s}
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
          motion: {use: org.example.motion.known_turn, with: {turn_rate: 3 deg/s, noise: 0.01 m2/s3}}
          sensors: {radar: {like: world.sensors.radar}}
  counter:
    use: org.example.analyzer.track_counter
    in: {tracks: tracker.tracks}
  files:
    use: sink.csv
    in: {tracks: tracker.tracks}
)";

/// The two plugins, compiled with a set of headers, in a pipeline. Answers summary.json.
std::string run_with_plugins_of(const std::string& headers, const TemporaryFolder& folder, const std::string& name) {
    const std::string plugins = folder / (name + "-plugins");
    std::filesystem::create_directory(plugins);
    compile_plugin(headers, known_turn, plugins + "/known_turn.so");
    compile_plugin(headers, programs + "track_counter.c", plugins + "/track_counter.so");
    const std::string file = folder.write(name + ".yaml", config);
    const auto command = [&](const std::string& out, std::vector<std::string> more) {
        more.insert(more.begin(), {"run", file, "--plugins", plugins, "--out", folder / out});
        const Ended ended = pelorus_command(more);
        CAPTURE(headers, ended.err);
        REQUIRE(ended.exit == 0);
    };
    command(name, {"--snapshot-at", "20s"});
    const std::string summary = folder.read(name + "/summary.json");
    const auto scalars = nlohmann::json::parse(summary)["cells"][0]["scalars"];
    const auto lines = count(folder.read(name + "/tracks.csv"), "\n");
    CHECK(scalars["counter.entries"]["value"] == static_cast<double>(lines - 1));
    CHECK(lines > 35);
    CHECK(scalars["counter.from_origin"]["value"] > 1000.0);
    command(name + "-resumed", {"--resume", folder / name});
    CHECK(folder.read(name + "-resumed/summary.json") == summary);
    return summary;
}

const std::string host_says = R"(state position.x position.y velocity.x velocity.y
propagate 7 10 3 4 -7 -10 -3 -4
jacobian 1 0 0 0 0 1 0 0 2 0 1 0 0 2 0 1
noise 1.3333333333333333 0 1 0 0 1.3333333333333333 0 1 1 0 1 0 0 1 0 1
structure 2
sensor radar
)";

std::vector<double> numbers_after(const std::string& text, const std::string& word) {
    const std::size_t at = text.find("\n" + word + " ");
    REQUIRE(at != std::string::npos);
    std::istringstream line(text.substr(at + word.size() + 2, text.find('\n', at + 1) - at - word.size() - 2));
    return {std::istream_iterator<double>(line), std::istream_iterator<double>()};
}

/// A step of 2 s with q = 0.5 from P = 4 I, then a measurement with R = 9: each axis by the textbook.
void check_estimates(const std::string& text) {
    const double p = 4 + 4 * 4 + 0.5 * 8 / 3, c = 2 * 4 + 0.5 * 4 / 2, v = 4 + 0.5 * 2, s = p + 9;
    const std::vector<double> mean = numbers_after(text, "mean"), covariance = numbers_after(text, "covariance");
    REQUIRE(mean.size() == 8);
    REQUIRE(covariance.size() == 16);
    CHECK(mean[0] == Approx(2 + p / s * 1));
    CHECK(mean[1] == Approx(p / s * 1));
    CHECK(mean[2] == Approx(1 + c / s * 1));
    CHECK(mean[4] == Approx(10 + p / s * 1));
    CHECK(mean[7] == Approx(1 + c / s * 1));
    CHECK(covariance[0] == Approx(p - p * p / s));
    CHECK(covariance[2] == Approx(c - p * c / s));
    CHECK(covariance[10] == Approx(v - c * c / s));
    const double pi = std::acos(-1.0);
    CHECK(numbers_after(text, "log_likelihood")[1] == Approx(-std::log(2 * pi * s) - 0.5 * (1 + 1) / s));
}

void run_host_of(const std::string& headers) {
    const TemporaryFolder folder;
    compile(headers, programs + "host.c", folder / "host", {"-ldl"});
    const Ended ended = run({folder / "host", PELORUS_PLUGIN_DIR});
    CAPTURE(headers, ended.out, ended.err);
    REQUIRE(ended.exit == 0);
    CHECK(ended.out.substr(0, host_says.size()) == host_says);
    check_estimates(ended.out);
    CHECK_THAT(ended.out, Catch::EndsWith("destroyed\n"));
}

}  // namespace

TEST_CASE("plugins of an older set of headers, and of a newer one, run in today's host as today's do", "[abi]") {
    const TemporaryFolder folder;
    const std::string now = run_with_plugins_of(today, folder, "today");
    CHECK(run_with_plugins_of(older, folder, "older") == now);
    CHECK(run_with_plugins_of(write_newer_headers(folder), folder, "newer") == now);
}

TEST_CASE("a host of an older set of headers runs today's plugins", "[abi][release-only]") { run_host_of(older); }

TEST_CASE("a host of a newer set of headers runs today's plugins", "[abi][release-only]") {
    const TemporaryFolder folder;
    run_host_of(write_newer_headers(folder));
}

TEST_CASE("a newer set of headers is growth and nothing else", "[abi]") {
    const TemporaryFolder folder;
    const std::string newer = write_newer_headers(folder) + "/pelorus/abi";
    const Ended checked = abi("check", newer, PELORUS_SOURCE_DIR "/tests/abi/baseline");
    CAPTURE(checked.out);
    CHECK(checked.exit == 1);
    CHECK(count(checked.out, ": grew at its end, which is allowed") > 15);
    CHECK(count(checked.out, ": changed") == 0);
}

TEST_CASE("a plugin of any minor version of the ABI is taken, one of another major is refused before it runs",
          "[abi]") {
    const TemporaryFolder folder;
    const std::string version = "#define PLR_ABI_MAJOR 1\n#define PLR_ABI_MINOR 1\n";
    const auto inspect = [&](const std::string& name, const std::string& major, const std::string& minor) {
        std::filesystem::create_directories(folder.path() / name / "pelorus");
        std::filesystem::copy(today + "/pelorus/abi", folder.path() / name / "pelorus/abi",
                              std::filesystem::copy_options::recursive);
        replace_in(folder / name + "/pelorus/abi/threads.h", version,
                   "#define PLR_ABI_MAJOR " + major + "\n#define PLR_ABI_MINOR " + minor + "\n");
        std::filesystem::create_directory(folder.path() / (name + "-plugins"));
        compile_plugin(folder / name, known_turn, folder / name + "-plugins/known_turn.so");
        return pelorus_command({"inspect", "org.example.motion.known_turn", "--plugins", folder / name + "-plugins"});
    };
    CHECK(inspect("older-minor", "1", "0").exit == 0);
    CHECK(inspect("newer-minor", "1", "65535").exit == 0);
    const Ended refused = inspect("newer-major", "2", "0");
    CHECK(refused.exit == 2);
    CHECK_THAT(refused.err,
               Contains("plugin org.example.motion.known_turn speaks ABI 2, this host 1: rebuild it with the "
                        "SDK of this host"));
    compile(older, programs + "host.c", folder / "host", {"-ldl"});
    CHECK(run({folder / "host", "abi", folder / "newer-minor-plugins/known_turn.so"}).out == "taken\n");
    CHECK(run({folder / "host", "abi", folder / "newer-major-plugins/known_turn.so"}).err ==
          "refused: it speaks ABI 2, this host 1\n");
}
