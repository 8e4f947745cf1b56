#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "graph_fakes.hpp"

using namespace pelorus;
using fakes::FakePlugin;
using fakes::FakePlugins;

namespace {

/// Stages without parts: a source, a stage that passes scans on, one that joins, and a sink.
struct Stages : FakePlugins {
    Stages() {
        add("source.plain", "source")
            .in("commands", PLR_MESSAGE_VALUES, PLR_PORT_OPTIONAL)
            .out("scans", PLR_MESSAGE_SCAN)
            .out("truth", PLR_MESSAGE_TRUTH);
        add("registration.pass", "registration")
            .in("scans", PLR_MESSAGE_SCAN)
            .out("scans", PLR_MESSAGE_SCAN)
            .out("commands", PLR_MESSAGE_VALUES);
        add("fusion.join", "fusion").in("scans", PLR_MESSAGE_SCAN, PLR_PORT_MANY).out("scans", PLR_MESSAGE_SCAN);
    }
};

std::string config(const std::string& nodes) { return "pelorus: 1\ngraph:\n" + nodes; }

std::string show(const graph::Graph& graph) {
    std::string text;
    for (const graph::Edge& edge : graph.edges()) {
        const graph::Node& from = graph.nodes()[edge.from];
        const graph::Node& to = graph.nodes()[edge.to];
        text += from.name + "." + from.description().out_ports[edge.from_port].name +
                (edge.previous ? " ~> " : " -> ") + to.name + "." + to.description().in_ports[edge.to_port].name + "\n";
    }
    return text;
}

std::vector<std::string> order(const graph::Graph& graph) {
    std::vector<std::string> names;
    for (const std::size_t node : graph.order()) names.push_back(graph.nodes()[node].name);
    return names;
}

}  // namespace

