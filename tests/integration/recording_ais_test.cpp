// configs/ais_harbour.yaml: real AIS reports. The recording is found through PELORUS_DATA; without it these tests say so and pass.
#include <cstdlib>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;

namespace {

const std::string config = std::string(PELORUS_SOURCE_DIR) + "/configs/ais_harbour.yaml";

bool is_there() {
    const char* data = std::getenv("PELORUS_DATA");
    if (data != nullptr && std::filesystem::exists(std::filesystem::path(data) / "SolentAIS_20160112_130211.csv"))
        return true;
    WARN("skipped: PELORUS_DATA names no folder with SolentAIS_20160112_130211.csv");
    return false;
}

}  // namespace

TEST_CASE("The AIS config names the variable that it needs", "[recording]") {
    ProcessOptions without;
    without.environment["PELORUS_DATA"] = "";
    const Ended ended = pelorus_command({"run", config}, without);
    CHECK(ended.exit == 2);
    CHECK(count(ended.err, "\n") == 1);
    CHECK_THAT(ended.err, Catch::Contains("source.file: environment variable PELORUS_DATA is not set"));
}

TEST_CASE("Vessels are followed through their AIS reports without knowing who reports", "[recording]") {
    if (!is_there()) return;
    const TemporaryFolder folder;
    const Ended ended = pelorus_command({"run", config, "--out", folder / "out"});
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    const auto summary = nlohmann::json::parse(folder.read("out/summary.json"));
    const auto scalar = [&](const std::string& name) {
        return summary["cells"][0]["scalars"]["identity." + name]["value"].get<double>();
    };
    CHECK(scalar("identities") == 91);
    CHECK(scalar("reports") == 18623);
    CHECK(scalar("identities_tracked") >= 85);
    CHECK(scalar("tracked_share") > 0.95);
    CHECK(scalar("purity") > 0.86);
    CHECK(scalar("tracks") < 180);
    CHECK(scalar("switches") < 320);
    CHECK(summary["cells"][0]["tables"]["identity.by_identity"]["rows"].size() == 91);

    const auto map = nlohmann::json::parse(folder.read("out/tracks.geojson"));
    CHECK(static_cast<double>(map["features"].size()) == scalar("tracks"));
    for (const auto& feature : map["features"]) {
        const auto& geometry = feature["geometry"];
        const auto& first = geometry["type"] == "Point" ? geometry["coordinates"] : geometry["coordinates"][0];
        CHECK(first[0].get<double>() == Approx(-1.05).margin(0.4));
        CHECK(first[1].get<double>() == Approx(50.7).margin(0.3));
    }

    // The tracker does the same where nobody knows identities.
    const Ended blind = pelorus_command({"run", config, "--out", folder / "blind", "--set", "source.identity=~",
                                         "--set", "identity=~", "--set", "files.in.truth=~"});
    INFO(blind.err);
    REQUIRE(blind.exit == 0);
    CHECK(folder.read("blind/tracks.csv") == folder.read("out/tracks.csv"));
}
