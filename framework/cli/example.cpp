#include "cli/example.hpp"

#include <algorithm>
#include <cmath>

#include "cli/value_json.hpp"
#include "graph/yaml.hpp"

namespace pelorus::cli {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t line_width = 90;

/// 1 where that is allowed, else the nearest round number that is.
double number_within(const Json& parameter) {
    double number = 1;
    if (parameter.contains("min")) number = std::max(number, parameter["min"].get<double>());
    if (parameter.contains("max")) number = std::min(number, parameter["max"].get<double>());
    if (parameter.contains("above") && number <= parameter["above"])
        number = parameter.contains("max") ? parameter["max"].get<double>() : parameter["above"].get<double>() + 1;
    if (parameter.contains("below") && number >= parameter["below"]) {
        const double below = parameter["below"];
        const double least = parameter.contains("min")     ? parameter["min"].get<double>()
                             : parameter.contains("above") ? parameter["above"].get<double>()
                                                           : below - 2;
        number = (least + below) / 2;
    }
    return number;
}

Json quantity(const Json& parameter, const std::string& unit) {
    const double number = number_within(parameter);
    const Json json = number == std::floor(number) ? Json(static_cast<std::int64_t>(number)) : Json(number);
    return unit.empty() ? json : Json(json.dump() + " " + unit);
}

/// The unit of an element of `m, rad, rad`, or the one for all.
std::string unit_of(const std::string& units, std::size_t index) {
    std::size_t begin = 0;
    for (; index > 0 && units.find(',', begin) != std::string::npos; --index) begin = units.find(',', begin) + 1;
    const std::string unit = units.substr(begin, units.find(',', begin) - begin);
    return unit.substr(std::min(unit.size(), unit.find_first_not_of(' ')));
}

Json value_for(const Json& parameter);

Json list_for(const Json& parameter) {
    const std::string type = parameter["type"], units = parameter["unit"];
    Json list = Json::array();
    const auto rows = std::max<std::size_t>(1, parameter["rows"]["min"].get<std::size_t>());
    for (std::size_t r = 0; r < rows; ++r) {
        if (type == "vector") {
            list.push_back(quantity(parameter, unit_of(units, r)));
        } else if (type == "matrix") {
            list.push_back(Json::array());
            const auto cols = std::max<std::size_t>(1, parameter["cols"]["min"].get<std::size_t>());
            for (std::size_t c = 0; c < cols; ++c) list.back().push_back(quantity(parameter, unit_of(units, r)));
        } else {
            list.push_back(Json::object());
            for (const Json& column : parameter["columns"])
                if (column["required"] == true) list.back()[column["name"]] = value_for(column);
        }
    }
    return list;
}

Json value_for(const Json& parameter) {
    const std::string type = parameter["type"], name = parameter["name"];
    if (type == "bool") return true;
    if (type == "int" || type == "double") return quantity(parameter, parameter["unit"]);
    if (type == "choice") return parameter["choices"][0]["name"];
    if (type == "path") return name + ".txt";
    return type == "string" ? Json(name) : list_for(parameter);
}

/// Required ones with some value; others, if asked for, with their defaults.
Json values_for(const Json& parameters, bool with_defaults) {
    Json with = Json::object();
    for (const Json& parameter : parameters)
        if (parameter["required"] == true)
            with[parameter["name"]] = value_for(parameter);
        else if (with_defaults && parameter["default"].is_string())
            with[parameter["name"]] = value_json(graph::read_yaml(parameter["default"], {Location("default"), {}, {}}));
    return with;
}

}  // namespace

/// Those that stand by themselves first, then those that hold others of their kind.
Json ExampleMaker::fill(const Json& slot, Chain& chain) const {
    for (const bool holds_its_kind : {false, true}) {
        for (const Json& plugin : plugins_) {
            if (plugin["kind"] != slot["kind"]) continue;
            const auto is_of_kind = [&](const Json& own) { return own["kind"] == plugin["kind"]; };
            const Json& slots = plugin["slots"];
            if (std::any_of(slots.begin(), slots.end(), is_of_kind) != holds_its_kind) continue;
            Json found = part(plugin, &slot, chain);
            if (!found.is_null()) return found;
        }
    }
    return nullptr;
}

Json ExampleMaker::part(const Json& plugin, const Json* slot, Chain& chain) const {
    const std::string id = plugin["id"];
    if (std::find(chain.begin(), chain.end(), id) != chain.end()) return nullptr;  // holds its own kind
    Json json{{"use", id}};
    // A model by itself shows what can be set in it; a stage has too many values, and mostly leaves them as they are.
    const bool is_stage = plugin["tier"] == "stage";
    Json with = values_for(plugin["parameters"], slot == nullptr && !is_stage), parts = Json::object();
    if (slot != nullptr) with.update(values_for((*slot)["parameters"], false));
    chain.push_back(id);
    bool is_complete = true;
    for (const Json& own : plugin["slots"]) {
        const bool is_single = own["parts"].contains("max") && own["parts"]["max"] == 1;
        const int least = own["parts"]["min"];
        if (least == 0 && !(is_single && is_stage)) continue;
        const Json filling = fill(own, chain);
        is_complete = is_complete && (least == 0 || !filling.is_null());
        if (filling.is_null()) continue;
        const std::string slot_name = own["name"], kind = own["kind"];
        if (is_single)
            parts[slot_name] = filling;
        else
            for (int i = 0; i < least; ++i)
                parts[slot_name][least == 1 ? kind : kind + std::to_string(i + 1)] = filling;
    }
    chain.pop_back();
    if (!is_complete && slot != nullptr) return nullptr;
    if (!with.empty()) json["with"] = std::move(with);
    if (!parts.empty()) json["parts"] = std::move(parts);
    return json;
}

/// A port that tells what `in` takes: of something that needs no node before it, if there is one.
std::string ExampleMaker::origin(const Json& plugin, const Json& in) const {
    for (const bool is_source : {true, false})
        for (const Json& other : plugins_)
            for (const Json& out : other["out_ports"])
                if (out["message"] == in["message"] && other["kind"] != plugin["kind"] &&
                    (other["kind"] == "source") == is_source)
                    return other["kind"].get<std::string>() + "." + out["name"].get<std::string>();
    return "";
}

Json ExampleMaker::edges(const Json& plugin) const {
    Json edges = Json::object();
    const Json& ports = plugin["in_ports"];
    const bool is_end = plugin["out_ports"].empty();
    const bool all_optional =
        std::all_of(ports.begin(), ports.end(), [](const Json& port) { return port["optional"] == true; });
    for (const Json& in : ports) {
        if (in["optional"] == true && !(is_end && all_optional)) continue;
        const std::string from = origin(plugin, in);
        edges[in["name"]] = from.empty() ? "NODE.PORT" : from;
    }
    return edges;
}

Json ExampleMaker::example(const Json& plugin) const {
    Chain chain;
    Json json = part(plugin, nullptr, chain);
    Json in = edges(plugin);
    if (in.empty()) return json;
    Json all{{"use", json["use"]}, {"in", std::move(in)}};
    for (const char* key : {"with", "parts"})
        if (json.contains(key)) all[key] = json[key];
    return all;
}

std::string block_text(const std::string& key, const Json& value, std::size_t indent) {
    const std::string margin(indent, ' ');
    const std::string line = margin + key + ": " + flow_text(value);
    if (!value.is_object() || line.size() <= line_width) return line + "\n";
    std::string text = margin + key + ":\n";
    for (const auto& [below, content] : value.items()) text += block_text(below, content, indent + 2);
    return text;
}

}  // namespace pelorus::cli
