#include <catch2/catch.hpp>

#include <cstring>
#include <stdexcept>
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

plr_status fail(plr_error& error, plr_status code, const char* where, const char* message) {
    error.code = code;
    std::strcpy(error.where, where);
    std::strcpy(error.message, message);
    return code;
}

}  // namespace

TEST_CASE("Parts are created before their holders and destroyed after them", "[graph][instances]") {
    Pipeline plugins;
    const std::vector<std::string> expected{"world.sensors.radar",
                                            "world",
                                            "tracker.estimator.motion",
                                            "tracker.estimator.sensors.radar",
                                            "tracker.estimator",
                                            "tracker",
                                            "errors"};
    {
        const graph::Graph graph = plugins.build(fakes::pipeline());
        CHECK(plugins.created == expected);
        CHECK(plugins.destroyed.empty());
    }
    CHECK(plugins.destroyed == std::vector<std::string>(expected.rbegin(), expected.rend()));
}

TEST_CASE("A graph may be moved, and its instances are destroyed once", "[graph][instances]") {
    Pipeline plugins;
    {
        graph::Graph first = plugins.build(fakes::pipeline());
        const plr_config* config = first.nodes()[1].config;
        graph::Graph second = std::move(first);
        CHECK(second.nodes()[1].config == config);
        second = plugins.build(fakes::pipeline());
        CHECK(plugins.destroyed.size() == 7);
    }
    CHECK(plugins.destroyed.size() == 14);
}

TEST_CASE("Where one part cannot be created, what was created is destroyed and all failures are told",
          "[graph][instances]") {
    Pipeline plugins;
    plugins["motion.fake"].on_create = [](const plr_config&, plr_error& error) {
        return fail(error, PLR_E_PARAMETER, "form", "is too exact");
    };
    plugins["analyzer.fake"].on_create = [](const plr_config&, plr_error& error) {
        return fail(error, PLR_E_IO, "", "disk full");
    };
    CHECK(plugins.problems(fakes::pipeline()) ==
          "test.yaml:18:51: tracker.estimator.motion.form: motion.fake: is too exact\n"
          "test.yaml:20:3: errors: analyzer.fake: disk full");
    CHECK(plugins.created ==
          std::vector<std::string>{"world.sensors.radar", "world", "tracker.estimator.sensors.radar"});
    CHECK(plugins.destroyed ==
          std::vector<std::string>{"tracker.estimator.sensors.radar", "world", "world.sensors.radar"});
}

TEST_CASE("The place that a failing create names is found in the file", "[graph][instances]") {
    Pipeline plugins;
    auto legs = plugins["tracker.fake"].parameter("legs", PLR_TYPE_TABLE).initially("[]");
    legs.column("duration", PLR_TYPE_DOUBLE).initially("1");
    std::string where;
    plugins["tracker.fake"].on_create = [&](const plr_config&, plr_error& error) {
        return fail(error, PLR_E_PARAMETER, where.c_str(), "no");
    };
    std::string yaml = fakes::pipeline();
    yaml.insert(yaml.find("    in: {scans: world.scans}"), "    with: {legs: [{duration: 1}, {duration: 2}]}\n");
    const auto place = [&](const std::string& named) {
        where = named;
        const std::string text = plugins.problems(yaml);
        const std::string end = ": tracker" + (named.empty() ? "" : "." + named) + ": tracker.fake: no";
        REQUIRE(text.size() > end.size());
        CHECK(text.substr(text.size() - end.size()) == end);
        return text.substr(0, text.size() - end.size());
    };
    CHECK(place("legs") == "test.yaml:13:18");
    CHECK(place("legs[1].duration") == "test.yaml:13:45");
    CHECK(place("legs[1]") == "test.yaml:13:34");
    CHECK(place("legs[7].duration") == "test.yaml:13:18");
    CHECK(place("estimator") == "test.yaml:16:7");
    CHECK(place("estimator.motion") == "test.yaml:19:11");
    CHECK(place("estimator.motion.form") == "test.yaml:19:51");
    CHECK(place("estimator.sensors.radar") == "test.yaml:20:21");
    CHECK(place("estimator.sensors") == "test.yaml:20:11");
    CHECK(place("threshold") == "test.yaml:11:3");  // not in the file: the node
    CHECK(place("") == "test.yaml:11:3");
    CHECK(place("..[[") == "test.yaml:11:3");
}

