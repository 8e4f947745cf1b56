#include "cli/schema/rules.hpp"

#include "cli/schema/fixed_blocks.hpp"
#include "cli/schema/parameter_schema.hpp"
#include "cli/type_text.hpp"

namespace pelorus::cli {

using Json = nlohmann::ordered_json;

namespace {

Json map_schema(const char* doc) { return {{"type", "object"}, {"description", doc}}; }

std::string about(const Json& plugin) {
    return plugin["title"].get<std::string>() + ". " + plugin["purpose"].get<std::string>();
}

constexpr const char* with_doc =
    "Parameters of the plugin, and what its slot asks of the parts in it. A bare number is SI.";
constexpr const char* parts_doc = "The plugins in this one's slots, by slot.";
constexpr const char* in_doc = "Edges by in port: NODE.PORT or previous(NODE.PORT).";

}  // namespace

Json SchemaRules::may_go(Json schema) const { return extends_ ? or_nothing(std::move(schema)) : schema; }

void SchemaRules::require(Json& schema, const std::string& key) const {
    if (!extends_) schema["required"].push_back(key);
}

std::vector<const Json*> SchemaRules::of_kind(const std::string& kind) const {
    std::vector<const Json*> found;
    for (const Json& plugin : plugins_)
        if (plugin["kind"] == kind) found.push_back(&plugin);
    return found;
}

Json SchemaRules::use(const std::string& name, const std::vector<const Json*>& plugins) {
    if (!definitions_.contains(name)) {
        Json ids = Json::array(), docs = Json::array();
        for (const Json* plugin : plugins) {
            ids.push_back((*plugin)["id"]);
            docs.push_back(about(*plugin));
        }
        definitions_[name] = {{"type", "string"},
                              {"description", "The plugin's id."},
                              {"enum", ids},
                              {"enumDescriptions", docs},
                              {"markdownEnumDescriptions", docs}};
    }
    return reference(name);
}

/// The parameters alone, for all that refer to them.
Json SchemaRules::parameters_of(const Json& plugin) {
    const std::string name = "parameters:" + plugin["id"].get<std::string>();
    if (!definitions_.contains(name)) {
        Json all = Json::object();
        for (const Json& parameter : plugin["parameters"]) all[parameter["name"]] = parameter_schema(parameter);
        definitions_[name] = {{"properties", std::move(all)}};
    }
    return reference(name);
}

Json SchemaRules::with(const Json& plugin, const Json* slot, const std::string& slot_name) {
    const bool asks = slot != nullptr && !(*slot)["parameters"].empty();
    const std::string own = plugin["id"];
    const std::string name = defined("with:" + own + (asks ? ":" + slot_name : ""));
    if (definitions_.contains(name)) return reference(name);
    Json schema = map_schema(with_doc);
    schema["properties"] = Json::object();
    const std::string base = parameters_of(plugin)["$ref"];
    const auto add = [&](const Json& parameter, Json rule) {
        schema["properties"][parameter["name"]] = may_go(std::move(rule));
        if (parameter["required"] == true) require(schema, parameter["name"]);
    };
    for (const Json& parameter : plugin["parameters"])
        add(parameter, {{"$ref", base + "/properties/" + parameter["name"].get<std::string>()}});
    if (asks)
        for (const Json& parameter : (*slot)["parameters"])
            add(parameter,
                {{"$ref", "#/definitions/slot:" + slot_name + "/properties/" + parameter["name"].get<std::string>()}});
    // In a file that extends another: a parameter of the plugin that stood there before, taken away.
    schema["additionalProperties"] = extends_ ? Json{{"type", "null"}} : Json(false);
    definitions_[name] = std::move(schema);
    return reference(name);
}

Json SchemaRules::part(const Json& slot, const std::string& slot_name) {
    const std::string kind = slot["kind"];
    const bool asks = !slot["parameters"].empty();
    const std::string name = defined("part:" + (asks ? slot_name : kind));
    if (definitions_.contains(name)) return reference(name);
    definitions_[name] = nullptr;  // parts may hold parts of their own kind
    if (asks) {
        Json all = Json::object();
        for (const Json& parameter : slot["parameters"]) all[parameter["name"]] = parameter_schema(parameter);
        definitions_["slot:" + slot_name] = {{"properties", std::move(all)}};
    }
    Json schema{
        {"type", "object"},
        {"properties",
         {{"use", may_go(use("use:" + kind, of_kind(kind)))},
          {"like", may_go({{"type", "string"},
                           {"description", "Address of a part that this one is like: same plugin, same values."}})},
          {"with", may_go(map_schema(with_doc))},
          {"parts", may_go(map_schema(parts_doc))}}},
        {"additionalProperties", false}};
    if (!extends_) schema["dependencies"] = {{"like", {{"properties", {{"use", false}}}}}};
    for (const Json* plugin : of_kind(kind)) schema["allOf"].push_back(body(*plugin, &slot, slot_name));
    definitions_[name] = std::move(schema);
    return reference(name);
}

Json SchemaRules::slot(const Json& plugin, const Json& slot) {
    const std::string kind = slot["kind"], name = slot["name"];
    const Json one = part(slot, plugin["id"].get<std::string>() + "." + name);
    Json named{{"propertyNames", name_schema()}, {"additionalProperties", may_go(one)}};
    if (!extends_ && slot["parts"]["min"] > 0) named["minProperties"] = slot["parts"]["min"];
    if (slot["parts"].contains("max")) named["maxProperties"] = slot["parts"]["max"];
    Json is_unnamed = Json::array();
    for (const char* key : {"use", "like", "with", "parts"}) is_unnamed.push_back({{"required", {key}}});
    return {{"type", "object"},
            {"description", slot["doc"].get<std::string>() + "\n\nparts of kind " + kind + ": " +
                                range_text(slot["parts"]) + "; one alone may stand unnamed"},
            {"properties", {{"use", use("use:" + kind, of_kind(kind))}}},  // completed where nothing stands yet
            {"if", {{"anyOf", std::move(is_unnamed)}}},
            {"then", one},
            {"else", std::move(named)}};
}

Json SchemaRules::parts(const Json& plugin) {
    const std::string name = defined("parts:" + plugin["id"].get<std::string>());
    if (definitions_.contains(name)) return reference(name);
    definitions_[name] = nullptr;
    Json schema = map_schema(parts_doc);
    schema["properties"] = Json::object();
    for (const Json& each : plugin["slots"]) {
        schema["properties"][each["name"]] = may_go(slot(plugin, each));
        if (each["parts"]["min"] > 0) require(schema, each["name"]);
    }
    schema["additionalProperties"] = extends_ ? Json{{"type", "null"}} : Json(false);
    definitions_[name] = std::move(schema);
    return reference(name);
}

Json SchemaRules::in(const Json& plugin) {
    Json schema = map_schema(in_doc);
    schema["properties"] = Json::object();
    for (const Json& port : plugin["in_ports"]) {
        Json edge{{"type", {"string", "array"}},
                  {"pattern",
                   "^([A-Za-z_][A-Za-z0-9_]*\\.[A-Za-z0-9_]+|previous\\([A-Za-z_][A-Za-z0-9_]*\\.[A-Za-z0-9_]+\\))$"},
                  {"patternErrorMessage", "expected NODE.PORT or previous(NODE.PORT)"}};
        edge["items"] = edge;
        edge["items"]["type"] = "string";
        edge["minItems"] = 1;
        if (port["many"] == false) edge["maxItems"] = 1;
        edge["description"] = port["doc"].get<std::string>() + "\n\ncarries " + port["message"].get<std::string>() +
                              (port["many"] == true ? "; several edges may end here" : "");
        schema["properties"][port["name"]] = may_go(std::move(edge));
        if (port["optional"] == false) require(schema, port["name"]);
    }
    schema["additionalProperties"] = extends_ ? Json{{"type", "null"}} : Json(false);
    return schema;
}

/// What `use: ID` brings with it.
Json SchemaRules::body(const Json& plugin, const Json* slot, const std::string& slot_name) {
    Json then{{"description", about(plugin)},
              {"properties", {{"with", may_go(with(plugin, slot, slot_name))}, {"parts", may_go(parts(plugin))}}}};
    const auto is_wanted = [](const Json& list, const auto& wanted) {
        for (const Json& each : list)
            if (wanted(each)) return true;
        return false;
    };
    const auto required = [](const Json& parameter) { return parameter["required"] == true; };
    if (is_wanted(plugin["parameters"], required) || (slot != nullptr && is_wanted((*slot)["parameters"], required)))
        require(then, "with");
    if (is_wanted(plugin["slots"], [](const Json& each) { return each["parts"]["min"] > 0; })) require(then, "parts");
    if (slot == nullptr) {
        then["properties"]["in"] = may_go(in(plugin));
        if (is_wanted(plugin["in_ports"], [](const Json& port) { return port["optional"] == false; }))
            require(then, "in");
    }
    return {{"if", {{"properties", {{"use", {{"const", plugin["id"]}}}}}, {"required", {"use"}}}},
            {"then", std::move(then)}};
}

Json SchemaRules::node() {
    const std::string name = defined("node");
    if (definitions_.contains(name)) return reference(name);
    std::vector<const Json*> stages;
    for (const Json& plugin : plugins_)
        if (plugin["tier"] == "stage") stages.push_back(&plugin);
    Json schema{{"type", "object"},
                {"properties",
                 {{"use", may_go(use("use:node", stages))},
                  {"in", may_go(map_schema(in_doc))},
                  {"with", may_go(map_schema(with_doc))},
                  {"parts", may_go(map_schema(parts_doc))},
                  {"frame", may_go({{"type", "string"},
                                    {"description", "The frame that the node works in; the root frame if absent."}})}}},
                {"additionalProperties", false}};
    require(schema, "use");
    for (const Json* stage : stages) schema["allOf"].push_back(body(*stage, nullptr, {}));
    definitions_[name] = std::move(schema);
    return may_go(reference(name));
}

}  // namespace pelorus::cli
