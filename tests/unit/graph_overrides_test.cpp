#include <catch2/catch.hpp>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graph_fakes.hpp"

using namespace pelorus;
using fakes::FakePlugins;

namespace {

struct Pipeline : FakePlugins {
    Pipeline() { fakes::add_pipeline(*this); }

    /// The resolved graph after overrides.
    nlohmann::ordered_json after(const std::vector<graph::Override>& overrides,
                                 const std::string& yaml = fakes::pipeline()) {
        return build(yaml, overrides).resolved()["graph"];
    }
    std::string refused(const std::string& address, const std::string& text) {
        return problems(fakes::pipeline(), {{address, text}});
    }
};

}  // namespace

TEST_CASE("An override reaches parameters of nodes and parts, written in the file or not", "[graph][overrides]") {
    Pipeline plugins;
    CHECK(plugins.after({{"world.scans", "5"}})["world"]["with"]["scans"] == 5);
    CHECK(plugins.after({{"tracker.threshold", "3 km"}})["tracker"]["with"]["threshold"] == 3000.0);
    CHECK(plugins.after({{"tracker.estimator.motion.form",
                          "exact"}})["tracker"]["parts"]["estimator"]["parts"]["motion"]["with"]["form"] == "exact");
    CHECK(plugins.after({{"tracker.estimator.motion.rate",
                          "2 1/s"}})["tracker"]["parts"]["estimator"]["parts"]["motion"]["with"]["rate"] == 2.0);
    const auto json =
        plugins.after({{"world.sensors.radar.period", "4 s"}, {"world.sensors.radar.detection_probability", "50 %"}});
    CHECK(json["world"]["parts"]["sensors"]["radar"]["with"]["period"] == 4.0);
    CHECK(json["world"]["parts"]["sensors"]["radar"]["with"]["detection_probability"] == 0.5);
}

TEST_CASE("What a part is like follows the overrides of the other part, and its own go over it", "[graph][overrides]") {
    Pipeline plugins;
    const auto noise = [](const nlohmann::ordered_json& graph) {
        return std::vector<double>{
            graph["world"]["parts"]["sensors"]["radar"]["with"]["noise"],
            graph["tracker"]["parts"]["estimator"]["parts"]["sensors"]["radar"]["with"]["noise"]};
    };
    CHECK(noise(plugins.after({})) == std::vector<double>{2, 2});
    CHECK(noise(plugins.after({{"world.sensors.radar.noise", "5m"}})) == std::vector<double>{5, 5});
    CHECK(noise(plugins.after({{"tracker.estimator.sensors.radar.noise", "5m"}})) == std::vector<double>{2, 5});
    CHECK(noise(plugins.after({{"tracker.estimator.sensors.radar.noise", "~"}})) == std::vector<double>{2, 1});
    CHECK(noise(plugins.after({{"world.sensors.radar.noise", "~"}})) == std::vector<double>{1, 1});
}

TEST_CASE("An override goes through a part that is like another, down to parts that are not written there",
          "[graph][overrides]") {
    Pipeline plugins;
    std::string yaml = fakes::pipeline();
    yaml.insert(yaml.find("      estimator:"), "      second: {like: tracker.estimator}\n");
    const auto second = [&](const std::string& address, const std::string& text) {
        return plugins.after({{address, text}}, yaml)["tracker"]["parts"]["second"]["parts"].dump();
    };
    CHECK(
        second("tracker.second.motion.form", "exact") ==
        R"({"motion":{"use":"motion.fake","with":{"form":"exact","rate":0.1}},"sensors":{"radar":{"use":"sensor.fake","with":{"noise":2.0}}}})");
    CHECK(
        second("tracker.second.sensors.radar.noise", "7") ==
        R"({"motion":{"use":"motion.fake","with":{"form":"truncated","rate":0.1}},"sensors":{"radar":{"use":"sensor.fake","with":{"noise":7.0}}}})");
    CHECK(
        second("tracker.second.sensors", "{lidar: {use: sensor.fake}, radar: ~}") ==
        R"({"motion":{"use":"motion.fake","with":{"form":"truncated","rate":0.1}},"sensors":{"lidar":{"use":"sensor.fake","with":{"noise":1.0}}}})");
    CHECK(plugins.problems(yaml, {{"tracker.second.motion", "~"}}) ==
          "test.yaml:15:22: tracker.second: the slot 'motion' takes 1 (kind motion), got 0");
}

