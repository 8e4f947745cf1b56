#include <catch2/catch.hpp>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graph_fakes.hpp"

using namespace pelorus;
using fakes::FakePlugin;
using fakes::FakePlugins;

namespace {

struct Pipeline : FakePlugins {
    Pipeline() { fakes::add_pipeline(*this); }
};

/// A tracker whose slot `estimator` holds the given text.
std::string tracker_with(const std::string& parts) {
    return R"(pelorus: 1
graph:
  world: {use: source.fake, parts: {sensors: {radar: {use: sensor.fake, with: {noise: 2 m, detection_probability: 0.5}}}}}
  tracker:
    use: tracker.fake
    in: {scans: world.scans}
    parts:
)" + parts;
}

const std::string good_estimator =
    "      estimator: {use: estimator.fake, parts: {motion: {use: motion.fake}, sensors: {radar: {like: "
    "world.sensors.radar}}}}\n";

}  // namespace

TEST_CASE("A pipeline of nodes and parts is built", "[graph][parts]") {
    Pipeline plugins;
    const graph::Graph graph = plugins.build(fakes::pipeline());
    CHECK(graph.title() == "a test");
    CHECK(graph.seed() == 7);
    REQUIRE(graph.nodes().size() == 3);
    CHECK(graph.nodes()[1].name == "tracker");
    CHECK(graph.nodes()[1].where.text() == "test.yaml:11:3");
    CHECK(std::string(graph.nodes()[1].config->address) == "tracker");
    CHECK(graph.nodes()[1].host->address() == "tracker");
    std::vector<std::string> ids;
    for (const host::LoadedPlugin* plugin : graph.plugins()) ids.emplace_back(plugin->description().id);
    CHECK(ids == std::vector<std::string>{"analyzer.fake", "estimator.fake", "motion.fake", "sensor.fake",
                                          "source.fake", "tracker.fake"});
}

TEST_CASE("A holder sees its parts by slot and name, with the slot's values", "[graph][parts]") {
    Pipeline plugins;
    std::vector<std::string> seen;
    std::vector<double> values;
    plugins["source.fake"].on_create = [&](const plr_config& config, plr_error&) {
        for (std::uint32_t i = 0; i < config.part_count; ++i) {
            const plr_part& part = config.parts[i];
            seen.push_back(std::string(part.slot) + "/" + part.name + "/" + part.address + "/" + part.table_id + "/" +
                           part.description->id);
            REQUIRE(part.value_count == 2);
            values.push_back(part.values[0].number);
            CHECK(part.instance.table != nullptr);
            CHECK(part.values[1].present == 0);
        }
        return PLR_OK;
    };
    plugins["estimator.fake"].on_create = [&](const plr_config& config, plr_error&) {
        REQUIRE(config.part_count == 2);
        CHECK(std::string(config.parts[0].slot) == "motion");
        CHECK(std::string(config.parts[0].name).empty());
        CHECK(std::string(config.parts[0].address) == "tracker.estimator.motion");
        CHECK(std::string(config.parts[1].name) == "radar");
        CHECK(config.parts[1].value_count == 0);
        return PLR_OK;
    };
    const graph::Graph graph = plugins.build(fakes::pipeline());
    CHECK(seen == std::vector<std::string>{"sensors/radar/world.sensors.radar/" PLR_SENSOR "/sensor.fake"});
    CHECK(values == std::vector<double>{0.9});
}

TEST_CASE("Parts come by slots of the description and, within one, in the order of the file", "[graph][parts]") {
    Pipeline plugins;
    std::vector<std::string> seen;
    plugins["estimator.fake"].on_create = [&](const plr_config& config, plr_error&) {
        for (std::uint32_t i = 0; i < config.part_count; ++i) seen.emplace_back(config.parts[i].address);
        return PLR_OK;
    };
    plugins.build(tracker_with(
        "      estimator:\n        use: estimator.fake\n        parts:\n"
        "          sensors: {z: {use: sensor.fake}, a: {use: sensor.fake}}\n          motion: {use: motion.fake}\n"));
    CHECK(seen == std::vector<std::string>{"tracker.estimator.motion", "tracker.estimator.sensors.z",
                                           "tracker.estimator.sensors.a"});
}

