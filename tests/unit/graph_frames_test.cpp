#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "graph/frames.hpp"
#include "graph/yaml.hpp"
#include "graph_fakes.hpp"

using namespace pelorus;
using fakes::FakePlugins;

namespace {

std::string problems(const std::string& text) {
    host::FrameTree tree;
    graph::Problems found;
    const graph::Value block = graph::read_yaml(text, {{}, "f.yaml", "/"});
    graph::read_frames(&block, tree, found);
    std::string lines;
    for (const ConfigError::Item& item : found.items())
        lines += (lines.empty() ? "" : "\n") + item.where.text() + ": " + item.text;
    return lines;
}

/// A point of frame `from` in frame `to`.
std::array<double, 3> moved(const std::string& text, const char* from, const char* to,
                            const std::array<double, 3>& point) {
    host::FrameTree tree;
    graph::Problems found;
    const graph::Value block = graph::read_yaml(text, {{}, "f.yaml", "/"});
    graph::read_frames(&block, tree, found);
    REQUIRE(found.empty());
    plr_frame_pose pose{};
    pose.struct_size = sizeof pose;
    plr_error error{};
    REQUIRE(tree.service().transform(tree.service().context, from, to, 0, &pose, &error) == PLR_OK);
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i)
        out[i] = pose.rotation[i] * point[0] + pose.rotation[3 + i] * point[1] + pose.rotation[6 + i] * point[2] +
                 pose.translation[i];
    return out;
}

void check(const std::array<double, 3>& point, double x, double y, double z) {
    CHECK(point[0] == Approx(x).margin(1e-9));
    CHECK(point[1] == Approx(y).margin(1e-9));
    CHECK(point[2] == Approx(z).margin(1e-9));
}

}  // namespace

TEST_CASE("Frames stand by translation and attitude or quaternion, whatever their order in the file",
          "[graph][frames]") {
    check(moved("b: {parent: a, translation: [0, 0, 1 km]}\na: {translation: [1 m, 2 m, 3 m]}\n", "b", "", {1, 1, 1}),
          2, 3, 1004);
    // Yaw turns x towards y, pitch z towards x, roll y towards z; roll is applied first, yaw last.
    check(moved("a: {attitude: [0, 0, 90 deg]}\n", "a", "", {1, 0, 0}), 0, 1, 0);
    check(moved("a: {attitude: [0, 90 deg, 0]}\n", "a", "", {1, 0, 0}), 0, 0, -1);
    check(moved("a: {attitude: [90 deg, 0, 0]}\n", "a", "", {0, 1, 0}), 0, 0, 1);
    check(moved("a: {attitude: [90 deg, 0, 90 deg]}\n", "a", "", {0, 1, 0}), 0, 0, 1);
    check(moved("a: {attitude: [90 deg, 90 deg, 0]}\n", "a", "", {0, 1, 0}), 1, 0, 0);
    const double h = std::sqrt(0.5);
    const std::string quaternion =
        "a: {quaternion: [" + std::to_string(h) + ", 0, 0, " + std::to_string(h) + "], translation: [5, 0, 0]}\n";
    check(moved(quaternion, "a", "", {1, 0, 0}), 5, 1, 0);
}

TEST_CASE("An attitude and its quaternion are the same frame", "[graph][frames]") {
    const double r = 0.3, p = -0.5, y = 1.1;
    const double cr = std::cos(r / 2), sr = std::sin(r / 2), cp = std::cos(p / 2), sp = std::sin(p / 2),
                 cy = std::cos(y / 2), sy = std::sin(y / 2);
    const nlohmann::json q{cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                           cr * cp * sy - sr * sp * cy};
    const std::string text = "a: {attitude: [0.3, -0.5, 1.1]}\nb: {quaternion: " + q.dump() + "}\n";
    check(moved(text, "a", "b", {3, 4, 5}), 3, 4, 5);
}

TEST_CASE("A geodetic frame is east-north-up at its origin, and carries others", "[graph][frames]") {
    const std::string text =
        "site: {origin: [0 deg, 0 deg, 0 m]}\nmast: {parent: site, translation: [0, 0, 20 m]}\nnorth: {origin: [1 deg, "
        "0 deg, 0 m]}\n";
    check(moved(text, "mast", "site", {0, 0, 0}), 0, 0, 20);
    const auto there = moved(text, "north", "site", {0, 0, 0});
    CHECK(there[0] == Approx(0).margin(1e-6));
    CHECK(there[1] == Approx(110568.8).epsilon(1e-4));  // one degree of latitude from the equator
    CHECK(there[2] < -900);
}

