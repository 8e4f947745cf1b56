// configs/recorded_radar.yaml: a recording goes through a pipeline made of plugins.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;

namespace {

const std::string config = std::string(PELORUS_SOURCE_DIR) + "/configs/recorded_radar.yaml";
const std::string recording = std::string(PELORUS_SOURCE_DIR) + "/configs/data/radar_recording.csv.gz";

double scalar(const nlohmann::json& summary, const std::string& name) {
    return summary["cells"][0]["scalars"][name]["value"].get<double>();
}

}  // namespace

TEST_CASE("The recorded radar's aircraft are all followed, by one pure track each", "[recording]") {
    const TemporaryFolder folder;
    const Ended ended = pelorus_command({"run", config, "--out", folder / "out"});
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    const auto summary = nlohmann::json::parse(folder.read("out/summary.json"));
    CHECK(scalar(summary, "identity.identities") == 7);
    CHECK(scalar(summary, "identity.tracks") == 7);
    CHECK(scalar(summary, "identity.switches") == 0);
    CHECK(scalar(summary, "identity.purity") == 1);
    CHECK(scalar(summary, "identity.tracked_share") > 0.97);
    CHECK(scalar(summary, "errors.position_rmse") < 80);  // a plot's: 110 m and more at 30 km
    CHECK(scalar(summary, "errors.track_count") == 7);
    const auto& table = summary["cells"][0]["tables"]["identity.by_identity"];
    CHECK(table["rows"].size() == 7);
    CHECK(table["rows"][0][0] == 1001);

    const std::string tracks = folder.read("out/tracks.csv");
    CHECK_THAT(tracks, Catch::StartsWith("time,id,status,misses,position.x,position.y,position.z,velocity.x,"));
    CHECK(count(tracks, "\n") > 900);
    CHECK(count(folder.read("out/truth.csv"), "\n") == 1 + 150 * 4 + 130 + 110 + 150);
}

TEST_CASE("The recorded radar's results are the same bytes again, and after a resume half-way", "[recording]") {
    const TemporaryFolder folder;
    const auto go = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"run", config});
        const Ended ended = pelorus_command(arguments);
        INFO(ended.err);
        REQUIRE(ended.exit == 0);
    };
    go({"--out", folder / "whole"});
    go({"--out", folder / "again"});
    go({"--out", folder / "half", "--snapshot-at", "150 s", "--stop-at-snapshot"});
    CHECK(folder.read("half/tracks.csv").size() < folder.read("whole/tracks.csv").size());
    go({"--out", folder / "elsewhere", "--resume", folder / "half"});
    go({"--resume", folder / "half"});
    for (const std::string run : {"again", "elsewhere", "half"})
        for (const std::string file : {"summary.json", "tracks.csv", "truth.csv"}) {
            INFO(run << "/" << file);
            CHECK(folder.read(run + "/" + file) == folder.read("whole/" + file));
        }
}

TEST_CASE("A recording that is not there, or is broken, is told by name before or when it matters", "[recording]") {
    const TemporaryFolder folder;
    const Ended missing = pelorus_command({"check", config, "--set", "radar.file=/nowhere/plots.csv"});
    CHECK(missing.exit == 2);
    CHECK(count(missing.err, "cannot read /nowhere/plots.csv: No such file or directory") == 1);

    const std::string bytes = read_file(recording);
    const std::string torn = folder.write("torn.gz", bytes.substr(0, bytes.size() / 2));
    const Ended stopped = pelorus_command({"run", config, "--set", "radar.file=" + torn, "--out", folder / "stopped"});
    CHECK(stopped.exit == 1);
    CHECK(count(stopped.err, "the compressed data end early") == 1);
    CHECK(count(folder.read("stopped/tracks.csv"), "\n") > 100);  // what there was is kept

    const Ended skipped = pelorus_command(
        {"run", config, "--set", "radar.file=" + torn, "--set", "radar.bad_rows=skip", "--out", folder / "skipped"});
    CHECK(skipped.exit == 0);
    CHECK(count(skipped.err, "the compressed data end early; the row is left out") == 1);
}

TEST_CASE("The radar recording is what its script makes", "[recording]") {
    const TemporaryFolder folder;
    const std::string script = std::string(PELORUS_SOURCE_DIR) + "/configs/data/make_radar_recording.py";
    const Ended python = run({"sh", "-c", "python3 '" + script + "' | gzip -dc > '" + (folder / "made.csv") + "'"});
    if (run({"sh", "-c", "command -v python3"}).exit != 0) {
        WARN("skipped: there is no python3");
        return;
    }
    REQUIRE(python.exit == 0);
    REQUIRE(run({"sh", "-c", "gzip -dc '" + recording + "' > '" + (folder / "shipped.csv") + "'"}).exit == 0);
    CHECK(folder.read("made.csv") == folder.read("shipped.csv"));
    CHECK(std::filesystem::file_size(recording) < 200'000);
}