TEST_CASE("A create that throws, tells nothing or answers nonsense is contained and named", "[graph][instances]") {
    Pipeline plugins;
    FakePlugin& tracker = plugins["tracker.fake"];
    const std::string start = "test.yaml:11:3: tracker: tracker.fake: ";
    tracker.on_create = [](const plr_config&, plr_error&) -> plr_status { throw std::runtime_error("thrown across"); };
    CHECK(plugins.problems(fakes::pipeline()) == start + "thrown across");
    tracker.on_create = [](const plr_config&, plr_error&) -> plr_status { throw 5; };
    CHECK(plugins.problems(fakes::pipeline()) == start + "an exception of unknown type");
    tracker.on_create = [](const plr_config&, plr_error&) -> plr_status { return PLR_E_MEMORY; };
    CHECK(plugins.problems(fakes::pipeline()) == start + "it answered PLR_E_MEMORY and told no reason");
    tracker.on_create = nullptr;
    tracker.on_created = [](plr_instance& out) {
        out.table->destroy(out.self);
        out = {};
    };
    CHECK(plugins.problems(fakes::pipeline()) ==
          "test.yaml:12:10: tracker: tracker.fake breaks the contract: create answered PLR_OK but no table (NULL)");
}

namespace {

/// What building says where an instance of the plugin gets a changed copy of its table.
template <class Table, class Change> std::string with_table(const std::string& id, Change change) {
    static Table table;
    Pipeline plugins;
    plugins[id].on_created = [&](plr_instance& out) {
        table = *reinterpret_cast<const Table*>(out.table);
        change(table);
        out.table = &table.head;
    };
    const std::string text = plugins.problems(fakes::pipeline());
    const std::string marker = " breaks the contract: ";
    const std::size_t end = text.find('\n');
    CHECK(plugins.created.size() == plugins.destroyed.size());
    return text.find(marker) == std::string::npos
               ? text
               : text.substr(text.find(marker) + marker.size(), end - text.find(marker) - marker.size());
}

template <class Info> std::string with_motion_info(Info change) {
    static plr_motion_info info;
    return with_table<plr_motion>("motion.fake", [&](plr_motion& table) {
        info = *table.info(nullptr);
        change(info);
        table.info = [](const void*) -> const plr_motion_info* { return &info; };
    });
}

}  // namespace

TEST_CASE("Tables without what is not optional are refused", "[graph][instances]") {
    CHECK(with_table<plr_motion>("motion.fake", [](plr_motion& t) { t.jacobian = nullptr; }) ==
          "its table has no function jacobian");
    CHECK(with_table<plr_motion>("motion.fake", [](plr_motion& t) { t.info = nullptr; }) ==
          "its table has no function info");
    CHECK(with_table<plr_motion>("motion.fake", [](plr_motion& t) {
              t.info = [](const void*) -> const plr_motion_info* { return nullptr; };
          }) == "info answered NULL");
    CHECK(with_table<plr_motion>("motion.fake", [](plr_motion& t) {
              t.info = [](const void*) -> const plr_motion_info* { throw 1; };
          }) == "info: an exception of unknown type");
    CHECK(with_table<plr_motion>("motion.fake", [](plr_motion& t) {
              t.head.struct_size = offsetof(plr_motion, noise);
          }) == "its table has no function noise");
    CHECK(with_table<plr_sensor>("sensor.fake", [](plr_sensor& t) { t.residual = nullptr; }) ==
          "its table has no function residual");
    CHECK(with_table<plr_estimator>("estimator.fake", [](plr_estimator& t) { t.moments = nullptr; }) ==
          "its table has no function moments");
    CHECK(with_table<plr_stage>("source.fake", [](plr_stage& t) { t.emit = nullptr; }) ==
          "its table has no function emit, but the kind source");
    CHECK(with_table<plr_stage>("tracker.fake", [](plr_stage& t) { t.receive = nullptr; }) ==
          "its table has no function receive, but in ports");
    CHECK(with_table<plr_stage>("tracker.fake", [](plr_stage& t) {
              t.save = [](const void*, const plr_writer*, plr_error*) -> plr_status { return PLR_OK; };
          }) == "its table has no function load, but save");
    CHECK(with_table<plr_stage>("tracker.fake", [](plr_stage& t) { t.next = nullptr; }) == "built");
    // Optional functions at the tail may be beyond the table's end.
    CHECK(with_table<plr_motion>(
              "motion.fake", [](plr_motion& t) { t.head.struct_size = offsetof(plr_motion, init_record); }) == "built");
    CHECK(with_table<plr_stage>("tracker.fake", [](plr_stage& t) { t.head.struct_size = offsetof(plr_stage, save); }) ==
          "built");
}