TEST_CASE("A part that is like another takes plugin and own parameters, not the slot's", "[graph][parts]") {
    Pipeline plugins;
    std::map<std::string, double> noise;
    plugins["sensor.fake"].on_create = [&](const plr_config& config, plr_error&) {
        noise[config.address] = config.values[0].number;
        return PLR_OK;
    };
    const graph::Graph graph = plugins.build(
        tracker_with(good_estimator +
                     "      second:\n        use: estimator.fake\n        parts:\n          motion: {like: "
                     "tracker.estimator.motion}\n"
                     "          sensors: {radar: {like: tracker.estimator.sensors.radar, with: {noise: 3 m}}}\n"));
    CHECK(noise["world.sensors.radar"] == 2);
    CHECK(noise["tracker.estimator.sensors.radar"] == 2);
    CHECK(noise["tracker.second.sensors.radar"] == 3);
    CHECK(graph.resolved()["graph"]["tracker"]["parts"]["second"]["parts"]["motion"].dump() ==
          R"({"use":"motion.fake","with":{"form":"exact","rate":0.1}})");
}

TEST_CASE("A part that is like another takes its parts too, and may change them", "[graph][parts]") {
    Pipeline plugins;
    std::map<std::string, std::string> forms;
    plugins["motion.fake"].on_create = [&](const plr_config& config, plr_error&) {
        forms[config.address] = config.values[0].text;
        return PLR_OK;
    };
    plugins.build(tracker_with(
        good_estimator + "      second: {like: tracker.estimator, parts: {motion: {with: {form: truncated}}}}\n"));
    CHECK(forms["tracker.estimator.motion"] == "exact");
    CHECK(forms["tracker.second.motion"] == "truncated");
}

TEST_CASE("A like that leads nowhere, to itself or in a circle is refused", "[graph][parts]") {
    Pipeline plugins;
    const auto second = [&](const std::string& like) {
        return plugins.problems(tracker_with(good_estimator + "      second: {like: " + like + "}\n"));
    };
    CHECK(second("wrld.sensors.radar") ==
          "test.yaml:9:22: tracker.second: 'wrld.sensors.radar' leads nowhere: there is no node 'wrld'; did you mean "
          "'world'? "
          "nodes: world, tracker");
    CHECK(second("world.sensor.radar") ==
          "test.yaml:9:22: tracker.second: 'world.sensor.radar' leads nowhere: world has no part in a slot 'sensor'; "
          "did you mean "
          "'sensors'? parts: sensors");
    CHECK(second("world.sensors.rader") ==
          "test.yaml:9:22: tracker.second: 'world.sensors.rader' leads nowhere: there is no part 'rader' in "
          "world.sensors; did you "
          "mean 'radar'? parts: radar");
    CHECK(second("world.sensors") ==
          "test.yaml:9:22: tracker.second: 'world.sensors' is a slot, expected the address of a part in it: radar");
    CHECK(second("world") == "test.yaml:9:22: tracker.second: 'world' is a node, expected the address of a part");
    CHECK(second("tracker.second") ==
          "test.yaml:9:22: tracker.second: 'tracker.second' cannot be like 'tracker.second', which is itself");
    CHECK(second("world.sensors.radar") ==
          "test.yaml:9:22: tracker.second: sensor.fake is a sensor; slot second takes an estimator");
    CHECK(second("tracker.estimator, use: estimator.fake") ==
          "test.yaml:9:22: tracker.second: give `use` or `like`, not both");
    CHECK(plugins.problems(
              tracker_with("      estimator: {like: tracker.second}\n      second: {like: tracker.estimator}\n")) ==
          "test.yaml:8:25: tracker.estimator: parts are like each other in a circle: tracker.second -> "
          "tracker.estimator -> tracker.second\n"
          "test.yaml:9:22: tracker.second: parts are like each other in a circle: tracker.estimator -> tracker.second "
          "-> tracker.estimator");
    CHECK(plugins.problems(
              tracker_with("      estimator: {use: estimator.fake, parts: {motion: {like: tracker.estimator}}}\n")) ==
          "test.yaml:8:63: tracker.estimator.motion: 'tracker.estimator.motion' cannot be like 'tracker.estimator', "
          "which holds it\n"
          "test.yaml:8:24: tracker.estimator: the slot 'sensors' takes at least 1 (kind sensor), got 0");
}

