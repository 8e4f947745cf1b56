// configs/radar_lidar.yaml: one car seen by two sensors in turns. The recording is found through PELORUS_DATA; without it these
// tests say so and pass.
#include <cstdlib>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;

namespace {

const std::string config = std::string(PELORUS_SOURCE_DIR) + "/configs/radar_lidar.yaml";

bool is_there() {
    const char* data = std::getenv("PELORUS_DATA");
    if (data != nullptr &&
        std::filesystem::exists(std::filesystem::path(data) / "obj_pose-laser-radar-synthetic-input.txt"))
        return true;
    WARN("skipped: PELORUS_DATA names no folder with obj_pose-laser-radar-synthetic-input.txt");
    return false;
}

}  // namespace

TEST_CASE("Radar and lidar in one file give the published errors of each filter", "[recording]") {
    if (!is_there()) return;
    const TemporaryFolder folder;
    const Ended ended = pelorus_command({"run", config, "--out", folder / "out", "--set", "files=~"});
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    const auto summary = nlohmann::json::parse(folder.read("out/summary.json"));
    std::size_t judged = 0;
    for (const YAML::Node& cell :
         YAML::LoadFile(PELORUS_SOURCE_DIR "/configs/radar_lidar.expected.yaml")["cells"]) {
        const auto variant = cell["variant"].as<std::string>();
        for (const auto& made : summary["cells"]) {
            if (made["variant"] != variant) continue;
            CHECK(made["scalars"]["errors.estimates"]["value"] == 500);
            CHECK(made["scalars"]["errors.missing"]["value"] == 0);
            for (const auto& scalar : cell["scalars"]) {
                const auto name = scalar.first.as<std::string>();
                const double value = made["scalars"][name]["value"];
                INFO(variant << ": " << name);
                CHECK(value <= scalar.second["limit"].as<double>());
                if (scalar.second["reproduced"])
                    CHECK(value == Approx(scalar.second["reproduced"].as<double>()).epsilon(1e-3));
                ++judged;
            }
        }
    }
    CHECK(judged == JUDGED);
}

TEST_CASE("Radar and lidar go on bit for bit after a resume half-way", "[recording]") {
    if (!is_there()) return;
    const TemporaryFolder folder;
    const auto go = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"run", config, "--variant", "ekf"});
        const Ended ended = pelorus_command(arguments);
        INFO(ended.err);
        REQUIRE(ended.exit == 0);
    };
    go({"--out", folder / "whole"});
    go({"--out", folder / "half", "--snapshot-at", "12 s", "--stop-at-snapshot"});
    go({"--resume", folder / "half"});
    CHECK(folder.read("half/tracks.csv") == folder.read("whole/tracks.csv"));
    CHECK(folder.read("half/summary.json") == folder.read("whole/summary.json"));
}
