/// What an instance of a plugin answers when it is asked what it is.
#pragma once

#include <nlohmann/json.hpp>

#include "graph/graph.hpp"

namespace pelorus::cli {

/// Makes an instance of a model from `part` (`{use, with, parts}`, as a config has it), and asks it: `spaces` by name, `record`
/// (doubles), `extensions`, and what else its kind tells. `{"unavailable": reason}` where it cannot be made so.
nlohmann::ordered_json instance_json(const nlohmann::ordered_json& part, const graph::PluginFinder& finder);

}  // namespace pelorus::cli
