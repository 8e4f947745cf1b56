/// A config as it was understood: everything filled in, SI units.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "graph/graph.hpp"
#include "graph/plan.hpp"

namespace pelorus::graph {

/// The `graph:` block. A part that was like another one stands for itself.
nlohmann::ordered_json graph_json(const std::vector<NodePlan>& nodes, const std::vector<Edge>& edges);

}  // namespace pelorus::graph
