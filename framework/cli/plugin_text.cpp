#include "cli/plugin_text.hpp"

#include <fmt/format.h>

#include "cli/example.hpp"
#include "cli/output.hpp"
#include "cli/type_text.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

std::string section(const std::string& heading, const std::string& body) {
    return body.empty() ? "" : "\n" + heading + "\n" + body;
}

std::string prose(const std::string& heading, const Json& text) {
    return section(heading, wrapped(text.get<std::string>(), 2));
}

std::string parameters_text(const Json& parameters, std::size_t indent) {
    std::string text;
    for (const Json& parameter : parameters) {
        text += fmt::format("{:{}}{}: {}\n", "", indent, parameter["name"].get<std::string>(), type_text(parameter));
        text += wrapped(parameter["doc"].get<std::string>(), indent + 4);
        if (parameter.contains("choices"))
            for (const Json& choice : parameter["choices"]) {
                const std::string doc = choice["doc"];
                text += wrapped(choice["name"].get<std::string>() + (doc.empty() ? "" : ": " + doc), indent + 4);
            }
        if (parameter.contains("columns"))
            text += fmt::format("{:{}}columns\n", "", indent + 4) + parameters_text(parameter["columns"], indent + 6);
    }
    return text;
}

std::string space_text(const Json& space) {
    Rows rows;
    for (const Json& component : space) {
        const bool angle = component.contains("angle");
        std::string prior;
        if (component.contains("prior") && component["prior"]["deviation"].get<double>() > 0)
            prior = fmt::format("prior {:g} +- {:g}", component["prior"]["mean"].get<double>(),
                                component["prior"]["deviation"].get<double>());
        rows.push_back(
            {component["name"].get<std::string>(), component["unit"].get<std::string>(), angle ? "angle" : "", prior});
    }
    return aligned(rows, 2);
}

std::string instance_text(const Json& plugin) {
    const Json& instance = plugin["instance"];
    if (instance.contains("unavailable"))
        return section("spaces", wrapped("depend on its parts and values; an instance made as in the example says: " +
                                             instance["unavailable"].get<std::string>(),
                                         2));
    std::string text;
    if (plugin["example"].contains("parts"))
        text = section("spaces", "  depend on its parts; these are of an instance made as in the example\n");
    if (instance.contains("spaces"))
        for (const auto& [name, space] : instance["spaces"].items())
            text += section(name + " space", space_text(space));
    if (instance.contains("record") && instance["record"] != 0)
        text += section("record", fmt::format("  {} doubles\n", instance["record"].get<std::int64_t>()));
    std::string extensions;
    if (instance.contains("extensions"))
        for (const Json& id : instance["extensions"]) extensions += "  " + id.get<std::string>() + "\n";
    return text + section("extensions", extensions);
}

std::string slots_text(const Json& slots) {
    std::string text;
    for (const Json& slot : slots) {
        text += fmt::format("  {}: kind {}, parts: {}\n", slot["name"].get<std::string>(),
                            slot["kind"].get<std::string>(), range_text(slot["parts"]));
        text += wrapped(slot["doc"].get<std::string>(), 6);
        std::string ids;
        for (const Json& id : slot["takes"]) ids += (ids.empty() ? "" : ", ") + id.get<std::string>();
        text += wrapped("there are: " + (ids.empty() ? "none" : ids), 6);
        if (!slot["parameters"].empty())
            text += "      asks of each part, in its own `with`\n" + parameters_text(slot["parameters"], 8);
    }
    return text;
}

std::string ports_text(const Json& ports) {
    Rows rows;
    for (const Json& port : ports) {
        std::string message = port["message"];
        if (port["optional"].get<bool>()) message += ", optional";
        if (port["many"].get<bool>()) message += ", several edges";
        rows.push_back({port["name"].get<std::string>(), message, port["doc"].get<std::string>()});
    }
    return aligned(rows, 2);
}

std::string inputs_text(const Json& inputs) {
    Rows rows;
    for (const Json& input : inputs)
        rows.push_back({input["name"].get<std::string>(), "[" + input["unit"].get<std::string>() + "]",
                        "default " + input["default"].dump(), input["doc"].get<std::string>()});
    return aligned(rows, 2);
}

/// Where a model may stand.
std::string places_text(const Json& plugin) {
    if (!plugin.contains("stands_in")) return {};
    std::string places;
    for (const Json& place : plugin["stands_in"])
        places += (places.empty() ? "" : ", ") +
                  fmt::format("{} (slot {})", place["plugin"].get<std::string>(), place["slot"].get<std::string>());
    return wrapped(places.empty() ? "no plugin that is there has a slot for it" : places, 2);
}

/// As it is pasted into `graph:`, or into the `parts:` of what holds it.
std::string example_text(const Json& plugin) {
    const bool is_stage = plugin["tier"] == "stage";
    const std::string kind = plugin["kind"];
    if (is_stage || plugin["stands_in"].empty()) return block_text(kind, plugin["example"], 2);
    return block_text(plugin["stands_in"][0]["slot"], plugin["example"], 2);
}

}  // namespace

std::string plugin_text(const Json& plugin) {
    const auto string = [&](const char* key) { return plugin[key].get<std::string>(); };
    return string("id") + ": " + string("title") + "\n" +
           aligned({{"kind", string("kind") + " (" + string("tier") + ")"},
                    {"version", string("version")},
                    {"license", string("license")},
                    {"library", string("library")}},
                   2) +
           prose("purpose", plugin["purpose"]) + prose("equation", plugin["equation"]) +
           prose("source", plugin["source"]) + (plugin.contains("instance") ? instance_text(plugin) : "") +
           section("slots", slots_text(plugin["slots"])) + section("in ports", ports_text(plugin["in_ports"])) +
           section("out ports", ports_text(plugin["out_ports"])) +
           section("inputs (values that change while it runs)", inputs_text(plugin["inputs"])) +
           section("parameters", parameters_text(plugin["parameters"], 2)) + section("stands in", places_text(plugin)) +
           section("example", example_text(plugin));
}

}  // namespace pelorus::cli