TEST_CASE("Frames that make no sense are refused, all of them", "[graph][frames]") {
    CHECK(problems("a: 5\nb: {orign: [1, 2, 3]}\nc: {origin: [1, 2]}\nd: {origin: [91 deg, 0, 0]}\ne: {origin: [0, 400 "
                   "deg, 0 s], parent: a}\n"
                   "f: {quaternion: [1, 1, 0, 0]}\ng: {attitude: [0, 0, 0], quaternion: [1, 0, 0, 0]}\n2h: {}\ni: "
                   "{translation: 3, parent: [a]}\n") ==
          "f.yaml:1:4: frames.a: expected a map such as {origin: [43 deg, 6 deg, 12 m]} or {parent: site, translation: "
          "[0 m, 0 m, 20 m]}, got '5'\n"
          "f.yaml:2:5: frames.b: unknown key 'orign'; did you mean 'origin'? keys: origin, parent, translation, "
          "attitude, quaternion\n"
          "f.yaml:3:13: frames.c.origin: expected a list of 3 numbers, got 2\n"
          "f.yaml:4:14: frames.d.origin[0]: a latitude is between -90 and 90 deg, got '91 deg' (a number without a "
          "unit is in rad)\n"
          "f.yaml:5:32: frames.e: a frame with an origin has no parent; put a second frame below it\n"
          "f.yaml:5:26: frames.e.origin[2]: expected a value in m, got '0 s' (s is a time)\n"
          "f.yaml:6:17: frames.f.quaternion: its norm is 1.414214, expected 1 (order w, x, y, z)\n"
          "f.yaml:7:38: frames.g: give attitude or quaternion, not both\n"
          "f.yaml:8:1: '2h' cannot name a frame: letters, digits and _ only, and no digit first\n"
          "f.yaml:9:29: frames.i.parent: expected the name of a frame, got a list\n"
          "f.yaml:9:18: frames.i.translation: expected a list of 3 numbers, got '3'");
    CHECK(problems("a: {parent: stie}\nsite: {}\n") ==
          "f.yaml:1:13: frames.a.parent: there is no frame 'stie'; did you mean 'site'? frames: a, site");
    CHECK(problems("a: {parent: b}\nb: {parent: c}\nc: {parent: b}\n") ==
          "f.yaml:2:13: frames stand on each other in a circle: b -> c -> b");
    CHECK(problems("[a]") == "f.yaml:1:1: frames: expected a map from name to frame, got a list");
}

TEST_CASE("A node's frame is one of the config, and its instances are told", "[graph][frames]") {
    FakePlugins plugins;
    std::string seen = "?";
    plugins.add("source.plain", "source").on_create = [&](const plr_config& config, plr_error&) {
        seen = config.frame;
        const auto* frames = static_cast<const plr_frames*>(config.host->service(config.host, PLR_SERVICE_FRAMES));
        REQUIRE(frames != nullptr);
        plr_error error{};
        plr_frame_pose pose{};
        pose.struct_size = sizeof pose;
        CHECK(frames->transform(frames->context, "site", "", 0, &pose, &error) == PLR_OK);
        return PLR_OK;
    };
    const std::string start = "pelorus: 1\nframes: {site: {translation: [1, 2, 3]}}\ngraph: {n: {use: source.plain";
    const graph::Graph graph = plugins.build(start + ", frame: site}}\n");
    CHECK(seen == "site");
    CHECK(graph.resolved()["frames"].dump() == R"({"site":{"parent":"","translation":[1.0,2.0,3.0]}})");
    CHECK(graph.resolved()["graph"].dump() == R"({"n":{"use":"source.plain","frame":"site"}})");
    plugins.build(start + "}}\n");
    CHECK(seen.empty());
    CHECK(plugins.problems(start + ", frame: sight}}\n") ==
          "test.yaml:3:39: n.frame: there is no frame 'sight'; frames: site");
    CHECK(plugins.problems(start + ", frame: [site]}}\n") ==
          "test.yaml:3:39: n.frame: expected the name of a frame, got a list");
}
