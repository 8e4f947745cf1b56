// `pelorus inspect`: a plugin, a library, the graph of a config.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;
using Catch::StartsWith;
using Json = nlohmann::json;

namespace {

const char* const two_sensors = R"(
pelorus: 1
title: two "sensors" <in> a mast & a frame
frames: {mast: {translation: [0, 0, 20 m]}}
graph:
  world:
    use: source.simulation
    with: {scans: 10, period: 1000 ms}
    frame: mast
    parts:
      targets: {one: {use: trajectory.legs, with: {start: [-5 km, 2 km, 1 km], velocity: [20 m/s, 0, 0]}}}
      sensors:
        west: {use: sensor.position, with: {noise: 5 m, detection_probability: 95 %}}
        east: {use: sensor.spherical}
  tracker:
    use: tracker.point_target
    in: {scans: world.scans}
    frame: mast
    with: {maximum_speed: 300 m/s}
    parts:
      estimator:
        use: estimator.kalman
        parts:
          motion: {use: motion.constant_velocity}
          sensors: {west: {like: world.sensors.west}, east: {like: world.sensors.east}}
  errors:
    use: analyzer.tracking_error
    in: {tracks: previous(tracker.tracks), truth: world.truth}
    frame: mast
)";

struct Config {
    TemporaryFolder folder;
    std::string file = folder.write("two.yaml", two_sensors);
};

std::vector<std::string> shipped_ids() {
    std::vector<std::string> ids;
    for (const Json& plugin : Json::parse(shipped_command({"list", "--json"}).out)) ids.push_back(plugin["id"]);
    return ids;
}

}  // namespace

TEST_CASE("inspect: a plugin says where it may stand and how it is written") {
    const Ended singer = pelorus_command({"inspect", "motion.singer"});
    CHECK(singer.exit == 0);
    CHECK_THAT(singer.out, Contains("\nstands in\n") && Contains("estimator.kalman (slot motion)"));
    CHECK_THAT(
        singer.out,
        Contains("\nexample\n  motion:\n    use: motion.singer\n    with:\n      dimension: 3\n      form: exact\n"));
    const Ended tracker = pelorus_command({"inspect", "tracker.point_target"});
    CHECK_THAT(tracker.out, Contains("    in: {scans: source.scans}\n    with: {maximum_speed: 1 m/s}\n"));
    CHECK_THAT(tracker.out, Contains("there are: estimator.") && Contains("estimator.kalman"));
}

TEST_CASE("inspect: a model that needs parts shows the spaces of an instance that has some") {
    const Json kalman = Json::parse(pelorus_command({"inspect", "estimator.kalman", "--json"}).out);
    CHECK(kalman["example"]["parts"].contains("motion"));
    CHECK(kalman["instance"]["spaces"]["state"][0] == Json{{"name", "position.x"}, {"unit", "m"}});
    CHECK_THAT(pelorus_command({"inspect", "estimator.kalman"}).out, Contains("depend on its parts"));
}

TEST_CASE("inspect: the examples of all shipped plugins fit the schema, and of the models all but a few live",
          "[release-only]") {
    const TemporaryFolder folder;
    REQUIRE(pelorus_command({"schema", "--out", folder / "schema.json"}).exit == 0);
    std::vector<std::string> files, unavailable;
    for (const std::string& id : shipped_ids()) {
        const Json plugin = Json::parse(pelorus_command({"inspect", id, "--json"}).out);
        Json node = plugin["example"];
        if (plugin["tier"] == "model") {
            if (plugin["instance"].contains("unavailable")) unavailable.push_back(id);
            const Json& place = plugin["stands_in"][0];
            const std::string holder = place["plugin"], slot = place["slot"];
            node = Json::parse(pelorus_command({"inspect", holder, "--json"}).out)["example"];
            if (node["use"].get<std::string>().compare(0, 10, "estimator.") == 0) {
                Json tracker =
                    Json::parse(pelorus_command({"inspect", "tracker.point_target", "--json"}).out)["example"];
                node["parts"][slot] = plugin["example"];
                tracker["parts"]["estimator"] = node;
                node = tracker;
            } else {
                node["parts"][slot] = plugin["example"];
            }
        }
        files.push_back(folder.write(id + ".yaml", Json{{"pelorus", 1}, {"graph", {{"node", node}}}}.dump()));
    }
    // What no example can guess: one of two parameters, places of receivers, numbers an axis, a motion with few components.
    const std::vector<std::string> not_guessed{"estimator.gauss_hermite",  "sensor.tdoa",    "trajectory.legs",
                                               "trajectory.random_motion", "waveform.fixed", "waveform.lookahead"};
    CHECK(unavailable == not_guessed);
    const Ended valid = validate_configs(folder / "schema.json", files);
    CAPTURE(valid.out, valid.err);
    CHECK(valid.exit == 0);
}