TEST_CASE("Parts that multiply by likeness come to an end", "[graph][parts]") {
    Pipeline plugins;
    FakePlugin& nested = plugins.add("estimator.nested", "estimator");
    nested.slot("parts_of_it", "estimator", 0, -1);
    std::string yaml =
        "pelorus: 1\ngraph:\n  t:\n    use: tracker.many\n    parts:\n      estimators:\n        e0: {use: "
        "estimator.nested}\n";
    plugins.add("tracker.many", "tracker").slot("estimators", "estimator", 0, -1);
    for (int i = 1; i < 20; ++i) {
        const std::string like = "{like: t.estimators.e" + std::to_string(i - 1) + "}";
        yaml += "        e" + std::to_string(i) + ": {use: estimator.nested, parts: {parts_of_it: {a: " + like +
                ", b: " + like + "}}}\n";
    }
    CHECK(plugins.problems(yaml).find("more than 10000 parts") != std::string::npos);
    CHECK(plugins.created.empty());
}

TEST_CASE("Slots refuse other kinds, too few, too many and unknown ones", "[graph][parts]") {
    Pipeline plugins;
    CHECK(plugins.problems(
              tracker_with("      estimator: {use: estimator.fake, parts: {motion: {use: estimator.fake}}}\n")) ==
          "test.yaml:8:62: tracker.estimator.motion: estimator.fake is an estimator; slot motion takes a motion\n"
          "test.yaml:8:24: tracker.estimator: the slot 'sensors' takes at least 1 (kind sensor), got 0");
    CHECK(plugins.problems(tracker_with("      {}\n")) ==
          "test.yaml:5:10: tracker: the slot 'estimator' takes 1 (kind estimator), got 0");
    CHECK(plugins.problems(tracker_with(
              good_estimator + "      second: {a: {like: tracker.estimator}, b: {like: tracker.estimator}}\n")) ==
          "test.yaml:9:7: tracker: the slot 'second' takes at most 1 (kind estimator), got 2");
    CHECK(plugins.problems(tracker_with(good_estimator + "      secnd: {like: tracker.estimator}\n")) ==
          "test.yaml:9:7: tracker: tracker.fake has no slot 'secnd'; did you mean 'second'? slots: estimator, second");
    CHECK(plugins.problems(tracker_with("      estimator: estimator.fake\n")) ==
          "test.yaml:8:18: tracker.estimator: expected a map such as {use: PLUGIN}, or from names to such maps, got "
          "'estimator.fake'");
    CHECK(plugins.problems(tracker_with("      estimator: {a: estimator.fake}\n")) ==
          "test.yaml:8:22: tracker.estimator.a: expected a map such as {use: PLUGIN}, got 'estimator.fake'");
    CHECK(plugins.problems(tracker_with(good_estimator + "      second: {2nd: {like: tracker.estimator}}\n")) ==
          "test.yaml:9:16: tracker.second: '2nd' cannot name a part: letters, digits and _ only, and no digit first");
}

TEST_CASE("A slot's parameter that the part has itself is refused", "[graph][parts]") {
    Pipeline plugins;
    plugins["sensor.fake"].parameter("period", PLR_TYPE_DOUBLE).initially("1");
    CHECK(plugins.problems(tracker_with(good_estimator)) ==
          "test.yaml:3:60: world.sensors.radar: the slot 'sensors' and sensor.fake both have a parameter 'period'");
}

TEST_CASE("A slot's parameter stands where the slot declares it, and nowhere else", "[graph][parts]") {
    Pipeline plugins;
    CHECK(plugins.problems(tracker_with(
              "      estimator: {use: estimator.fake, parts: {motion: {use: motion.fake}, sensors: {radar: {use: "
              "sensor.fake, with: {detection_probability: 1}}}}}\n")) ==
          "test.yaml:8:119: tracker.estimator.sensors.radar: sensor.fake has no parameter 'detection_probability'; "
          "parameters: noise");
}

