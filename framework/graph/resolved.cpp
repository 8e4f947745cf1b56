#include "graph/resolved.hpp"

#include <nlohmann/json.hpp>

#include "host/description.hpp"

namespace pelorus::graph {

namespace {

using host::element;
using nlohmann::ordered_json;

void add_contents(const PartPlan& part, ordered_json& json) {
    ordered_json with = parameters_json(part.description().parameters, part.values);
    if (part.place != nullptr) with.update(parameters_json(part.place->parameters, part.slot_values));
    if (!with.empty()) json["with"] = std::move(with);
    for (const std::unique_ptr<PartPlan>& below : part.parts) {
        ordered_json below_json{{"use", below->description().id}};
        add_contents(*below, below_json);
        ordered_json& slot = json["parts"][below->slot];
        if (below->name.empty())
            slot = std::move(below_json);
        else
            slot[below->name] = std::move(below_json);
    }
}

ordered_json edges_json(const std::vector<NodePlan>& nodes, const std::vector<Edge>& edges, std::size_t node) {
    auto json = ordered_json::object();
    for (const Edge& edge : edges) {
        if (edge.to != node) continue;
        const plr_description& from = nodes[edge.from].part->description();
        const plr_description& to = nodes[node].part->description();
        const plr_port& port = element(to.in_ports, static_cast<std::uint32_t>(edge.to_port));
        std::string address =
            nodes[edge.from].name + "." + element(from.out_ports, static_cast<std::uint32_t>(edge.from_port)).name;
        if (edge.previous) address = "previous(" + address + ")";
        if ((port.flags & PLR_PORT_MANY) != 0)
            json[port.name].push_back(std::move(address));
        else
            json[port.name] = std::move(address);
    }
    return json;
}

}  // namespace

ordered_json graph_json(const std::vector<NodePlan>& nodes, const std::vector<Edge>& edges) {
    auto json = ordered_json::object();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        ordered_json node{{"use", nodes[i].part->description().id}};
        if (!nodes[i].frame.empty()) node["frame"] = nodes[i].frame;
        ordered_json in = edges_json(nodes, edges, i);
        if (!in.empty()) node["in"] = std::move(in);
        add_contents(*nodes[i].part, node);
        json[nodes[i].name] = std::move(node);
    }
    return json;
}

}  // namespace pelorus::graph