TEST_CASE("inspect: a library shows all its plugins, wherever it lies") {
    const std::string library = PELORUS_PLUGIN_DIR "/motion/singer.so";
    CHECK(pelorus_command({"inspect", library}).out == pelorus_command({"inspect", "motion.singer"}).out);
    const Json list = Json::parse(pelorus_command({"inspect", library, "--json"}).out);
    REQUIRE(list.size() == 1);
    CHECK(list[0]["id"] == "motion.singer");

    const TemporaryFolder folder;
    const Ended missing = pelorus_command({"inspect", folder / "none.so"});
    CHECK(missing.exit == 2);
    CHECK_THAT(missing.err, Contains("none.so: there is no such file"));
    const Ended no_plugin = pelorus_command({"inspect", folder.write("text.so", "no library")});
    CHECK(no_plugin.exit == 2);
    CHECK_THAT(no_plugin.err, Contains("text.so: "));
}

TEST_CASE("inspect: a config is drawn as text") {
    const Config config;
    const Ended ended = pelorus_command({"inspect", config.file});
    REQUIRE(ended.exit == 0);
    CHECK(ended.err.empty());
    CHECK(ended.out ==
          "two \"sensors\" <in> a mast & a frame\n"
          "\n"
          "world: source.simulation, in frame 'mast'\n"
          "  scans: 10\n"
          "  targets\n"
          "    one: trajectory.legs\n"
          "      start: [-5 km, 2 km, 1 km], velocity: [20 m/s, 0, 0]\n"
          "  sensors\n"
          "    west: sensor.position\n"
          "      noise: 5 m, detection_probability: 95 %\n"
          "    east: sensor.spherical\n"
          "  scans (scan) -> tracker.scans\n"
          "      west: position.x,y,z [m], in frame 'mast'\n"
          "      east: range [m]; azimuth [rad]; elevation [rad], in frame 'mast'\n"
          "  truth (truth) -> errors.truth\n"
          "      position.x,y,z [m]; velocity.x,y,z [m/s]; acceleration.x,y,z [m/s2], in frame 'mast'\n"
          "\n"
          "tracker: tracker.point_target, in frame 'mast'\n"
          "  maximum_speed: 300 m/s\n"
          "  estimator: estimator.kalman\n"
          "    motion: motion.constant_velocity\n"
          "    sensors\n"
          "      west: sensor.position\n"
          "        noise: 5 m\n"
          "      east: sensor.spherical\n"
          "  scans <- world.scans\n"
          "  tracks (tracks) -> errors.tracks (feedback)\n"
          "      position.x,y,z [m]; velocity.x,y,z [m/s], in frame 'mast'\n"
          "\n"
          "errors: analyzer.tracking_error, in frame 'mast'\n"
          "  tracks <- previous(tracker.tracks)\n"
          "  truth <- world.truth\n");
    CHECK_THAT(pelorus_command({"inspect", config.file, "--set", "world.scans=7"}).out, Contains("  scans: 7\n"));
}

TEST_CASE("inspect: a config is drawn as a picture that Graphviz takes") {
    const Config config;
    const Ended dot = pelorus_command({"inspect", config.file, "--dot"});
    REQUIRE(dot.exit == 0);
    const Ended svg = run({"dot", "-Tsvg", config.folder.write("two.dot", dot.out)});
    CAPTURE(svg.err);
    CHECK(svg.exit == 0);
    CHECK(svg.err.empty());
    CHECK(count(svg.out, "class=\"node\"") == 3);
    CHECK(count(svg.out, "class=\"edge\"") == 3);
    CHECK(count(svg.out, "stroke-dasharray") > 0);
    CHECK_THAT(svg.out, Contains("sensors.east") && Contains("maximum_speed: 300 m/s") && Contains("&lt;in&gt;"));
}

TEST_CASE("inspect: a config as JSON has nodes, edges and what flows through them") {
    const Config config;
    const Json graph = Json::parse(pelorus_command({"inspect", config.file, "--json"}).out);
    CHECK(graph["nodes"][0]["name"] == "world");
    CHECK(graph["nodes"][0]["parts"][1] == Json{{"address", "world.sensors.west"},
                                                {"slot", "sensors"},
                                                {"name", "west"},
                                                {"use", "sensor.position"},
                                                {"with", {{"noise", "5 m"}, {"detection_probability", "95 %"}}},
                                                {"parts", Json::array()}});
    CHECK(graph["edges"][0]["from"] == "world.scans");
    CHECK(graph["edges"][0]["message"] == "scan");
    CHECK(graph["edges"][0]["streams"][1]["sensor"] == "east");
    CHECK(graph["edges"][0]["streams"][1]["space"][0] == Json{{"name", "range"}, {"unit", "m"}});
    CHECK(graph["edges"][1]["feedback"] == true);
}

TEST_CASE("inspect: what does not go together is refused") {
    const Config config;
    const auto refused = [](const std::vector<std::string>& arguments, const std::string& text) {
        CAPTURE(arguments);
        const Ended ended = pelorus_command(arguments);
        CHECK(ended.exit == 2);
        CHECK_THAT(ended.err, Contains(text));
    };
    refused({"inspect", "motion.singer", "--dot"},
            "--dot is for configs, and motion.singer is taken for a plugin's id");
    refused({"inspect", "motion.singer", "--set", "a.b=1"}, "--set is for configs");
    refused({"inspect", config.file, "--dot", "--json"}, "--dot and --json do not go together");
    refused({"inspect", "motion.singr"}, "did you mean motion.singer?");
    refused({"inspect", "nowhere.yaml"}, "nowhere.yaml: there is no such file");
    refused({"inspect", config.file, "--set", "world.scans=0"}, "world.scans: must be at least 1");
}
