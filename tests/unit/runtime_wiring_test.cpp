#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include "graph_fakes.hpp"
#include "report/provenance.hpp"
#include "runtime/snapshot.hpp"
#include "runtime/wiring.hpp"

using namespace pelorus;
using pelorus::runtime::digest_of;
using pelorus::runtime::wire;

namespace {

/// The pipeline of the fakes, with a sink that writes a file.
struct Config {
    Config() {
        fakes::add_pipeline(plugins);
        fakes::FakePlugin& sink = plugins.add("sink.fake", "sink");
        sink.parameter("file", PLR_TYPE_PATH);
        sink.in("tracks", PLR_MESSAGE_TRACKS);
    }
    graph::Graph build(const std::string& file, const std::vector<graph::Override>& overrides = {}) {
        const std::string yaml = head + fakes::pipeline().substr(fakes::pipeline().find("graph:")) +
                                 "  out: {use: sink.fake, in: {tracks: tracker.tracks}, with: {file: " + file + "}}\n";
        return plugins.build(yaml, overrides);
    }
    std::string head = "pelorus: 1\ntitle: a test\nrun: {seed: 7}\n";
    fakes::FakePlugins plugins;
};

}  // namespace

TEST_CASE("a graph is told in plain structs: nodes and ports in file order, edges, order", "[runtime][wiring]") {
    Config config;
    const graph::Graph graph = config.build("tracks.csv");
    const runtime::Wiring wiring = wire(graph);
    REQUIRE(wiring.nodes.size() == 4);
    CHECK(wiring.nodes[1].name == "tracker");
    CHECK(wiring.nodes[1].plugin == "tracker.fake");
    CHECK(wiring.nodes[1].kind == "tracker");
    CHECK(wiring.nodes[1].version == "1.0.0");
    CHECK(wiring.nodes[1].out_ports[1].name == "commands");
    CHECK(wiring.nodes[1].out_ports[1].message == PLR_MESSAGE_VALUES);
    CHECK(wiring.edges.size() == 4);
    CHECK(wiring.order == std::vector<std::size_t>{0, 1, 2, 3});
}

TEST_CASE("the digest of a run knows what determines it, and not where its files lie", "[runtime][wiring]") {
    Config config;
    const auto digest = [&](const std::string& file, const std::vector<graph::Override>& overrides = {}) {
        const graph::Graph graph = config.build(file, overrides);
        return digest_of(wire(graph));
    };
    const runtime::Digest plain = digest("/data/tracks.csv");
    CHECK(digest("/data/tracks.csv") == plain);
    CHECK(digest("/elsewhere/tracks.csv") == plain);
    CHECK(digest("/data/others.csv") != plain);
    CHECK(digest("/data/tracks.csv", {{"world.sensors.radar.noise", "5 m"}}) != plain);
    CHECK(digest("/data/tracks.csv", {{"tracker.estimator.motion.rate", "0.2 1/s"}}) != plain);
    config.head = "pelorus: 1\ntitle: another title\nrun: {seed: 7}\n";
    CHECK(digest("/data/tracks.csv") == plain);
    config.head = "pelorus: 1\ntitle: a test\nrun: {seed: 8}\n";
    CHECK(digest("/data/tracks.csv") != plain);
}

TEST_CASE("provenance tells config, seed and plugins, the same every time", "[report][wiring]") {
    Config config;
    const graph::Graph graph = config.build("tracks.csv");
    report::RunContext context;
    context.config = "configs/airship.yaml";
    const nlohmann::ordered_json document = report::provenance(graph, context);
    CHECK(document["config_file"] == "configs/airship.yaml");
    CHECK(document["seed"] == 7);
    CHECK(document["runs"] == 1);
    CHECK(document["completed"] == true);
    CHECK(document["plugins"].size() == 7);
    CHECK(document["plugins"][0]["id"] == "analyzer.fake");
    CHECK(document["plugins"][0].contains("sha256"));
    CHECK(document["config"]["graph"]["world"]["with"]["scans"] == 100);
    CHECK(document.dump() == report::provenance(graph, context).dump());
}
