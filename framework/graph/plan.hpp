/// What a graph is to be made of: every part with its plugin and its values, checked against the descriptions.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "graph/parameters.hpp"
#include "graph/plugins.hpp"
#include "graph/problems.hpp"
#include "graph/value.hpp"

namespace pelorus::graph {

/// A node, or a part in a slot, with the parts below it.
struct PartPlan {
    std::string address;     ///< `world.sensors.radar`
    std::string slot, name;  ///< within its holder; "" for a node; name "" for a part that stands unnamed
    Location where;          ///< of the part
    Location use_where;      ///< of the plugin's id
    Value with;              ///< the map; places of values for later messages
    const host::LoadedPlugin* plugin = nullptr;
    const plr_slot* place = nullptr;                      ///< the slot that it stands in
    ParameterSet values;                                  ///< of the plugin's own parameters
    ParameterSet slot_values;                             ///< of the parameters that the slot declares
    std::vector<std::unique_ptr<PartPlan>> parts;         ///< slots in the order of the description, parts of the file
    std::vector<std::pair<std::string, Location>> slots;  ///< where the slots that are filled stand

    const plr_description& description() const { return plugin->description(); }
};

struct NodePlan {
    std::string name;
    Location where;
    std::string frame;
    Location frame_where;
    Value in;  ///< the map under `in`; null: there is none
    std::unique_ptr<PartPlan> part;
};

struct PlanContext {
    Plugins& plugins;
    Problems& problems;
    std::filesystem::path base;  ///< folder of the config: for default paths
    Variables variables;
};

/// Plans the nodes of a `graph:` block in file order. What is wrong goes to context.problems; nodes whose plugin is not known
/// have no part then, and parts whose plugin is not known are left out.
std::vector<NodePlan> plan_graph(const Value& graph, const PlanContext& context);

/// Plans a part that stands by itself, in no slot and no graph. nullptr: its plugin is not known.
std::unique_ptr<PartPlan> plan_part(const Value& part, const std::string& address, const PlanContext& context);

/// The place that a plugin's error names (`noise`, `legs[2].duration`, `motion`, `sensors.radar.bias`), as exactly as the file
/// has it; the place of the part itself otherwise.
Location place_of(const PartPlan& part, const std::string& where);

}  // namespace pelorus::graph
