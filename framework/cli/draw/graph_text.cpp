#include <vector>

#include "cli/draw/drawing.hpp"
#include "cli/output.hpp"
#include "cli/value_json.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& json, const char* key) { return json[key].get<std::string>(); }

/// `scans: 60, period: 2 s`
std::string values_text(const Json& with, std::size_t indent) {
    std::string text;
    for (const auto& [name, value] : with.items()) text += (text.empty() ? "" : ", ") + name + ": " + flow_text(value);
    return wrapped(text, indent);
}

std::string parts_text(const Json& parts, std::size_t indent) {
    std::string text, slot;
    for (const Json& part : parts) {
        const std::string name = text_of(part, "name");
        const bool is_new = text_of(part, "slot") != slot;
        slot = text_of(part, "slot");
        std::size_t below = indent + 2;
        if (name.empty()) {
            text += std::string(indent, ' ') + slot + ": " + text_of(part, "use") + "\n";
        } else {
            if (is_new) text += std::string(indent, ' ') + slot + "\n";
            text += std::string(below, ' ') + name + ": " + text_of(part, "use") + "\n";
            below += 2;
        }
        text += values_text(part["with"], below) + parts_text(part["parts"], below);
    }
    return text;
}

std::string port_of(const std::string& address) { return address.substr(address.find('.') + 1); }
std::string node_of(const std::string& address) { return address.substr(0, address.find('.')); }

/// The edges of one out port as one line, with what flows through them.
std::string out_text(const Json& edges, const std::string& from) {
    std::string ends, message;
    const Json* streams = nullptr;
    for (const Json& edge : edges) {
        if (edge["from"] != from) continue;
        ends += (ends.empty() ? "" : ", ") + text_of(edge, "to") + (edge["feedback"] == true ? " (feedback)" : "");
        message = text_of(edge, "message");
        streams = &edge["streams"];
    }
    std::string text = wrapped(port_of(from) + " (" + message + ") -> " + ends, 2);
    for (const Json& stream : *streams) text += wrapped(stream_text(stream), 6);
    return text;
}

std::string edges_text(const Json& edges, const std::string& node) {
    std::vector<std::string> outs;
    std::string text;
    for (const Json& edge : edges) {
        const std::string from = text_of(edge, "from"), to = text_of(edge, "to");
        if (node_of(to) == node)
            text += "  " + port_of(to) + " <- " + (edge["feedback"] == true ? "previous(" + from + ")" : from) + "\n";
        bool is_known = node_of(from) != node;
        for (const std::string& known : outs) is_known = is_known || known == from;
        if (!is_known) outs.push_back(from);
    }
    for (const std::string& from : outs) text += out_text(edges, from);
    return text;
}

}  // namespace

std::string stream_text(const Json& stream) {
    std::string text, stem, unit;
    for (const Json& component : stream["space"]) {
        const std::string name = text_of(component, "name");
        const std::size_t dot = name.rfind('.');
        const std::string own_stem = dot == std::string::npos ? "" : name.substr(0, dot + 1);
        const bool goes_on = !text.empty() && component["unit"] == unit && !stem.empty() && own_stem == stem;
        if (goes_on) {
            text += "," + name.substr(dot + 1);
            continue;
        }
        if (!text.empty()) text += (unit.empty() ? "" : " [" + unit + "]") + "; ";
        text += name;
        stem = own_stem;
        unit = text_of(component, "unit");
    }
    if (!unit.empty()) text += " [" + unit + "]";
    const std::string sensor = text_of(stream, "sensor"), frame = text_of(stream, "frame");
    return (sensor.empty() ? "" : sensor + ": ") + text + (frame.empty() ? "" : ", in frame '" + frame + "'");
}

std::string graph_text(const Json& graph) {
    std::string text = text_of(graph, "title");
    if (!text.empty()) text += "\n";
    for (const Json& node : graph["nodes"]) {
        const std::string name = text_of(node, "name"), frame = text_of(node, "frame");
        text += (text.empty() ? "" : "\n") + name + ": " + text_of(node, "use") +
                (frame.empty() ? "" : ", in frame '" + frame + "'") + "\n";
        text += values_text(node["with"], 2) + parts_text(node["parts"], 2) + edges_text(graph["edges"], name);
    }
    return text;
}

}  // namespace pelorus::cli
