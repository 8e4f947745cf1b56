#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>
#include <string>

#include "graph_fakes.hpp"

using namespace pelorus;
using fakes::FakePlugins;

TEST_CASE("The resolved config has everything filled in, in SI", "[graph][resolved]") {
    FakePlugins plugins;
    fakes::add_pipeline(plugins);
    CHECK(plugins.build(fakes::pipeline()).resolved() == nlohmann::ordered_json::parse(R"({
        "pelorus": 1, "title": "a test", "run": {"seed": 7},
        "graph": {
            "world": {"use": "source.fake", "with": {"period": 1.0, "scans": 100},
                      "parts": {"sensors": {"radar": {"use": "sensor.fake", "with": {"noise": 2.0, "detection_probability": 0.9}}}}},
            "tracker": {"use": "tracker.fake", "in": {"scans": ["world.scans"]}, "with": {"threshold": 10.0},
                        "parts": {"estimator": {"use": "estimator.fake", "parts": {
                            "motion": {"use": "motion.fake", "with": {"form": "truncated", "rate": 0.1}},
                            "sensors": {"radar": {"use": "sensor.fake", "with": {"noise": 2.0}}}}}}},
            "errors": {"use": "analyzer.fake", "in": {"tracks": "tracker.tracks", "truth": "world.truth"}}}})"));
}

TEST_CASE("The resolved config is a config that resolves to itself", "[graph][resolved]") {
    FakePlugins plugins;
    fakes::add_pipeline(plugins);
    auto legs = plugins["tracker.fake"]
                    .parameter("legs", PLR_TYPE_TABLE)
                    .initially("[{duration: 2 min, note: 'a: b'}, {duration: 0.1}]");
    legs.column("duration", PLR_TYPE_DOUBLE).unit("s");
    legs.column("bank", PLR_TYPE_DOUBLE).unit("rad").optional();
    legs.column("note", PLR_TYPE_STRING).optional();
    plugins["tracker.fake"].parameter("gain", PLR_TYPE_MATRIX).unit("m").initially("[[1e-300, 0.1], [3 km, -0.7]]");
    plugins["tracker.fake"].parameter("label", PLR_TYPE_STRING).initially("\"# not a \\\"comment\\\"\"");
    plugins["tracker.fake"].parameter("path", PLR_TYPE_PATH).initially("x/y.csv");
    const std::string frames =
        "frames:\n  site: {origin: [43.1 deg, 5.9 deg, 12 m]}\n  mast: {parent: site, translation: [0, 0, 20], "
        "attitude: [0, 1 deg, 0]}\n";
    const std::vector<graph::Override> overrides{{"world.in.commands", "previous(tracker.commands)"},
                                                 {"errors.frame", "mast"}};
    const auto once = plugins.build(frames + fakes::pipeline(), overrides).resolved();
    const auto twice = plugins.build(once.dump(2)).resolved();
    CHECK(once.dump() == twice.dump());
    CHECK(once["graph"]["tracker"]["with"]["label"] == "# not a \"comment\"");
    CHECK(once["frames"]["mast"]["parent"] == "site");
}