TEST_CASE("Keys of nodes and parts are checked, with a hint where they belong", "[graph][parts]") {
    Pipeline plugins;
    CHECK(plugins.problems(R"(pelorus: 1
graph:
  world:
    use: source.fake
    wiht: {scans: 3}
    period: 3 s
    sensors: {radar: {use: sensor.fake}}
    parts: {sensors: {radar: {use: sensor.fake, like: world.sensors.radar, in: {}}}}
)") == "test.yaml:5:5: world: unknown key 'wiht'; did you mean 'with'? keys of a node: use, frame, in, with, parts\n"
       "test.yaml:6:5: world: unknown key 'period'; parameters stand under `with`\n"
       "test.yaml:7:5: world: unknown key 'sensors'; slots stand under `parts`\n"
       "test.yaml:8:76: world.sensors.radar: unknown key 'in'; keys of a part: use, like, with, parts\n"
       "test.yaml:8:55: world.sensors.radar: give `use` or `like`, not both");
}

TEST_CASE("Keys that stand under with, and words of other programs, are put right", "[graph][parts]") {
    Pipeline plugins;
    const std::string before = "pelorus: 1\ngraph:\n  world: {use: source.fake, ";
    const std::string sensors = "parts: {sensors: {radar: {use: sensor.fake";
    CHECK(plugins.problems(before + sensors + "}}}, with: {frame: mast, use: x}}\n") ==
          "test.yaml:3:83: world: source.fake has no parameter 'frame'; `frame` stands beside `with`, not under it\n"
          "test.yaml:3:96: world: source.fake has no parameter 'use'; `use` stands beside `with`, not under it");
    CHECK(plugins.problems(before + sensors + ", with: {in: {}}}}}}\n").find("has no parameter 'in'; parameters: ") !=
          std::string::npos);
    CHECK(
        plugins.problems(before + "Parts: {sensors: {radar: {plugin: sensor.fake}}}, inputs: {}}\n") ==
        "test.yaml:3:29: world: unknown key 'Parts'; did you mean 'parts'? keys of a node: use, frame, in, with, "
        "parts\n"
        "test.yaml:3:79: world: unknown key 'inputs'; did you mean 'in'? keys of a node: use, frame, in, with, parts\n"
        "test.yaml:3:55: world.sensors.radar: unknown key 'plugin'; did you mean 'use'? keys of a part: use, like, "
        "with, parts");
    CHECK(plugins.problems(before + sensors + "}}}, with: {scans = 3}}\n") ==
          "test.yaml:3:83: world: source.fake has no parameter 'scans = 3'; a colon belongs in place of the '=': "
          "`scans: 3`");
}

TEST_CASE("An address where a part should stand is answered with like", "[graph][parts]") {
    Pipeline plugins;
    const std::string world = "pelorus: 1\ngraph:\n  world: {use: source.fake, parts: {sensors: ";
    const std::string radar = "{radar: {use: sensor.fake}, ";
    CHECK(plugins.problems(world + radar + "second: world.sensors.radar}}}\n") ==
          "test.yaml:3:82: world.sensors.second: expected a map such as {use: PLUGIN} or {like: world.sensors.radar}, "
          "got 'world.sensors.radar'");
    CHECK(plugins.problems(world + radar + "second: world.sensors.gone}}}\n") ==
          "test.yaml:3:82: world.sensors.second: expected a map such as {use: PLUGIN}, got 'world.sensors.gone'");
    CHECK(plugins.problems(world + radar +
                           "second: {use: sensor.fake}}}}\n"
                           "  other: {use: source.fake, parts: {sensors: world.sensors.radar}}\n") ==
          "test.yaml:4:46: other.sensors: expected a map such as {use: PLUGIN} or {like: world.sensors.radar}, or from "
          "names to such maps, got 'world.sensors.radar'");
}

