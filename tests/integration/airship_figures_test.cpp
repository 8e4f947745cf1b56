// The airship's campaigns as they are shipped: the figures that stand beside each config are reached.
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Json = nlohmann::json;

namespace {

const std::string noise = "world.sensors.radar.noise", points = "world.targets.airship.points_per_scan";
const std::vector<std::string> errors{"errors.position_rmse", "errors.velocity_rmse", "shape.minor_axis_error",
                                      "shape.major_axis_error", "shape.axis_angle"};

/// The cells of configs/NAME.yaml, run as a campaign.
Json cells_of(const std::string& name, const std::vector<std::string>& flags) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"run",   PELORUS_SOURCE_DIR "/configs/" + name + ".yaml",
                                   "--out", folder / "out",
                                   "--set", "files=~"};  // no files of tracks
    words.insert(words.end(), flags.begin(), flags.end());
    const Ended ended = pelorus_command(words);
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    return Json::parse(folder.read("out/summary.json"))["cells"];
}

const Json& cell_of(const Json& cells, const std::string& variant, double noise_m, double points_per_scan) {
    for (const Json& cell : cells)
        if (cell["variant"] == variant && cell["sweep"].value(noise, noise_m) == noise_m &&
            cell["sweep"].value(points, points_per_scan) == points_per_scan)
            return cell;
    throw std::runtime_error("no cell of " + variant);
}

double value(const Json& cell, const std::string& scalar) { return cell["scalars"][scalar]["value"]; }

/// One figure of NAME.expected.yaml beside ours.
void check_figure(double made, const YAML::Node& expected) {
    // Shapes are told with two digits: half of the last one more.
    if (expected["reproduced"]) {
        const auto reproduced = expected["reproduced"].as<double>();
        CAPTURE(made, reproduced);
        CHECK(std::fabs(made - reproduced) <= 0.04 * reproduced + 0.005);
    }
    if (expected["limit"]) {
        const auto limit = expected["limit"].as<double>();
        CAPTURE(made, limit);
        CHECK(made <= limit);
    }
}

std::size_t check_figures(const std::string& name, const Json& cells) {
    std::size_t figures = 0;
    for (const YAML::Node& entry : YAML::LoadFile(PELORUS_SOURCE_DIR "/configs/" + name + ".expected.yaml")["cells"]) {
        const auto variant = entry["variant"].as<std::string>();
        const auto noise_m = entry["sweep"][noise].as<double>(), count = entry["sweep"][points].as<double>();
        const Json& cell = cell_of(cells, variant, noise_m, count);
        for (const auto& scalar : entry["scalars"]) {
            INFO(name << ", " << variant << ", noise " << noise_m << " m, " << count
                      << " points: " << scalar.first.as<std::string>());
            check_figure(value(cell, scalar.first.as<std::string>()), scalar.second);
            ++figures;
        }
    }
    return figures;
}

}  // namespace

// Thousands of runs: too slow under the sanitizers, which see the same code in the cases of airship_test.cpp.
TEST_CASE("the airship's campaign reaches the figures beside it", "[airship][release-only]") {
    const Json cells = cells_of("airship", {});
    REQUIRE(cells.size() == 90);
    CHECK(check_figures("airship", cells) > 50);
    for (const int count : {10, 16, 22}) {
        CAPTURE(count);
        CHECK(value(cell_of(cells, "published", 5, count), "shape.minor_axis_bias") > 1.5);
        CHECK(std::fabs(value(cell_of(cells, "best", 5, count), "shape.minor_axis_bias")) <= 0.1);
    }
    for (const Json& cell : cells)
        if (cell["variant"] == "best")
            for (const std::string& scalar : errors) {
                CAPTURE(cell["sweep"], scalar);
                CHECK(cell["paired"]["scalars"][scalar]["difference"] < 0);
            }
}

TEST_CASE("the airship with a shared sensor error reaches the figures beside it", "[airship][release-only]") {
    CHECK(check_figures("airship_shared_error", cells_of("airship_shared_error", {"--variant", "published"})) == 18);
}

TEST_CASE("the turning airship reaches the figures beside it", "[airship][release-only]") {
    const Json cells = cells_of("airship_turning",
                                {"--variant", "published", "--variant", "feldmann", "--variant", "follow", "--variant",
                                 "imm", "--variant", "velocity_aligned", "--variant", "best", "--set", noise + "=1m"});
    CHECK(check_figures("airship_turning", cells) > 30);
}

TEST_CASE("the best choice for the airship loses to the published filter nowhere", "[airship][release-only]") {
    const auto [config, sets] = GENERATE(table<std::string, std::vector<std::string>>({
        {"airship_shared_error", {noise + "=5m"}},
        {"airship_shared_error", {noise + "=0.2m"}},
        {"airship_turning_shared_error", {noise + "=1m"}},
        {"airship", {noise + "=1m", "world.targets.airship.speed=1 m/s"}},
        {"airship", {noise + "=5m", "world.targets.airship.speed=0.2 m/s"}},
        {"airship", {noise + "=1m", "world.targets.airship.semi_axes=[5 m, 12 m, 5 m]"}},  // it flies sideways
        {"airship", {noise + "=1m", "world.targets.airship.semi_axes=[30 m, 4 m, 4 m]"}},
        {"airship", {noise + "=1.2m", "world.targets.airship.semi_axes=[27 m, 1.9 m, 1.9 m]"}},
        {"airship_turning",
         {noise + "=0.2m", "world.targets.airship.semi_axes=[25 m, 2 m, 2 m]", "world.targets.airship.speed=1.5 m/s",
          "world.targets.airship.turn_rate=1 deg/s"}},
        {"airship_turning",
         {noise + "=1m", "world.targets.airship.turn_rate=6 deg/s", "world.targets.airship.speed=40 m/s"}},
    }));
    std::vector<std::string> flags{"--variant", "published", "--variant", "best", "--runs", "60"};
    for (const std::string& set : sets) flags.insert(flags.end(), {"--set", set});
    const Json cells = cells_of(config, flags);
    for (const Json& cell : cells)
        if (cell["variant"] == "best")
            for (const std::string& scalar : errors) {
                INFO(config << " " << sets.back() << " " << cell["sweep"] << " " << scalar << ": "
                            << cell["scalars"][scalar]["value"] << ", difference "
                            << cell["paired"]["scalars"][scalar]);
                CHECK(cell["paired"]["scalars"][scalar]["difference"] < 0);
            }
}
