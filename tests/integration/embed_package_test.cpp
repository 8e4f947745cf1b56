// The CMake package Pelorus, as it is installed: moved, found, built against, run. And the page that tells of it.
#include <catch2/catch.hpp>

#include <filesystem>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

namespace fs = std::filesystem;

const std::string example = PELORUS_SOURCE_DIR "/examples/embed";

Ended require_success(const std::vector<std::string>& words, const ProcessOptions& options = {}) {
    const Ended ended = run(words, options);
    CAPTURE(words, ended.out, ended.err);
    REQUIRE(ended.exit == 0);
    return ended;
}

}  // namespace

TEST_CASE("The installed package can be moved, and the example is built against it alone and runs", "[release-only]") {
    const TemporaryFolder folder;
    require_success({"cmake", "--install", PELORUS_BUILD_DIR, "--prefix", folder / "installed"});
    fs::rename(folder / "installed", folder / "moved");
    const std::string build = folder / "build", prefix = folder / "moved";
    require_success({"cmake", "-G", "Ninja", "-S", example, "-B", build, "-DCMAKE_BUILD_TYPE=Debug",
                     "-DCMAKE_CXX_STANDARD=17", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror -fno-exceptions",
                     "-DCMAKE_C_FLAGS=-std=c11 -Wall -Wextra -Wpedantic -Werror",
                     "-DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF", "-DCMAKE_PREFIX_PATH=" + prefix});
    const std::string rules = read_file(build + "/build.ninja");
    CHECK(count(rules, prefix + "/include") > 0);
    CHECK(count(rules, "eigen") == 0);
    CHECK(count(rules, PELORUS_SOURCE_DIR "/sdk") + count(rules, PELORUS_SOURCE_DIR "/framework") == 0);
    require_success({"cmake", "--build", build});

    ProcessOptions options;  // plugins lie beside the library, nowhere else
    options.environment = {{"PELORUS_PLUGIN_PATH", ""}};
    const Ended tracked = require_success({build + "/embed", example + "/pipeline.yaml"}, options);
    CHECK_THAT(tracked.out, Contains("  18 s  track ") && Contains("east    7300 m  north    5000 m"));
    const Ended refused = run({build + "/embed", PELORUS_SOURCE_DIR "/configs/airship.yaml"}, options);
    CHECK(refused.exit == 1);
    CHECK(refused.err == "no in port 'radar.scans' takes scans of a sensor 'radar'\n");

    const Ended figures = require_success(
        {build + "/minimal", PELORUS_SOURCE_DIR "/configs/recorded_radar.yaml", folder / "results"}, options);
    CHECK_THAT(figures.out, Contains("errors.position_rmse ") && Contains("identity.purity 1"));
    CHECK(fs::exists(folder / "results/summary.json"));
    const Ended missing = run({build + "/minimal"}, options);
    CHECK(missing.exit == 1);
    CHECK(missing.err == "file is NULL\n");
}

TEST_CASE("The command checks a config that an application feeds, and says of a run that nothing was pushed") {
    const TemporaryFolder folder;
    const std::string config = PELORUS_SOURCE_DIR "/configs/recorded_radar_external.yaml";
    const Ended checked = pelorus_command({"check", config});
    CAPTURE(checked.err);
    CHECK(checked.exit == 0);
    const Ended ended = pelorus_command({"run", config, "--out", folder / "out"});
    CHECK(ended.exit == 0);
    CHECK(count(ended.err, "radar (source.external)") == 1);
    CHECK_THAT(ended.err, Contains("`pelorus run` has nothing to push"));
    const Ended wrong = pelorus_command({"check", config, "--set", "radar.sensors.radar={use: sensor.position}"});
    CHECK(wrong.exit == 2);
    CHECK_THAT(wrong.err, Contains("radar.scans -> tracker.scans: the stream of sensor 'radar' does not fit"));
}

TEST_CASE("The page on embedding shows the example as it is") {
    const std::string page = read_file(PELORUS_SOURCE_DIR "/docs/embedding.md");
    for (const std::string file : {"CMakeLists.txt", "main.cpp", "minimal.c", "pipeline.yaml"}) {
        INFO(file);
        CHECK(page.find("\n" + read_file(example + "/" + file) + "```\n") != std::string::npos);
    }
}
