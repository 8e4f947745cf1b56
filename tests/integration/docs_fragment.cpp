#include "docs_fragment.hpp"

#include <yaml-cpp/yaml.h>

#include <sstream>
#include <stdexcept>

namespace pelorus::test {

namespace {

bool is_part(const YAML::Node& node) { return node.IsMap() && (node["use"] || node["like"]); }

YAML::Node child(const YAML::Node& map, const std::string& name, const std::string& address) {
    if (!map.IsMap() || !map[name]) throw std::runtime_error("the config has no '" + name + "' of '" + address + "'");
    return map[name];
}

/// What stands at an address: the node or part, or what is in its slots if that is where the address leads.
YAML::Node target_of(const YAML::Node& root, const std::string& address) {
    if (address == "/") return root;
    YAML::Node at = child(root, "graph", address);
    std::istringstream words(address);
    for (std::string word; std::getline(words, word, '.');) {
        if (is_part(at)) at.reset(child(at, "parts", address));
        at.reset(child(at, word, address));
    }
    if (is_part(at)) at.reset(child(at, "parts", address));
    return at;
}

}  // namespace

std::string merge_fragment(const std::string& config, const std::string& address, const std::string& fragment) {
    YAML::Node root = YAML::Load(config);
    YAML::Node target = target_of(root, address);
    for (const auto& entry : YAML::Load(fragment)) {
        const auto key = entry.first.as<std::string>();
        if (entry.second.IsNull())
            target.remove(key);
        else
            target[key] = entry.second;
    }
    std::ostringstream text;
    text << root << "\n";
    return text.str();
}

}  // namespace pelorus::test
