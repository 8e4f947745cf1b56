#include "campaign/prepare.hpp"

#include <map>
#include <utility>

#include "host/error.hpp"
#include "report/provenance.hpp"
#include "runtime/config_difference.hpp"
#include "runtime/wiring.hpp"

namespace pelorus::campaign {

namespace {

using Json = nlohmann::ordered_json;

void take(const ConfigError& error, graph::Problems& problems) {
    for (const ConfigError::Item& item : error.items()) problems.add(item.where, item.text);
}

/// Where the campaign's own structure is wrong, the graph is checked all the same: one pass tells everything.
[[noreturn]] void raise(const graph::Document& document, const graph::PluginFinder& finder, graph::Problems& problems) {
    try {
        graph::Graph::build(document, finder, {});
    } catch (const ConfigError& error) {
        graph::Problems all;
        take(error, all);
        take(ConfigError(problems.items()), all);
        all.raise();
    }
    problems.raise();
    throw Error(Exit::misuse, "the campaign cannot be planned");
}

}  // namespace

Prepared prepare(const graph::Document& document, const Selection& selection, const graph::PluginFinder& finder) {
    graph::Problems problems;
    Prepared prepared;
    prepared.plan = plan_cells(document, selection, problems);
    if (!problems.empty()) raise(document, finder, problems);
    std::map<std::string, const host::LoadedPlugin*> plugins;
    prepared.determinants = Json::object();
    for (Cell& cell : prepared.plan.cells) {
        try {
            graph::Graph graph = graph::Graph::plan(document_of(document, cell), finder, {});
            graph.renew({});
            cell.shown_sweep = sweep_json(cell, graph.resolved());
            prepared.determinants[cell_text(cell)] = runtime::determinants(graph);
            for (const host::LoadedPlugin* plugin : graph.plugins()) plugins.emplace(plugin->file.id, plugin);
            if (cell.index == 0) prepared.first = std::move(graph);
        } catch (const ConfigError& error) {
            take(error, problems);
        }
    }
    problems.raise();
    for (const auto& [id, plugin] : plugins) prepared.plugins.push_back(plugin);
    return prepared;
}

Json identity_of(const Prepared& prepared) {
    Json identity{{"format", 1}, {"runs", prepared.plan.runs}, {"host", report::build_facts()}};
    identity["plugins"] = Json::object();
    for (const host::LoadedPlugin* plugin : prepared.plugins)
        identity["plugins"][plugin->file.id] = {{"version", plugin->file.version}, {"sha256", plugin->sha256()}};
    identity["reference"] = prepared.plan.reference;
    identity["cells"] = prepared.determinants;
    return identity;
}

std::string difference(const Json& there, const Json& here) {
    if (there == here) return {};
    const std::string found = runtime::first_difference(there.dump(-1, ' ', false, Json::error_handler_t::replace),
                                                        here.dump(-1, ' ', false, Json::error_handler_t::replace));
    return found.empty() ? "the order of the cells is another" : found;
}

Json campaign_json(const Plan& plan) {
    Json cells = Json::array();
    for (const Cell& cell : plan.cells) cells.push_back({{"variant", cell.variant}, {"sweep", cell.shown_sweep}});
    return {
        {"on_failure", plan.goes_on ? "continue" : "stop"}, {"reference", plan.reference}, {"cells", std::move(cells)}};
}

}  // namespace pelorus::campaign