TEST_CASE("A map replaces a part whole, ~ removes, and the last override wins", "[graph][overrides]") {
    Pipeline plugins;
    CHECK(plugins
              .after({{"tracker.estimator.motion",
                       "{use: motion.fake, with: {rate: 9}}"}})["tracker"]["parts"]["estimator"]["parts"]["motion"]
              .dump() == R"({"use":"motion.fake","with":{"form":"exact","rate":9.0}})");
    const auto two = plugins.after({{"world.sensors.lidar", "{use: sensor.fake}"}, {"world.sensors.lidar.noise", "3"}});
    CHECK(two["world"]["parts"]["sensors"].size() == 2);
    CHECK(two["world"]["parts"]["sensors"]["lidar"]["with"]["noise"] == 3.0);
    CHECK(plugins.after({{"world.sensors.lidar.use", "sensor.fake"}})["world"]["parts"]["sensors"].size() == 2);
    CHECK(plugins.after({{"errors", "~"}}).size() == 2);
    CHECK(plugins.after({{"more", "{use: analyzer.fake, in: {tracks: tracker.tracks}}"}})["more"]["use"] ==
          "analyzer.fake");
    CHECK(plugins.after({{"world.scans", "~"}})["world"]["with"]["scans"] == 10);
    CHECK(plugins.after({{"world.period", "~"}})["world"]["with"]["period"] == 1.0);
    CHECK(plugins.after({{"world.scans", "5"}, {"world.scans", "6"}})["world"]["with"]["scans"] == 6);
    CHECK(plugins
              .after({{"tracker.second.use", "estimator.fake"},
                      {"tracker.second.motion.use", "motion.fake"},
                      {"tracker.second.sensors.radar.like",
                       "world.sensors.radar"}})["tracker"]["parts"]["second"]["parts"]["sensors"]["radar"]
              .dump() == R"({"use":"sensor.fake","with":{"noise":2.0}})");
}

TEST_CASE("Plugins, edges and frames can be overridden", "[graph][overrides]") {
    Pipeline plugins;
    plugins.add("motion.other", "motion").parameter("rate", PLR_TYPE_DOUBLE).initially("4");
    CHECK(plugins
              .after({{"tracker.estimator.motion.use", "motion.other"},
                      {"tracker.estimator.motion.form", "~"}})["tracker"]["parts"]["estimator"]["parts"]["motion"]
              .dump() == R"({"use":"motion.other","with":{"rate":4.0}})");
    CHECK(plugins.after({{"world.in.commands", "previous(tracker.commands)"}})["world"]["in"].dump() ==
          R"-({"commands":"previous(tracker.commands)"})-");
    CHECK(plugins.after({{"errors.in.truth", "~"}})["errors"]["in"].dump() == R"({"tracks":"tracker.tracks"})");
    CHECK(plugins.after({{"errors.in", "{tracks: tracker.tracks}"}})["errors"]["in"].size() == 1);
    CHECK(plugins.refused("tracker.frame", "site") ==
          "--set tracker.frame=site: tracker.frame: there is no frame 'site'; it has no frames");
}

