// `pelorus check`: builds the graph and runs nothing.
#include <fmt/format.h>

#include "campaign/prepare.hpp"
#include "cli/command.hpp"
#include "cli/config_flags.hpp"
#include "cli/draw/graph_json.hpp"
#include "cli/output.hpp"
#include "graph/graph.hpp"
#include "host/description.hpp"
#include "host/error.hpp"
#include "report/expected.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;

std::string counted(std::size_t number, const std::string& noun) {
    return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

const char* port_name(const plr_port* ports, std::size_t index) {
    return host::element(ports, static_cast<std::uint32_t>(index)).name;
}

/// `scans <- world.scans`
std::string edge_text(const graph::Graph& graph, const graph::Edge& edge) {
    const graph::Node& from = graph.nodes()[edge.from];
    const std::string source = fmt::format("{}.{}", from.name, port_name(from.description().out_ports, edge.from_port));
    return fmt::format("{} <- {}", port_name(graph.nodes()[edge.to].description().in_ports, edge.to_port),
                       edge.previous ? "previous(" + source + ")" : source);
}

int check(const CommandLine& line) {
    host::Catalog catalog(plugin_folders(line));
    const graph::Document document = load_document(line);
    report::read_expected(report::expected_file_of(line.argument(0)));  // throws if its form is wrong
    const campaign::Prepared prepared =
        campaign::prepare(document, read_selection(line),
                          [&catalog](const std::string& id) -> const host::LoadedPlugin& { return catalog.load(id); });
    const graph::Graph& graph = *prepared.first;
    const campaign::Plan& plan = prepared.plan;
    if (line.has("json")) {
        Json json{{"config", line.argument(0)}};
        json.update(graph_json(graph));
        if (!plan.is_single_run()) {
            json["campaign"] = campaign::campaign_json(plan);
            json["campaign"]["runs"] = plan.runs;
        }
        print_json(json);
        return static_cast<int>(Exit::done);
    }
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < graph.nodes().size(); ++i) {
        std::string edges;
        for (const graph::Edge& edge : graph.edges())
            if (edge.to == i) edges += (edges.empty() ? "" : ", ") + edge_text(graph, edge);
        rows.push_back({graph.nodes()[i].name, graph.nodes()[i].plugin->file.id, edges});
    }
    const std::string campaign = plan.is_single_run()
                                     ? ""
                                     : fmt::format(", {} of {}", counted(plan.cells.size(), "cell"),
                                                   counted(static_cast<std::size_t>(plan.runs), "run"));
    print(fmt::format("{}: good: {}, {}, {}{}\n{}", line.argument(0), counted(graph.nodes().size(), "node"),
                      counted(graph.edges().size(), "edge"), counted(prepared.plugins.size(), "plugin"), campaign,
                      aligned(rows, 2)));
    return static_cast<int>(Exit::done);
}

}  // namespace

Command check_command() {
    std::vector<Flag> flags = config_flags();
    for (const Flag& flag : campaign_flags()) flags.push_back(flag);
    flags.push_back({"json", "", "the nodes, edges and plugins, or the problems, as JSON"});
    return {"check",
            "check wiring and values of a config, run nothing",
            "Reads CONFIG, loads the plugins that it names, checks every key and value against what the plugins say of "
            "themselves, makes all instances and joins the nodes. All that is wrong is told at once, one line each, "
            "FILE:LINE:COLUMN: what was expected. Of a campaign, the config of every cell is checked, and the first "
            "one's graph told.",
            {{"CONFIG"}, flags, {}},
            {{"pelorus check configs/airship.yaml", "is it good?"},
             {"pelorus check c.yaml --set 'tracker.estimator.motion=~'", "is it still, without that part?"}},
            &check};
}

}  // namespace pelorus::cli