TEST_CASE("What an instance says of itself must make sense", "[graph][instances]") {
    static plr_component components[2];
    static plr_space space;
    const auto with_component = [](auto change) {
        return with_motion_info([&](plr_motion_info& info) {
            components[0] = info.state->components[0];
            components[1] = info.state->components[1];
            change(components[1]);
            space = {sizeof(plr_space), 2, components};
            info.state = &space;
        });
    };
    CHECK(with_motion_info([](plr_motion_info& info) { info.struct_size = 8; }) ==
          "info: a struct_size of 8 bytes, expected at least 48");
    CHECK(with_motion_info([](plr_motion_info& info) { info.state = nullptr; }) ==
          "info: the state space is missing (NULL)");
    CHECK(with_motion_info([](plr_motion_info& info) { info.scratch_bytes = 16u << 20; }) == "built");
    CHECK(with_motion_info([](plr_motion_info& info) { info.scratch_bytes = (16u << 20) + 1; }) ==
          "info: scratch_bytes is 16777217, expected at most 16777216");
    CHECK(with_motion_info([](plr_motion_info& info) { info.record_size = -1; }) == "info: a record_size of -1");
    CHECK(with_motion_info([](plr_motion_info& info) { info.record_size = 1; }) ==
          "its table has no function init_record, but a record");
    CHECK(with_component([](plr_component& c) { c.name = ""; }) ==
          "info: the state space has a component without a name");
    CHECK(with_component([](plr_component& c) { c.name = "position.x"; }) ==
          "info: the state space has two components position.x");
    CHECK(with_component([](plr_component& c) { c.unit = "km"; }) ==
          "info: the state space gives position.y in 'km', which is not an SI unit");
    CHECK(with_component([](plr_component& c) { c.unit = nullptr; }) ==
          "info: the state space has a component position.y without a unit (NULL)");
    CHECK(with_component([](plr_component& c) { c.prior_deviation = 0; }) ==
          "info: the state space declares no prior mean and positive deviation for position.y");
    CHECK(with_component([](plr_component& c) { c.name = "bearing"; }) ==
          "its table has no function to_cartesian, but a state that is not Cartesian");
    CHECK(with_component([](plr_component& c) { c.struct_size = sizeof c; }) == "built");
}

TEST_CASE("An exception from destroy does not get out", "[graph][instances]") {
    static plr_stage table;
    Pipeline plugins;
    plugins["analyzer.fake"].on_created = [](plr_instance& out) {
        out.table->destroy(out.self);
        table = *reinterpret_cast<const plr_stage*>(out.table);
        table.port_type = nullptr;
        table.head.destroy = [](void*) { throw std::runtime_error("not even now"); };
        out = {nullptr, &table.head};
    };
    CHECK_NOTHROW(plugins.build(fakes::pipeline()));
    CHECK(plugins.destroyed.size() == 7);
}

