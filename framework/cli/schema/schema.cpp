#include "cli/schema/schema.hpp"

#include "cli/schema/fixed_blocks.hpp"
#include "cli/schema/rules.hpp"

namespace pelorus::cli {

using Json = nlohmann::ordered_json;

namespace {

Json graph_block(Json node) {
    return {{"type", "object"},
            {"description", "Nodes by name: plugins that publish or take messages."},
            {"minProperties", 1},
            {"propertyNames", name_schema()},
            {"additionalProperties", std::move(node)}};
}

Json blocks(Json node, bool extends) {
    return {{"properties",
             {{"run", extends ? or_nothing(run_schema()) : run_schema()},
              {"frames", frames_schema(extends)},
              {"graph", graph_block(std::move(node))},
              {"campaign", campaign_schema(extends)}}}};
}

}  // namespace

Json config_schema(const std::vector<Json>& plugins) {
    Json definitions = Json::object();
    Json whole = blocks(SchemaRules(plugins, false, definitions).node(), false);
    whole["required"] = {"pelorus", "graph"};
    Json over = blocks(SchemaRules(plugins, true, definitions).node(), true);
    return {{"$schema", "http://json-schema.org/draft-07/schema#"},
            {"title", "Pelorus config"},
            {"description", "Which plugins a pipeline is made of, their values, and the edges between them."},
            {"type", "object"},
            {"properties",
             {{"pelorus", {{"const", 1}, {"description", "The version of the config language."}}},
              {"title",
               {{"type", {"string", "number", "boolean", "null"}},
                {"description", "A text: the first line of the printed results."}}},
              {"extend",
               {{"type", "string"},
                {"description",
                 "A config that this one builds on; its path is relative to this file. `~` removes what it has."}}},
              {"run", true},
              {"frames", true},
              {"graph", true},
              {"campaign", true}}},
            {"patternProperties", {{"^x-", true}}},
            {"additionalProperties", false},
            {"if", {{"required", {"extend"}}}},
            {"then", std::move(over)},
            {"else", std::move(whole)},
            {"definitions", std::move(definitions)}};
}

}  // namespace pelorus::cli
