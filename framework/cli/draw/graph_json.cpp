#include "cli/draw/graph_json.hpp"

#include "cli/value_json.hpp"
#include "graph/parameters.hpp"
#include "graph/plan.hpp"
#include "host/description.hpp"
#include "host/kinds.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;
using host::element;

/// Those of `count` parameters whose values are not the defaults, as the config writes them.
void add_changed(const plr_parameter* first, std::uint32_t count, const graph::ParameterSet& values,
                 const graph::PartPlan& part, Json& json) {
    graph::Problems ignored;  // required parameters have no default
    graph::Value nothing;
    nothing.kind = graph::Value::Kind::map;
    const auto variable = [](const std::string&) { return std::optional<std::string>(); };
    const graph::ParameterSet defaults = graph::read_parameters(
        first, count, nothing, {ignored, part.address, part.plugin->file.id, part.use_where, {}, variable});
    const Json now = graph::parameters_json(first, values), before = graph::parameters_json(first, defaults);
    for (const auto& [name, value] : now.items()) {
        const graph::Value* const given = part.with.find(name);
        if (given != nullptr && !given->is_null() && (!before.contains(name) || before[name] != value))
            json[name] = value_json(*given);
    }
}

void add_contents(const graph::PartPlan& part, Json& json) {
    const plr_description& description = part.description();
    Json with = Json::object(), parts = Json::array();
    add_changed(description.parameters, description.parameter_count, part.values, part, with);
    if (part.place != nullptr)
        add_changed(part.place->parameters, part.place->parameter_count, part.slot_values, part, with);
    for (const auto& below : part.parts) {
        Json each{{"address", below->address},
                  {"slot", below->slot},
                  {"name", below->name},
                  {"use", below->description().id}};
        add_contents(*below, each);
        parts.push_back(std::move(each));
    }
    json["with"] = std::move(with);
    json["parts"] = std::move(parts);
}

Json stream_json(const plr_stream& stream) {
    Json space = Json::array();
    for (std::uint32_t i = 0; i < stream.space->size; ++i) {
        const plr_component& component = element(stream.space->components, i);
        space.push_back({{"name", component.name}, {"unit", component.unit}});
    }
    return {{"sensor", stream.sensor}, {"frame", stream.frame}, {"space", std::move(space)}};
}

Json edge_json(const graph::Graph& graph, std::size_t index) {
    const graph::Edge& edge = graph.edges()[index];
    const graph::Node &from = graph.nodes()[edge.from], &to = graph.nodes()[edge.to];
    const plr_port& out = element(from.description().out_ports, static_cast<std::uint32_t>(edge.from_port));
    const plr_port& in = element(to.description().in_ports, static_cast<std::uint32_t>(edge.to_port));
    Json streams = Json::array();
    for (const plr_stream* stream : graph.streams(index)) streams.push_back(stream_json(*stream));
    return {{"from", from.name + "." + out.name},
            {"to", to.name + "." + in.name},
            {"message", host::message_kind_name(out.message)},
            {"feedback", edge.previous},
            {"streams", std::move(streams)}};
}

}  // namespace

Json graph_json(const graph::Graph& graph) {
    Json nodes = Json::array(), edges = Json::array(), plugins = Json::array();
    for (const graph::NodePlan& plan : graph.plans()) {
        Json node{{"name", plan.name},
                  {"use", plan.part->description().id},
                  {"kind", plan.part->description().kind},
                  {"frame", plan.frame}};
        add_contents(*plan.part, node);
        nodes.push_back(std::move(node));
    }
    for (std::size_t i = 0; i < graph.edges().size(); ++i) edges.push_back(edge_json(graph, i));
    for (const host::LoadedPlugin* plugin : graph.plugins())
        plugins.push_back(
            {{"id", plugin->file.id}, {"version", plugin->file.version}, {"library", plugin->file.library.string()}});
    return {{"title", graph.title()},
            {"seed", graph.seed()},
            {"nodes", std::move(nodes)},
            {"edges", std::move(edges)},
            {"plugins", std::move(plugins)}};
}

}  // namespace pelorus::cli