TEST_CASE("Edges are read with lists and feedback, and nodes ordered by them", "[graph][edges]") {
    Stages plugins;
    const graph::Graph graph =
        plugins.build(config(R"(  end: {use: fusion.join, in: {scans: [two.scans, previous(end.scans), one.scans]}}
  two: {use: registration.pass, in: {scans: one.scans}}
  other: {use: source.plain}
  one: {use: source.plain, in: {commands: previous(two.commands)}}
)"));
    CHECK(show(graph) ==
          "two.scans -> end.scans\nend.scans ~> end.scans\none.scans -> end.scans\none.scans -> "
          "two.scans\ntwo.commands ~> one.commands\n");
    CHECK(graph.edges()[0].where.text() == "test.yaml:3:40");
    CHECK(order(graph) == std::vector<std::string>{"other", "one", "two", "end"});
}

TEST_CASE("Edges that lead nowhere, or carry something else, are refused together", "[graph][edges]") {
    Stages plugins;
    CHECK(plugins.problems(config(R"(  a: {use: source.plain, in: {comands: b.commands}}
  b: {use: registration.pass, in: {scans: a.truth}}
  c: {use: registration.pass, in: {scans: a.scan}}
  d: {use: registration.pass, in: {scans: aa.scans}}
  e: {use: registration.pass, in: {scans: a}}
  f: {use: registration.pass, in: {scans: [a.scans, b.scans]}}
  g: {use: registration.pass, in: {scans: previous(a.scans}}
  h: {use: fusion.join, in: {scans: [a.scans, [b.scans], a.scans]}}
  i: {use: registration.pass}
  j: {use: fusion.join, in: {scans: []}}
  k: {use: registration.pass, in: {scans: {a: scans}}}
  l: {use: registration.pass, in: a.scans}
)")) == "test.yaml:14:35: l.in: expected a map such as {PORT: NODE.PORT}, got 'a.scans'\n"
        "test.yaml:3:31: a.in: source.plain has no in port 'comands'; did you mean 'commands'? in ports: commands\n"
        "test.yaml:4:43: b.in.scans: expected scan, but a.truth carries truth\n"
        "test.yaml:5:43: c.in.scans: source.plain has no out port 'scan'; did you mean 'scans'? out ports: scans, "
        "truth\n"
        "test.yaml:6:43: d.in.scans: there is no node 'aa'; nodes: a, b, c, d, e, f, g, h, i, j, k, l\n"
        "test.yaml:7:43: e.in.scans: expected node.port or previous(node.port), got 'a'\n"
        "test.yaml:8:43: f.in.scans: one edge may end here, got 2\n"
        "test.yaml:9:43: g.in.scans: expected node.port or previous(node.port), got 'previous(a.scans'\n"
        "test.yaml:10:47: h.in.scans: expected node.port or previous(node.port), got a list\n"
        "test.yaml:10:58: h.in.scans: the same edge stands twice\n"
        "test.yaml:11:12: i: the in port 'scans' (scan) is not connected\n"
        "test.yaml:12:37: j.in.scans: expected node.port or previous(node.port), got a list\n"
        "test.yaml:13:43: k.in.scans: expected node.port or previous(node.port), got a map\n"
        "test.yaml:14:12: l: the in port 'scans' (scan) is not connected");
}

TEST_CASE("A circle of edges is refused and printed, and previous() opens it", "[graph][edges]") {
    Stages plugins;
    const std::string before = "  s: {use: source.plain}\n  a: {use: fusion.join, in: {scans: [s.scans, ";
    const std::string after =
        "]}}\n  b: {use: registration.pass, in: {scans: a.scans}}\n  c: {use: registration.pass, in: {scans: "
        "b.scans}}\n"
        "  z: {use: registration.pass, in: {scans: c.scans}}\n";
    CHECK(plugins.problems(config(before + "c.scans" + after)) ==
          "test.yaml:5:43: nodes wait for each other in a circle: a -> b -> c -> a; write one of the edges as "
          "previous(node.port)");
    CHECK(
        plugins.problems(config(before + "a.scans" + after)) ==
        "test.yaml:4:47: nodes wait for each other in a circle: a -> a; write one of the edges as previous(node.port)");
    CHECK(order(plugins.build(config(before + "previous(c.scans)" + after))) ==
          std::vector<std::string>{"s", "a", "b", "c", "z"});
}

namespace {

plr_component component(const char* name, const char* unit) { return {sizeof(plr_component), 0, name, unit, 0, 0}; }

/// One port's streams, kept alive.
struct Streams {
    struct Stream {
        const char* sensor;
        std::vector<plr_component> components;  // empty: NULL
        const char* frame;
        std::uint32_t flags = 0;
    };
    explicit Streams(std::vector<Stream> all) : streams(std::move(all)) {
        spaces.reserve(streams.size());
        for (const Stream& each : streams) {
            spaces.push_back(
                {sizeof(plr_space), static_cast<std::uint32_t>(each.components.size()), each.components.data()});
            raw.push_back({sizeof(plr_stream), each.flags, each.sensor,
                           each.components.empty() ? nullptr : &spaces.back(), each.frame});
        }
    }
    Streams(const Streams&) = delete;
    Streams& operator=(const Streams&) = delete;
    plr_port_type type(std::uint32_t passes_on = 0) const {
        return {sizeof(plr_port_type), static_cast<std::uint32_t>(raw.size()), raw.data(), passes_on, 0};
    }

    std::vector<Stream> streams;
    std::vector<plr_space> spaces;
    std::vector<plr_stream> raw;
};

const std::vector<plr_component> polar{component("range", "m"), component("azimuth", "rad")};
const std::vector<plr_component> doppler{component("range", "m"), component("range_rate", "m/s"),
                                         component("azimuth", "rad")};

const plr_port_type everything{sizeof(plr_port_type), 0, nullptr, 0, 0};

/// What building a -> b says where a offers and b wants these.
std::string joined(std::vector<Streams::Stream> offered, std::vector<Streams::Stream> wanted) {
    Stages plugins;
    const Streams out(std::move(offered)), in(std::move(wanted));
    plugins["source.plain"].port_type = [&](bool is_output, std::uint32_t port) {
        return is_output && port == 0 ? out.type() : everything;
    };
    plugins["registration.pass"].port_type = [&](bool is_output, std::uint32_t) {
        return is_output ? everything : in.type();
    };
    return plugins.problems(config("  a: {use: source.plain}\n  b: {use: registration.pass, in: {scans: a.scans}}\n"));
}

const std::string at = "test.yaml:4:43: a.scans -> b.scans: ";

}  // namespace

TEST_CASE("Streams that fit are joined", "[graph][edges]") {
    CHECK(joined({{"radar", polar, ""}}, {{"radar", polar, ""}}) == "built");
    CHECK(joined({{"radar", polar, "site"}}, {{nullptr, polar, nullptr}}) == "built");
    CHECK(joined({{"radar", polar, "site"}}, {{nullptr, {}, "site"}}) == "built");
    CHECK(joined({{"radar", doppler, ""}}, {{"radar", polar, "", PLR_STREAM_AT_LEAST}}) == "built");
    CHECK(joined({{"radar", polar, ""}, {"lidar", doppler, ""}}, {{"lidar", doppler, ""}, {nullptr, polar, ""}}) ==
          "built");
    CHECK(joined({{"radar", polar, ""}}, {}) == "built");
    CHECK(joined({}, {{"radar", polar, ""}}) == "built");
}

TEST_CASE("Streams that do not fit are refused with both sides", "[graph][edges]") {
    CHECK(joined({{"radar", doppler, ""}}, {{"radar", polar, ""}}) ==
          at + "the stream of sensor 'radar' does not fit: components, offered against wanted: range [m] = range [m]; "
               "range_rate [m/s] != azimuth [rad]; azimuth [rad] != nothing");
    CHECK(joined({{"radar", polar, ""}}, {{"radar", doppler, "", PLR_STREAM_AT_LEAST}}) ==
          at + "the stream of sensor 'radar' does not fit: of the components that are wanted, in this order, range "
               "[m] is there; range_rate [m/s] is missing; azimuth [rad] is there; offered are range [m]; azimuth "
               "[rad]");
    CHECK(joined({{"radar", {polar[0]}, ""}}, {{"radar", polar, ""}}) ==
          at + "the stream of sensor 'radar' does not fit: components, offered against wanted: range [m] = range [m]; "
               "nothing != azimuth [rad]");
    CHECK(joined({{"radar", polar, ""}}, {{"radar", {polar[0]}, ""}}) ==
          at + "the stream of sensor 'radar' does not fit: components, offered against wanted: range [m] = range [m]; "
               "azimuth [rad] != nothing");
    CHECK(joined({{"radar", {component("range", "m"), component("azimuth", "1")}, ""}}, {{nullptr, polar, ""}})
              .find("not an SI unit") != std::string::npos);
    CHECK(joined({{"radar", {component("range", "s"), polar[1]}, ""}}, {{nullptr, polar, ""}}) ==
          at + "the stream of sensor 'radar' does not fit: components, offered against wanted: range [s] != range [m]; "
               "azimuth [rad] = azimuth [rad]");
    CHECK(joined({{"radar", polar, "site"}}, {{nullptr, polar, ""}}) ==
          at + "the stream of sensor 'radar' does not fit: it is in frame 'site', wanted in the root frame; nodes "
               "name theirs by `frame:`");
}

TEST_CASE("A stream meets the one of its sensor, even where another would fit", "[graph][edges]") {
    CHECK(joined({{"radar", polar, ""}}, {{"radar", doppler, ""}, {nullptr, polar, ""}})
              .find("the stream of sensor 'radar' does not fit") != std::string::npos);
    CHECK(joined({{"lidar", polar, ""}}, {{"radar", polar, ""}, {"camera", polar, ""}}) ==
          at + "the stream of sensor 'lidar' is not wanted there; scans go to sensors by name, and these "
               "are wanted: 'radar', 'camera'");
    CHECK(joined({{"radar", polar, ""}, {"lidar", polar, ""}}, {{"radar", polar, ""}}).find("'lidar' is not wanted") !=
          std::string::npos);
}

TEST_CASE("A stage that declares streams that make no sense is named", "[graph][edges]") {
    CHECK(joined({{"radar", {}, ""}}, {{"radar", polar, ""}}) ==
          "test.yaml:3:3: a.scans: source.plain declares a stream whose space is missing (NULL)");
    CHECK(joined({{"radar", polar, nullptr}}, {{"radar", polar, ""}}) ==
          "test.yaml:3:3: a.scans: source.plain offers a stream without a frame or sensor (NULL)");
    CHECK(joined({{"radar", {polar[0], polar[0]}, ""}}, {{"radar", polar, ""}}) ==
          "test.yaml:3:3: a.scans: source.plain declares a stream whose space has two components range");
}

TEST_CASE("What a stage passes on is compared where it arrives", "[graph][edges]") {
    Stages plugins;
    const Streams out({{"radar", polar, ""}, {"lidar", polar, ""}}), changed({{"radar", doppler, ""}}),
        in({{nullptr, doppler, ""}});
    std::uint32_t passes_on = 1;
    plugins["source.plain"].port_type = [&](bool is_output, std::uint32_t port) {
        return is_output && port == 0 ? out.type() : everything;
    };
    plugins["registration.pass"].port_type = [&](bool is_output, std::uint32_t port) {
        return is_output && port == 0 ? changed.type(passes_on) : everything;
    };
    plugins["fusion.join"].port_type = [&](bool is_output, std::uint32_t) {
        return is_output ? everything : in.type();
    };
    const std::string yaml = config(R"(  a: {use: source.plain}
  b: {use: registration.pass, in: {scans: a.scans}}
  c: {use: fusion.join, in: {scans: [b.scans, previous(c.scans)]}}
)");
    // The radar's stream is replaced by one that fits; the lidar's comes through as it was.
    CHECK(plugins.problems(yaml) ==
          "test.yaml:5:38: b.scans -> c.scans: the stream of sensor 'lidar' does not fit: components, offered against "
          "wanted: range [m] = range [m]; azimuth [rad] != range_rate [m/s]; nothing != azimuth [rad]");
    passes_on = 0;
    CHECK(plugins.problems(yaml) == "built");
    passes_on = 2;
    CHECK(plugins.problems(yaml) ==
          "test.yaml:4:3: b.scans: registration.pass passes on the streams of an in port that it does not have");
}

TEST_CASE("Stages in a feedback loop that pass on each other's streams are compared once", "[graph][edges]") {
    Stages plugins;
    const Streams out({{"radar", polar, ""}}), wanted({{nullptr, doppler, ""}});
    plugins["source.plain"].port_type = [&](bool is_output, std::uint32_t port) {
        return is_output && port == 0 ? out.type() : everything;
    };
    plugins["fusion.join"].port_type = [&](bool is_output, std::uint32_t) {
        plr_port_type type = everything;
        type.passes_on = is_output ? 1 : 0;
        return type;
    };
    plugins["registration.pass"].port_type = [&](bool is_output, std::uint32_t) {
        return is_output ? everything : wanted.type();
    };
    CHECK(plugins
              .problems(config(R"(  a: {use: source.plain}
  b: {use: fusion.join, in: {scans: [a.scans, previous(c.scans)]}}
  c: {use: fusion.join, in: {scans: b.scans}}
  d: {use: registration.pass, in: {scans: c.scans}}
)"))
              .find("test.yaml:6:43: c.scans -> d.scans: the stream of sensor 'radar' does not fit") == 0);
}
