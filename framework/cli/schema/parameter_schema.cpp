#include "cli/schema/parameter_schema.hpp"

#include "cli/type_text.hpp"
#include "cli/value_json.hpp"
#include "graph/yaml.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* quantity_pattern =
    "^[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)?( *[A-Za-z%°µμ1][A-Za-z0-9%°µμ⁰¹²³⁴-⁹⁻/*·^ -]*)?$";

Json default_json(const std::string& text) { return value_json(graph::read_yaml(text, {Location("default"), {}, {}})); }

void add_bounds(Json& schema, const Json& parameter) {
    for (const auto& [from, to] : {std::pair("min", "minimum"), std::pair("above", "exclusiveMinimum"),
                                   std::pair("max", "maximum"), std::pair("below", "exclusiveMaximum")})
        if (parameter.contains(from)) schema[to] = parameter[from];
}

/// The unit of element `index` of `m, rad, rad`, or the one for all.
std::string first_unit(const Json& parameter) {
    const std::string unit = parameter["unit"];
    return unit.substr(0, unit.find(','));
}

/// A number in SI or a text with a unit. `also` is a further type that may stand there.
Json quantity(const Json& parameter, const char* also = nullptr) {
    const std::string unit = first_unit(parameter);
    const bool is_whole = parameter["type"] == "int";
    Json schema;
    if (is_whole && unit.empty() && also == nullptr) {
        schema["type"] = "integer";
    } else {
        schema["type"] = {is_whole ? "integer" : "number", "string"};
        if (also != nullptr) schema["type"].push_back(also);
        schema["pattern"] = quantity_pattern;
        schema["patternErrorMessage"] =
            unit.empty() ? "expected a pure number" : "expected a number with a unit that fits " + unit;
    }
    add_bounds(schema, parameter);
    return schema;
}

void add_length(Json& schema, const Json& range) {
    if (range["min"] != 0) schema["minItems"] = range["min"];
    if (range.contains("max")) schema["maxItems"] = range["max"];
}

Json list_of(Json items, const Json& range) {
    Json schema{{"type", "array"}, {"items", std::move(items)}};
    add_length(schema, range);
    return schema;
}

/// A list, or one value for all elements.
Json vector(const Json& parameter) {
    Json schema = quantity(parameter, "array");
    schema["items"] = quantity(parameter);
    add_length(schema, parameter["rows"]);
    return schema;
}

Json choice(const Json& parameter) {
    Json schema{{"enum", Json::array()}};
    Json docs = Json::array();
    bool has_docs = false;
    for (const Json& each : parameter["choices"]) {
        schema["enum"].push_back(each["name"]);
        docs.push_back(each["doc"]);
        has_docs = has_docs || each["doc"] != "";
    }
    if (has_docs) {
        schema["enumDescriptions"] = docs;
        schema["markdownEnumDescriptions"] = std::move(docs);
    }
    return schema;
}

Json table(const Json& parameter) {
    // A map from column to value, or a list of values in the order of the columns.
    Json row{{"type", {"object", "array"}},
             {"properties", Json::object()},
             {"additionalProperties", false},
             {"items", Json::array()},
             {"additionalItems", false}};
    for (const Json& column : parameter["columns"]) {
        row["properties"][column["name"]] = parameter_schema(column);
        row["items"].push_back(parameter_schema(column));
        if (column["required"] != true) continue;
        row["required"].push_back(column["name"]);
        row["minItems"] = row["items"].size();
    }
    return list_of(std::move(row), parameter["rows"]);
}

Json type_schema(const Json& parameter) {
    const std::string type = parameter["type"];
    if (type == "bool") return {{"type", "boolean"}};
    if (type == "int" || type == "double") return quantity(parameter);
    if (type == "choice") return choice(parameter);
    if (type == "vector") return vector(parameter);
    if (type == "matrix") return list_of(list_of(quantity(parameter), parameter["cols"]), parameter["rows"]);
    if (type == "table") return table(parameter);
    if (type == "path") return {{"type", {"string", "number"}}, {"minLength", 1}};
    return {{"type", {"string", "number", "boolean"}}};
}

}  // namespace

Json parameter_schema(const Json& parameter) {
    Json schema{{"description", parameter["doc"].get<std::string>() + "\n\n" + type_text(parameter)}};
    schema.update(type_schema(parameter));
    const bool is_given = parameter["default"].is_string();
    if (is_given) schema["default"] = default_json(parameter["default"]);
    const std::string unit = parameter["unit"];
    if (!is_given && parameter["type"] == "double" && !unit.empty()) schema["examples"] = Json::array({"1 " + unit});
    return schema;
}

}  // namespace pelorus::cli
