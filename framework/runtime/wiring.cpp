#include "runtime/wiring.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/breadcrumb.hpp"
#include "host/description.hpp"
#include "host/plugin_error.hpp"
#include "runtime/message_fields.hpp"

namespace pelorus::runtime {
namespace {

using Json = nlohmann::ordered_json;

std::vector<Wiring::Port> ports_of(const plr_port* first, std::uint32_t count) {
    std::vector<Wiring::Port> ports;
    for (std::uint32_t i = 0; i < count; ++i) {
        const plr_port& port = host::element(first, i);
        ports.push_back({port.name, port.message, {}, 0});
    }
    return ports;
}

void ask_streams(const Wiring::Node& node, bool is_output, std::uint32_t index, Wiring::Port& port) {
    plr_port_type type{};
    type.struct_size = sizeof type;
    plr_error error = host::empty_error();
    const plr_status status = host::guarded(error, [&] {
        const host::Breadcrumb crumb({node.name.c_str(), node.plugin.c_str(), "port_type", port.name.c_str()});
        return stage_functions(node.instance).port_type(node.instance.self, is_output ? 1 : 0, index, &type, &error);
    });
    if (status != PLR_OK)
        throw Error(Exit::run_failed,
                    fmt::format("node {} ({}), {} port {}: {}", node.name, node.plugin, is_output ? "out" : "in",
                                port.name, host::error_text(status, error)));
    for (std::uint32_t i = 0; type.streams && i < type.stream_count; ++i)
        port.streams.push_back(known_element(type.streams, i));
    port.passes_on = type.passes_on;
}

/// Adds what comes in at the port that `out` passes on. Where that is not known (over a feedback edge, or a port that
/// declared nothing), nothing is known of `out` either.
void add_passed_on(const Wiring& wiring, std::size_t node, Wiring::Port& out) {
    const std::size_t own = out.streams.size();
    for (const graph::Edge& edge : wiring.edges) {
        if (edge.to != node || edge.to_port + 1 != out.passes_on) continue;
        const std::vector<plr_stream>& offered = wiring.nodes[edge.from].out_ports[edge.from_port].streams;
        if (edge.previous || offered.empty()) {
            out.streams.clear();
            return;
        }
        for (const plr_stream& stream : offered) {
            const auto replaces = [&](const plr_stream& one) {
                return one.sensor && stream.sensor && std::strcmp(one.sensor, stream.sensor) == 0;
            };
            if (std::none_of(out.streams.begin(), out.streams.begin() + static_cast<std::ptrdiff_t>(own), replaces))
                out.streams.push_back(stream);
        }
    }
}

/// Where files lie does not change a run, only what they are called; so a snapshot can be resumed with another result
/// folder or another place of the recordings.
void shorten_paths(Json& config, const std::map<std::string, const plr_description*>& plugins) {
    if (config.is_object() && config.contains("use") && config["use"].is_string() && config.contains("with")) {
        const auto plugin = plugins.find(config["use"].get<std::string>());
        for (std::uint32_t i = 0; plugin != plugins.end() && i < plugin->second->parameter_count; ++i) {
            const plr_parameter& parameter = host::element(plugin->second->parameters, i);
            if (parameter.type != PLR_TYPE_PATH || !config["with"].contains(parameter.name)) continue;
            Json& value = config["with"][parameter.name];
            if (value.is_string()) value = std::filesystem::path(value.get<std::string>()).filename().string();
        }
    }
    if (config.is_structured())
        for (auto& part : config) shorten_paths(part, plugins);
}

}  // namespace

Json determinants(const graph::Graph& graph) {
    std::map<std::string, const plr_description*> plugins;
    Json versions = Json::object();
    for (const host::LoadedPlugin* plugin : graph.plugins()) {
        plugins[plugin->file.id] = &plugin->description();
        versions[plugin->file.id] = plugin->file.version;
    }
    Json config = graph.resolved();
    for (const char* irrelevant : {"title", "campaign"})
        if (config.is_object()) config.erase(irrelevant);
    shorten_paths(config, plugins);
    return {{"seed", graph.seed()}, {"config", config}, {"plugins", versions}};
}

namespace {

std::string parameters_of(const graph::Graph& graph) {
    Json parameters = determinants(graph);
    if (graph.run() != 0) parameters["run"] = graph.run();
    return parameters.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

plr_stage stage_functions(const plr_instance& instance) {
    plr_stage stage{};
    std::memcpy(&stage, instance.table, std::min<std::size_t>(instance.table->struct_size, sizeof stage));
    return stage;
}

Wiring::Node wire_node(std::string name, const plr_description& description, plr_instance instance,
                       host::InstanceHost* host) {
    Wiring::Node node;
    node.name = std::move(name);
    node.plugin = description.id;
    node.kind = description.kind;
    node.version = description.version;
    node.instance = instance;
    node.host = host;
    node.in_ports = ports_of(description.in_ports, description.in_port_count);
    node.out_ports = ports_of(description.out_ports, description.out_port_count);
    if (!stage_functions(instance).port_type) return node;
    for (std::uint32_t i = 0; i < description.in_port_count; ++i) ask_streams(node, false, i, node.in_ports[i]);
    for (std::uint32_t i = 0; i < description.out_port_count; ++i) ask_streams(node, true, i, node.out_ports[i]);
    return node;
}

void resolve_streams(Wiring& wiring) {
    for (const std::size_t node : wiring.order)
        for (Wiring::Port& out : wiring.nodes[node].out_ports)
            if (out.passes_on != 0) add_passed_on(wiring, node, out);
}

Wiring wire(const graph::Graph& graph, Snapshots snapshots) {
    Wiring wiring;
    for (const graph::Node& node : graph.nodes())
        wiring.nodes.push_back(wire_node(node.name, node.description(), node.instance, node.host));
    wiring.edges = graph.edges();
    wiring.order = graph.order();
    wiring.guard = graph.guard();
    if (snapshots == Snapshots::possible) wiring.parameters = parameters_of(graph);
    resolve_streams(wiring);
    return wiring;
}

}  // namespace pelorus::runtime