TEST_CASE("An address that leads nowhere is refused with the nearest", "[graph][overrides]") {
    Pipeline plugins;
    const std::string radar = "--set world.sensors.radar";
    CHECK(plugins.refused("wrld.scans", "3") ==
          "--set wrld.scans=3: there is no node 'wrld'; did you mean 'world'? nodes: world, tracker, errors");
    CHECK(plugins.refused("world.sensor.radar.noise", "3") ==
          "--set world.sensor.radar.noise=3: source.fake has no slot 'sensor'; did you mean 'sensors'? slots: sensors");
    CHECK(plugins.refused("world.radar.noise", "3") ==
          "--set world.radar.noise=3: source.fake has no slot 'radar'; did you mean 'world.sensors.radar.noise'?");
    CHECK(plugins.refused("tracker.motion.rate", "3") ==
          "--set tracker.motion.rate=3: tracker.fake has no slot 'motion'; did you mean "
          "'tracker.estimator.motion.rate'?");
    CHECK(plugins.refused("world.sensors.rader.noise", "3") ==
          "--set world.sensors.rader.noise=3: there is no part 'rader' in the slot 'sensors'; did you mean 'radar'? "
          "parts: radar");
    CHECK(plugins.refused("world.sensors.radar.nois", "3") ==
          radar +
              ".nois=3: world.sensors.radar: sensor.fake has no parameter 'nois'; did you mean 'noise'? parameters: "
              "noise, "
              "detection_probability, period");
    CHECK(plugins.refused("world.sensors.radar.noise", "3 s") ==
          radar + ".noise=3 s: world.sensors.radar.noise: expected a value in m, got '3 s' (s is a time)");
    CHECK(plugins.refused("world.scans.x", "3") ==
          "--set world.scans.x=3: 'scans' is a parameter of source.fake: nothing stands below it");
    CHECK(plugins.refused("world.scans", "{a: 1}") ==
          "--set world.scans={a: 1}: 'scans' is a parameter of source.fake: a map is no value for it");
    CHECK(plugins.refused("tracker.second.motion.rate", "3") ==
          "--set tracker.second.motion.rate=3: the slot 'second' is empty");
    CHECK(plugins.refused("tracker", "3") ==
          "--set tracker=3: 'tracker' is a node: expected a map such as {use: PLUGIN}, or ~ to remove it, got '3'");
    CHECK(plugins.refused("world.sensors", "3") ==
          "--set world.sensors=3: 'world.sensors' is a slot: expected a map such as {use: PLUGIN}, or ~ to empty it, "
          "got '3'");
    CHECK(plugins.refused("world.sensors.radar", "3") ==
          "--set world.sensors.radar=3: 'world.sensors.radar' is a part: expected a map such as {use: PLUGIN}, or ~ to "
          "remove it, got '3'");
    CHECK(plugins.refused("gone", "~") == "--set gone=~: there is no node 'gone'; nodes: world, tracker, errors");
    CHECK(plugins.refused("errors.in.trth", "~") ==
          "--set errors.in.trth=~: nothing is connected to 'trth'; did you mean 'truth'? ports: tracks, truth");
    CHECK(plugins.refused("errors.in.a.b", "x") ==
          "--set errors.in.a.b=x: 'errors.in.a.b' is not an address: expected NODE.in.PORT");
    CHECK(plugins.refused("errors.in", "x") ==
          "--set errors.in=x: 'errors.in': expected a map from port to node.port, got 'x'");
    CHECK(plugins.refused("world..scans", "3") ==
          "--set world..scans=3: 'world..scans' is not an address: node, slot, part, parameter, joined by dots");
    CHECK(plugins.refused("", "3") == "--set =3: '' is not an address: node, slot, part, parameter, joined by dots");
    CHECK(plugins.refused("run", "3") == "--set run=3: expected run.seed, got 'run'");
    CHECK(plugins.refused("run.sed", "3") ==
          "--set run.sed=3: run: unknown key 'sed'; did you mean 'seed'? keys: seed");
}

TEST_CASE("A path parameter of a map on the command line is relative to the working directory", "[graph][overrides]") {
    Pipeline plugins;
    plugins["analyzer.fake"].parameter("file", PLR_TYPE_PATH).initially("a.csv");
    const auto file = [&](const std::vector<graph::Override>& overrides) {
        return plugins.after(overrides)["errors"]["with"]["file"].get<std::string>();
    };
    const std::filesystem::path here = std::filesystem::current_path();
    CHECK(file({}) == "/configs/a.csv");
    CHECK(file({{"errors.file", "b.csv"}}) == (here / "b.csv").string());
    CHECK(file({{"errors", "{use: analyzer.fake, in: {tracks: tracker.tracks}, with: {file: c.csv}}"}}) ==
          (here / "c.csv").string());
}

TEST_CASE("An unknown plugin does not hide where an override leads", "[graph][overrides]") {
    Pipeline plugins;
    CHECK(plugins.problems(fakes::pipeline(),
                           {{"tracker.estimator.motion.use", "motion.gone"}, {"tracker.estimator.motion.x", "3"}}) ==
          "--set tracker.estimator.motion.use=motion.gone: tracker.estimator.motion: no plugin motion.gone");
}
