/// How a plugin is written into a config: made from its description, to be pasted and changed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pelorus::cli {

class ExampleMaker {
public:
    using Json = nlohmann::ordered_json;

    /// `plugins` as description_json() tells them, those that parts are taken from; must outlive this object.
    explicit ExampleMaker(const std::vector<Json>& plugins) : plugins_(plugins) {}

    /// `{use, in, with, parts}`: required parameters with some value that is allowed, slots that want parts filled with the first
    /// plugin of their kind that fits, in ports joined to the first plugin that publishes what they take, sources
    /// before all others. A model has its defaults written out.
    Json example(const Json& plugin) const;

private:
    using Chain = std::vector<std::string>;
    /// null: there is no plugin for a slot that needs one.
    Json part(const Json& plugin, const Json* slot, Chain& chain) const;
    Json fill(const Json& slot, Chain& chain) const;
    Json edges(const Json& plugin) const;
    std::string origin(const Json& plugin, const Json& in) const;

    const std::vector<Json>& plugins_;
};

/// YAML in block style: what fits into a line stands in one.
std::string block_text(const std::string& key, const nlohmann::ordered_json& value, std::size_t indent);

}  // namespace pelorus::cli
