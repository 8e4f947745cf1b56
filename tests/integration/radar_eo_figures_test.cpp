// The radar and the electro-optical head as they are shipped: the figures that stand beside the config, other paths and sensors, a recording.
#include <algorithm>
#include <sstream>

#include "../support/expected_figures.hpp"

using namespace pelorus::test;

namespace {

const std::string armse = "errors.position_armse", nees = "errors.nees", range = "world.sensors.eo.range";

/// Sets of 100 runs scatter by up to 1.4 %, imm with a passive head by 2 %.
Band band_of(const std::string& variant, const std::string&) {
    if (variant == "radar" || variant == "eo") return {0.02, 0};
    return {variant == "registered" ? 0.03 : 0.05, 0};
}

void append(Json& cells, const Json& more) { cells.insert(cells.end(), more.begin(), more.end()); }

std::vector<std::string> flags_of(const std::vector<std::string>& variants, const std::string& runs,
                                  const std::vector<std::string>& sets = {}) {
    std::vector<std::string> flags{"--runs", runs};
    for (const std::string& variant : variants) flags.insert(flags.end(), {"--variant", variant});
    for (const std::string& set : sets) flags.insert(flags.end(), {"--set", set});
    return flags;
}

struct Table {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;

    explicit Table(const std::string& text) {
        std::istringstream lines(text);
        std::string line;
        for (bool is_head = true; std::getline(lines, line); is_head = false) {
            std::istringstream cells(line);
            std::vector<std::string> row;
            for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
            is_head ? columns = row : (rows.push_back(row), row);
        }
    }
    double number(std::size_t row, const std::string& column) const {
        const auto at = std::find(columns.begin(), columns.end(), column) - columns.begin();
        return std::stod(rows.at(row).at(static_cast<std::size_t>(at)));
    }
};

/// The expert on two recordings. The simulation ends at once and stays as the place that says which sensors there are.
const char* const replay = R"(pelorus: 1
extend: CONFIG
graph:
  world: {with: {duration: 0 s}}
  radar:
    use: source.csv
    with:
      file: RADAR
      sensor: radar
      start: 0
      columns:
        - {column: range, component: range, deviation: 5}
        - {column: azimuth, component: azimuth, deviation: 3e-3}
        - {column: zenith, component: zenith, deviation: 3e-3}
  eo:
    use: source.csv
    with:
      file: EO
      sensor: eo
      start: 0
      columns:
        - {column: azimuth, component: azimuth, deviation: 1e-5}
        - {column: zenith, component: zenith, deviation: 1e-5}
  blocks: {in: {scans: [radar.scans, eo.scans]}}
  errors: ~
  files: {use: sink.csv, in: {tracks: tracker.tracks}}
)";

}  // namespace

// Hundreds of runs: too slow under the sanitizers, which see the same code in shorter ones.
TEST_CASE("the radar and electro-optical campaign reaches the figures beside it", "[radar_eo][release-only]") {
    Json cells = cells_of("radar_eo", flags_of({"radar", "eo"}, "40"));
    append(cells, cells_of("radar_eo", flags_of({"registered", "cv", "ct"}, "50")));
    append(cells, cells_of("radar_eo", flags_of({"imm", "expert", "best"}, "100")));
    REQUIRE(cells.size() == 16);
    CHECK(check_figures("radar_eo", cells, band_of) == 20);
    const auto of = [&](const std::string& variant, const char* reading) {
        return value(cell_of(cells, variant, {{range, reading}}), armse);
    };
    const auto check_ratio = [&](const char* reading, const std::string& variant, double known, double margin) {
        CAPTURE(reading, variant);
        CHECK(of(variant, reading) / of("registered", reading) == Approx(known).margin(margin));
    };
    check_ratio("own", "cv", 0.697, 0.03);
    check_ratio("own", "ct", 0.760, 0.03);
    check_ratio("own", "imm", 0.355, 0.02);
    check_ratio("passive", "cv", 0.527, 0.025);
    check_ratio("passive", "ct", 0.664, 0.025);
    check_ratio("passive", "imm", 0.318, 0.025);
    CHECK(of("expert", "own") <= 0.45 * of("imm", "own"));
    CHECK(of("expert", "passive") <= 0.60 * of("imm", "passive"));
    for (const std::string variant : {"expert", "best"})
        for (const char* const reading : {"own", "passive"}) {
            CAPTURE(variant, reading);
            CHECK(value(cell_of(cells, variant, {{range, reading}}), nees) > 2.2);
            // The causal Cramer-Rao bound: below, it would know what it cannot know.
            CHECK(of(variant, reading) > (reading == std::string("own") ? 0.098 : 0.596));
        }
}

