// The airship's campaigns as they are shipped: the figures that stand beside each config are reached.
#include "../support/expected_figures.hpp"

using namespace pelorus::test;

namespace {

const std::string noise = "world.sensors.radar.noise", points = "world.targets.airship.points_per_scan";
const std::vector<std::string> errors{"errors.position_rmse", "errors.velocity_rmse", "shape.minor_axis_error",
                                      "shape.major_axis_error", "shape.axis_angle"};

/// Files of tracks are left out.
Json airship_cells(const std::string& name, std::vector<std::string> flags) {
    flags.insert(flags.end(), {"--set", "files=~"});
    return cells_of(name, flags);
}

const Json& airship_cell(const Json& cells, const std::string& variant, double noise_m, double points_per_scan) {
    return cell_of(cells, variant, {{noise, noise_m}, {points, points_per_scan}});
}

std::size_t check_airship(const std::string& name, const Json& cells) {
    return check_figures(name, cells, [](const std::string&, const std::string&) { return Band{0.04, 0.005}; });
}

}  // namespace

// Thousands of runs: too slow under the sanitizers, which see the same code in the cases of airship_test.cpp.
TEST_CASE("the airship's campaign reaches the figures beside it", "[airship][release-only]") {
    const Json cells = airship_cells("airship", {});
    REQUIRE(cells.size() == 90);
    CHECK(check_airship("airship", cells) > 50);
    for (const int count : {10, 16, 22}) {
        CAPTURE(count);
        CHECK(value(airship_cell(cells, "published", 5, count), "shape.minor_axis_bias") > 1.5);
        CHECK(std::fabs(value(airship_cell(cells, "best", 5, count), "shape.minor_axis_bias")) <= 0.1);
    }
    for (const Json& cell : cells)
        if (cell["variant"] == "best")
            for (const std::string& scalar : errors) {
                CAPTURE(cell["sweep"], scalar);
                CHECK(cell["paired"]["scalars"][scalar]["difference"] < 0);
            }
}

TEST_CASE("the airship with a shared sensor error reaches the figures beside it", "[airship][release-only]") {
    CHECK(check_airship("airship_shared_error", airship_cells("airship_shared_error", {"--variant", "published"})) ==
          18);
}

TEST_CASE("the turning airship reaches the figures beside it", "[airship][release-only]") {
    const Json cells = airship_cells(
        "airship_turning", {"--variant", "published", "--variant", "feldmann", "--variant", "follow", "--variant",
                            "imm", "--variant", "velocity_aligned", "--variant", "best", "--set", noise + "=1m"});
    CHECK(check_airship("airship_turning", cells) > 30);
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
    const Json cells = airship_cells(config, flags);
    for (const Json& cell : cells)
        if (cell["variant"] == "best")
            for (const std::string& scalar : errors) {
                INFO(config << " " << sets.back() << " " << cell["sweep"] << " " << scalar << ": "
                            << cell["scalars"][scalar]["value"] << ", difference "
                            << cell["paired"]["scalars"][scalar]);
                CHECK(cell["paired"]["scalars"][scalar]["difference"] < 0);
            }
}
