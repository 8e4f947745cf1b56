/// What flows through an edge against what its end wants (ABI stage.h: plr_port_type).
#pragma once

#include <vector>

#include "graph/graph.hpp"
#include "graph/problems.hpp"

namespace pelorus::graph {

/// Asks both ends of every edge for their streams and compares them: sensors by name, spaces component by component, frames.
/// A mismatch is a problem that shows both sides. Answers what flows through each edge; it lives as long as the instances.
std::vector<std::vector<const plr_stream*>> check_streams(const std::vector<Node>& nodes,
                                                          const std::vector<Edge>& edges, Problems& problems);

}  // namespace pelorus::graph
