#include "cli/plugin_json.hpp"

#include <cmath>

#include "host/description.hpp"
#include "host/error.hpp"
#include "host/kinds.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;
using host::element;

const char* type_name(std::uint32_t type) {
    static constexpr const char* names[] = {"",       "bool", "int",    "double", "string",
                                            "choice", "path", "vector", "matrix", "table"};
    return type < std::size(names) ? names[type] : "";
}

/// {min, max}; no max where there is none.
Json range(std::int32_t least, std::int32_t most) {
    Json json{{"min", least}};
    if (most >= 0) json["max"] = most;
    return json;
}

void add_bounds(Json& json, const plr_parameter& parameter) {
    if (std::isfinite(parameter.min))
        json[(parameter.flags & PLR_PARAMETER_MIN_EXCLUSIVE) != 0 ? "above" : "min"] = parameter.min;
    if (std::isfinite(parameter.max))
        json[(parameter.flags & PLR_PARAMETER_MAX_EXCLUSIVE) != 0 ? "below" : "max"] = parameter.max;
}

Json choices_json(const plr_parameter& parameter) {
    Json json = Json::array();
    for (std::uint32_t i = 0; i < parameter.choice_count; ++i)
        json.push_back({{"name", parameter.choices[i]},
                        {"doc", parameter.choice_docs == nullptr ? "" : parameter.choice_docs[i]}});
    return json;
}

Json parameters_json(const plr_parameter* first, std::uint32_t count) {
    Json list = Json::array();
    for (std::uint32_t i = 0; i < count; ++i) {
        const plr_parameter& parameter = element(first, i);
        Json json{{"name", parameter.name}, {"type", type_name(parameter.type)}, {"unit", parameter.unit}};
        json["required"] = (parameter.flags & PLR_PARAMETER_REQUIRED) != 0;
        json["default"] = parameter.default_text == nullptr ? Json(nullptr) : Json(parameter.default_text);
        add_bounds(json, parameter);
        if (parameter.type == PLR_TYPE_CHOICE) json["choices"] = choices_json(parameter);
        if (parameter.type >= PLR_TYPE_VECTOR) json["rows"] = range(parameter.rows_min, parameter.rows_max);
        if (parameter.type == PLR_TYPE_MATRIX) json["cols"] = range(parameter.cols_min, parameter.cols_max);
        if (parameter.type == PLR_TYPE_TABLE)
            json["columns"] = parameters_json(parameter.columns, parameter.column_count);
        json["doc"] = parameter.doc;
        list.push_back(std::move(json));
    }
    return list;
}

Json inputs_json(const plr_description& description) {
    Json list = Json::array();
    for (std::uint32_t i = 0; i < description.input_count; ++i) {
        const plr_input& input = element(description.inputs, i);
        list.push_back({{"name", input.name},
                        {"unit", input.unit},
                        {"default", std::vector<double>(input.defaults, input.defaults + input.size)},
                        {"doc", input.doc}});
    }
    return list;
}

Json slots_json(const plr_description& description) {
    Json list = Json::array();
    for (std::uint32_t i = 0; i < description.slot_count; ++i) {
        const plr_slot& slot = element(description.slots, i);
        list.push_back({{"name", slot.name},
                        {"kind", slot.kind},
                        {"parts", range(slot.min, slot.max)},
                        {"doc", slot.doc},
                        {"parameters", parameters_json(slot.parameters, slot.parameter_count)}});
    }
    return list;
}

Json ports_json(const plr_port* first, std::uint32_t count) {
    Json list = Json::array();
    for (std::uint32_t i = 0; i < count; ++i) {
        const plr_port& port = element(first, i);
        list.push_back({{"name", port.name},
                        {"message", host::message_kind_name(port.message)},
                        {"optional", (port.flags & PLR_PORT_OPTIONAL) != 0},
                        {"many", (port.flags & PLR_PORT_MANY) != 0},
                        {"doc", port.doc}});
    }
    return list;
}

}  // namespace

Json description_json(const host::LoadedPlugin& plugin) {
    const plr_description& description = plugin.description();
    const bool is_stage = host::find_kind(plugin.file.kind)->is_stage;
    Json json{{"id", plugin.file.id},
              {"kind", plugin.file.kind},
              {"tier", is_stage ? "stage" : "model"},
              {"version", plugin.file.version},
              {"title", description.title},
              {"purpose", description.purpose},
              {"equation", description.equation},
              {"source", description.source},
              {"license", description.license},
              {"table", plugin.file.table_id},
              {"library", plugin.file.library.string()}};
    json["slots"] = slots_json(description);
    json["in_ports"] = ports_json(description.in_ports, description.in_port_count);
    json["out_ports"] = ports_json(description.out_ports, description.out_port_count);
    json["inputs"] = inputs_json(description);
    json["parameters"] = parameters_json(description.parameters, description.parameter_count);
    return json;
}

Json description_with_digest(const host::LoadedPlugin& plugin) {
    const Json all = description_json(plugin);
    Json json;
    for (const auto& [key, value] : all.items()) {
        json[key] = value;
        if (key == "library") json["sha256"] = plugin.sha256();
    }
    return json;
}

std::vector<Json> all_descriptions(host::Catalog& catalog, std::vector<std::string>& problems) {
    std::vector<Json> all;
    for (const host::PluginFile& file : catalog.plugins()) {
        try {
            all.push_back(description_json(catalog.load(file.id)));
        } catch (const Error& problem) {
            problems.emplace_back(problem.what());
        }
    }
    return all;
}

}  // namespace pelorus::cli
