// --json: what programs read, in good days and bad.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

const std::string airship = PELORUS_SOURCE_DIR "/configs/airship.yaml";

Json json_of(const std::vector<std::string>& arguments, int exit) {
    CAPTURE(arguments);
    const Ended ended = pelorus_command(arguments);
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == exit);
    const Json json = Json::parse(ended.out, nullptr, false);
    REQUIRE_FALSE(json.is_discarded());
    return json;
}

}  // namespace

TEST_CASE("check --json tells nodes, edges and plugins") {
    const Json json = json_of({"check", airship, "--json"}, 0);
    CHECK(json["config"] == airship);
    CHECK(json["nodes"].size() == 5);
    CHECK(json["edges"][0]["to"] == "tracker.scans");
    CHECK(json["plugins"][0]["id"] == "analyzer.shape_error");
    CHECK(json["campaign"]["runs"] == 200);
    CHECK(json["campaign"]["cells"][0]["sweep"]["world.sensors.radar.noise"] == 0.2);
    CHECK_FALSE(json.contains("error"));
}

TEST_CASE("check --json tells every problem with its place") {
    const TemporaryFolder folder;
    const std::string file =
        folder.write("wrong.yaml", "pelorus: 1\ntitel: x\ngraph:\n  world: {use: sorce.nothing}\n");
    const Json json = json_of({"check", file, "--json"}, 2);
    CHECK(json["exit"] == 2);
    REQUIRE(json["problems"].size() == 2);
    CHECK(json["problems"][0]["file"] == file);
    CHECK(json["problems"][0]["line"] == 2);
    CHECK(json["problems"][0]["column"] == 1);
    CHECK_THAT(json["problems"][0]["message"].get<std::string>(), Contains("unknown key 'titel'"));
    CHECK(json["problems"][1]["line"] == 4);
    CHECK_THAT(json["error"].get<std::string>(), Contains("wrong.yaml:2:1: unknown key"));
    CHECK_THAT(pelorus_command({"check", file, "--json"}).err, Contains("wrong.yaml:4:"));
}

TEST_CASE("run --json tells the figures and the files") {
    const TemporaryFolder folder;
    const Json json =
        json_of({"run", airship, "--run", "0", "--out", folder / "out", "--set", "world.scans=20", "--json"}, 0);
    CHECK(json["completed"] == true);
    CHECK(json["folder"] == folder / "out");
    CHECK(json["summary"] == Json::parse(read_file(folder / "out/summary.json")));
    CHECK_THAT(json["files"].get<std::vector<std::string>>(), Catch::VectorContains(std::string("tracks.csv")));
}

TEST_CASE("every command that fails says so in JSON if asked for it") {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"inspect", "motion.singr", "--json"},
                                                      {"list", "--kind", "motoin", "--json"},
                                                      {"run", "nowhere.yaml", "--json"},
                                                      {"new", "motion", "Bad", "--json"},
                                                      {"rum", "--json"}}) {
        const Json json = json_of(arguments, 2);
        CHECK_FALSE(json["error"].get<std::string>().empty());
        CHECK(json["exit"] == 2);
        CHECK(json["problems"].is_array());
    }
    CHECK(pelorus_command({"inspect", "motion.singr"}).out.empty());
}

TEST_CASE("new and --version answer in JSON") {
    const TemporaryFolder folder;
    const Json made = json_of({"new", "motion", "drag", "--dir", folder.path().string(), "--json"}, 0);
    CHECK(made["id"] == "org.example.motion.drag");
    CHECK(made["folder"] == folder / "drag");
    CHECK_THAT(made["files"].get<std::vector<std::string>>(), Catch::VectorContains(std::string("drag.cpp")));
    CHECK(json_of({"--version", "--json"}, 0)["version"] == PELORUS_VERSION);
}
