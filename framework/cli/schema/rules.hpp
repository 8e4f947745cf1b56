/// Definitions of nodes, parts and slots, each made once.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pelorus::cli {

/// One set of rules: for whole configs, or for those that extend others.
class SchemaRules {
public:
    using Json = nlohmann::ordered_json;

    /// All three must outlive this object. Definitions are added to `definitions`.
    SchemaRules(const std::vector<Json>& plugins, bool extends, Json& definitions)
        : plugins_(plugins), extends_(extends), definitions_(definitions) {}

    /// `{"$ref": ...}` to what stands under a node's name.
    Json node();

private:
    std::string defined(const std::string& name) const { return (extends_ ? "over:" : "") + name; }
    Json reference(const std::string& name) const { return {{"$ref", "#/definitions/" + name}}; }
    Json may_go(Json schema) const;
    void require(Json& schema, const std::string& key) const;

    Json use(const std::string& name, const std::vector<const Json*>& plugins);
    Json with(const Json& plugin, const Json* slot, const std::string& slot_name);
    Json parameters_of(const Json& plugin);
    Json parts(const Json& plugin);
    Json slot(const Json& plugin, const Json& slot);
    Json part(const Json& slot, const std::string& slot_name);
    Json in(const Json& plugin);
    Json body(const Json& plugin, const Json* slot, const std::string& slot_name);
    std::vector<const Json*> of_kind(const std::string& kind) const;

    const std::vector<Json>& plugins_;
    const bool extends_;
    Json& definitions_;
};

}  // namespace pelorus::cli