TEST_CASE("Inputs of a stage's tree lie in one flat array", "[graph][instances]") {
    struct Seen {
        std::vector<std::string> places;
        std::int64_t offset = -1, size = -1;
    };
    std::map<std::string, Seen> seen;
    Pipeline plugins;
    const auto look = [&](const plr_config& config, plr_error&) {
        Seen& here = seen[config.address];
        for (std::uint32_t i = 0; i < config.input_count; ++i) {
            const plr_input_place& place = config.inputs[i];
            here.places.push_back(std::string(place.name) + " [" + place.unit + "] " + std::to_string(place.offset) +
                                  "+" + std::to_string(place.size));
        }
        here.offset = config.input_offset;
        here.size = config.input_size;
        return PLR_OK;
    };
    plugins["tracker.fake"].input("own", "m", {1});
    for (const char* id : {"tracker.fake", "estimator.fake", "motion.fake", "sensor.fake", "source.fake"})
        plugins[id].on_create = look;
    plugins.build(fakes::pipeline());
    CHECK(seen["tracker"].places == std::vector<std::string>{"own [m] 0+1", "estimator.motion.normal [] 1+3",
                                                             "estimator.sensors.radar.bias [m] 4+2"});
    CHECK(seen["tracker"].offset == 0);
    CHECK(seen["tracker"].size == 6);
    CHECK(seen["tracker.estimator"].places ==
          std::vector<std::string>{"motion.normal [] 1+3", "sensors.radar.bias [m] 4+2"});
    CHECK(seen["tracker.estimator"].offset == 1);
    CHECK(seen["tracker.estimator.sensors.radar"].places == std::vector<std::string>{"bias [m] 4+2"});
    CHECK(seen["tracker.estimator.sensors.radar"].offset == 4);
    CHECK(seen["tracker.estimator.sensors.radar"].size == 6);
    CHECK(seen["world.sensors.radar"].places == std::vector<std::string>{"bias [m] 0+2"});
    CHECK(seen["world"].size == 2);
}

TEST_CASE("Keys depend on seed, run and node, and parts share their node's", "[graph][instances]") {
    std::map<std::string, plr_key> keys;
    Pipeline plugins;
    const auto look = [&](const plr_config& config, plr_error&) {
        keys[config.address] = config.key;
        return PLR_OK;
    };
    for (const char* id : {"tracker.fake", "estimator.fake", "source.fake"}) plugins[id].on_create = look;
    plugins.build(fakes::pipeline());
    const auto before = keys;
    const auto same = [](plr_key a, plr_key b) { return a.word[0] == b.word[0] && a.word[1] == b.word[1]; };
    CHECK(same(before.at("tracker"), before.at("tracker.estimator")));
    CHECK_FALSE(same(before.at("tracker"), before.at("world")));
    plugins.build(fakes::pipeline());
    CHECK(same(before.at("tracker"), keys.at("tracker")));
    graph::BuildOptions second_run;
    second_run.run = 1;
    plugins.build(fakes::pipeline(), {}, second_run);
    CHECK_FALSE(same(before.at("tracker"), keys.at("tracker")));
    plugins.build(fakes::pipeline(), {{"run.seed", "8"}});
    CHECK_FALSE(same(before.at("tracker"), keys.at("tracker")));
}

TEST_CASE("The seed of the options serves where the config has none", "[graph][instances]") {
    Pipeline plugins;
    graph::BuildOptions options;
    options.seed = 99;
    CHECK(plugins.build(fakes::pipeline(), {}, options).seed() == 7);
    CHECK(plugins.build(fakes::pipeline(), {{"run.seed", "~"}}, options).seed() == 99);
    CHECK(plugins.build(fakes::pipeline(), {{"run.seed", "18446744073709551615"}}).seed() == UINT64_MAX);
}

TEST_CASE("Stages are told the result folder, or that there is none", "[graph][instances]") {
    std::string seen;
    Pipeline plugins;
    plugins["analyzer.fake"].on_create = [&](const plr_config& config, plr_error&) {
        const auto* output = static_cast<const plr_output*>(config.host->service(config.host, PLR_SERVICE_OUTPUT));
        REQUIRE(output != nullptr);
        const char* folder = output->folder(output->context);
        seen = folder == nullptr ? "none" : folder;
        return PLR_OK;
    };
    graph::BuildOptions options;
    options.output_folder = "/results/one";
    const graph::Graph graph = plugins.build(fakes::pipeline(), {}, options);
    CHECK(seen == "/results/one");
    plugins.build(fakes::pipeline());
    CHECK(seen == "none");
}