TEST_CASE("the expert knows neither this path nor these sensors, and stays ahead of the published chain",
          "[radar_eo][release-only]") {
    const std::vector<std::vector<std::string>> others{
        {"world.targets.drone.legs=[{duration: 100 s}, {duration: 60 s, turn_rate: 1 deg/s}, {duration: 90 s}, "
         "{duration: 60 s, turn_rate: -0.8 deg/s}]"},
        {"world.targets.drone.velocity=[12 m/s, 20 m/s, 3 m/s]"},
        {"world.targets.drone.velocity=[-3 m/s, 5 m/s, 0.5 m/s]"},
        {"world.targets.drone.legs=[]"},
        {"world.sensors.radar.noise=[15 m, 6 mrad, 6 mrad]"},
        {"world.sensors.eo.noise=[5 m, 50 urad, 50 urad]"},
        {"world.sensors.radar.period=4 s", "errors.period=4 s"},
        {"world.sensors.eo.period=0.1 s"}};
    for (const auto& sets : others) {
        const Json cells = cells_of("radar_eo", flags_of({"imm", "expert"}, "20", sets));
        for (const char* const reading : {"own", "passive"}) {
            CAPTURE(sets.front(), reading);
            const Json &chain = cell_of(cells, "imm", {{range, reading}}),
                       &expert = cell_of(cells, "expert", {{range, reading}});
            CHECK(value(expert, armse) < 0.75 * value(chain, armse));
            CHECK(value(expert, nees) < 3.6);
        }
    }
}

TEST_CASE("a recording of both sensors goes through the same config in place of the simulation, to the same tracks",
          "[radar_eo]") {
    const TemporaryFolder folder;
    const std::string config = PELORUS_SOURCE_DIR "/configs/radar_eo.yaml";
    const auto run_one = [&](std::vector<std::string> words, const std::string& out) {
        words.insert(words.end(), {"--out", folder / out});
        const Ended ended = pelorus_command(words);
        INFO(ended.err);
        REQUIRE(ended.exit == 0);
        return Table(folder.read(out + "/tracks.csv"));
    };
    const Table simulated =
        run_one({"run", config, "--run", "0", "--variant", "expert", "--set", "world.duration=100 s", "--set",
                 "files={use: sink.csv, in: {tracks: tracker.tracks, scans: world.scans}}"},
                "simulated");
    std::string text = replay;
    const auto put = [&](const std::string& word, const std::string& with) {
        text.replace(text.find(word), word.size(), with);
    };
    put("CONFIG", config);
    put("RADAR", folder / "simulated/scans_radar.csv");
    put("EO", folder / "simulated/scans_eo.csv");
    const Table replayed = run_one({"run", folder.write("replay.yaml", text), "--run", "0"}, "replayed");
    REQUIRE(replayed.rows.size() == simulated.rows.size());
    REQUIRE(replayed.rows.size() > 200);
    for (std::size_t row = 0; row < replayed.rows.size(); ++row)
        for (const std::string column : {"time", "position.x", "position.y", "position.z", "velocity.x"}) {
            CAPTURE(row, column);
            CHECK(replayed.number(row, column) == Approx(simulated.number(row, column)).epsilon(1e-9).margin(1e-9));
        }
}