TEST_CASE("Nodes need a plugin of a stage and a proper name", "[graph][parts]") {
    Pipeline plugins;
    CHECK(
        plugins.problems(
            "pelorus: 1\ngraph:\n  a: {use: motion.fake}\n  b: {with: {}}\n  c: {use: tracker.gone}\n  d.e: {use: x}\n"
            "  run: {use: x}\n  f: source.fake\n  g: {use: source.fake, with: 3, parts: [1]}\n") ==
        "test.yaml:3:12: a: motion.fake is a motion; a node is one of source, registration, fusion, tracker, "
        "scheduler, analyzer, sink\n"
        "test.yaml:4:3: b: names no plugin (use: KIND.NAME)\n"
        "test.yaml:5:12: c: no plugin tracker.gone\n"
        "test.yaml:6:3: 'd.e' cannot name a node: letters, digits and _ only, and no digit first\n"
        "test.yaml:7:3: 'run' cannot name a node: it is a word of the config itself\n"
        "test.yaml:8:6: f: expected a map such as {use: PLUGIN}, got 'source.fake'\n"
        "test.yaml:9:31: g.with: expected a map, got '3'\n"
        "test.yaml:9:41: g.parts: expected a map, got a list\n"
        "test.yaml:9:12: g: the slot 'sensors' takes at least 1 (kind sensor), got 0");
}

TEST_CASE("The keys and the version of a config are checked", "[graph]") {
    Pipeline plugins;
    CHECK(plugins.problems("title: x\nrun: {sed: 3}\ngrph: {}\nx-free: &a {b: 1}\n") ==
          "test.yaml:3:1: unknown key 'grph'; did you mean 'graph'? keys: pelorus, title, run, frames, graph, "
          "campaign, extend\n"
          "test.yaml:1:1: a config says which version it is written for: `pelorus: 1` is missing\n"
          "test.yaml:2:7: run: unknown key 'sed'; did you mean 'seed'? keys: seed\n"
          "test.yaml:1:1: the config has no `graph:`");
    CHECK(plugins.problems("pelorus: 2\ntitle: [a]\nrun: 5\ngraph: {}\n") ==
          "test.yaml:1:10: pelorus: this host reads version 1 of the config, got '2'\n"
          "test.yaml:2:8: title: expected a text, got a list\n"
          "test.yaml:3:6: run: expected a map such as {seed: 7}, got '5'\n"
          "test.yaml:4:8: graph: expected a map from names to nodes, got an empty one");
    for (const char* seed : {"-1", "1.5", "seven", "18446744073709551616", "[1]", "~"})
        CHECK(plugins.problems(std::string("pelorus: 1\nrun: {seed: ") + seed + "}\ngraph: {}\n")
                  .find("run.seed: expected a whole number from 0 to 2^64 - 1, got ") != std::string::npos);
}

TEST_CASE("The structure of a campaign is checked", "[graph]") {
    Pipeline plugins;
    const auto with = [&](const std::string& campaign) {
        return plugins.problems(fakes::pipeline() + "campaign:\n" + campaign);
    };
    CHECK(with("  runs: 200\n  sweep: {world.period: [1 s, 2 s], both: {world.scans: [1, 2], tracker.threshold: [1 m, "
               "2 m]}}\n"
               "  variants: {a: {world.period: 3 s}, b: {}}\n") == "built");
    CHECK(with("  runs: 0\n  swep: {}\n") ==
          "test.yaml:25:3: campaign: unknown key 'swep'; did you mean 'sweep'? keys: runs, sweep, variants, reference, "
          "on_failure\n"
          "test.yaml:24:9: campaign.runs: expected a whole number of at least 1, got '0'");
    CHECK(with("  sweep: {world.period: 3, a: {b: [1, 2], c: [1]}}\n  variants: {d: 5}\n") ==
          "test.yaml:24:25: campaign.sweep.world.period: expected a list of values, or a map from addresses to lists "
          "of one length, "
          "got '3'\n"
          "test.yaml:24:46: campaign.sweep.a: c has 1 values, b has 2\n"
          "test.yaml:25:17: campaign.variants.d: expected a map from addresses to values ({} for none), got '5'");
}
