// configs/radar_lidar.yaml: one car seen by two sensors in turns. The recording is found through PELORUS_DATA; without it these
// tests say so and pass.
#include <cstdlib>

#include "../support/expected_figures.hpp"

using namespace pelorus::test;

namespace {

bool is_there() {
    const char* data = std::getenv("PELORUS_DATA");
    if (data != nullptr &&
        std::filesystem::exists(std::filesystem::path(data) / "obj_pose-laser-radar-synthetic-input.txt"))
        return true;
    WARN("skipped: PELORUS_DATA names no folder with obj_pose-laser-radar-synthetic-input.txt");
    return false;
}

}  // namespace

TEST_CASE("Radar and lidar in one file give the known errors of each filter", "[recording]") {
    if (!is_there()) return;
    const Json cells = cells_of("radar_lidar", {});
    REQUIRE(cells.size() == 4);
    for (const Json& cell : cells) {
        CHECK(value(cell, "errors.estimates") == 500);  // at every line, of both sensors, the first included
        CHECK(value(cell, "errors.missing") == 0);
        CHECK(value(cell, "errors.innovations") == 499);
        CHECK(value(cell, "errors.track_count") == 1);
    }
    const auto band_of = [](const std::string&, const std::string&) { return Band{0.001, 0.000005}; };
    CHECK(check_figures("radar_lidar", cells, band_of) == 16);
}

TEST_CASE("Radar and lidar in one file go on bit for bit after a resume half-way", "[recording]") {
    if (!is_there()) return;
    const TemporaryFolder folder;
    const auto go = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(),
                         {"run", PELORUS_SOURCE_DIR "/configs/radar_lidar.yaml", "--variant", "ekf"});
        const Ended ended = pelorus_command(arguments);
        INFO(ended.err);
        REQUIRE(ended.exit == 0);
    };
    go({"--out", folder / "whole"});
    go({"--out", folder / "half", "--snapshot-at", "12 s", "--stop-at-snapshot"});
    CHECK(folder.read("half/tracks.csv").size() < folder.read("whole/tracks.csv").size());
    go({"--resume", folder / "half"});
    CHECK(folder.read("half/tracks.csv") == folder.read("whole/tracks.csv"));
    CHECK(folder.read("half/summary.json") == folder.read("whole/summary.json"));
}
