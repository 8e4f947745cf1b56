/// Edges between nodes: from `in:` to indices, checked; and the order in which nodes depend on each other.
#pragma once

#include <vector>

#include "graph/graph.hpp"
#include "graph/plan.hpp"
#include "graph/problems.hpp"

namespace pelorus::graph {

/// Reads the `in:` of all nodes: `port: node.port`, a list of such for ports that take several, `previous(node.port)` for
/// feedback. Nodes without a part are passed over. Edges come by receiving node, in the order of the file.
std::vector<Edge> read_edges(const std::vector<NodePlan>& nodes, Problems& problems);

/// Node indices such that every edge but the feedback ones goes forward, ties in file order. A cycle is a problem.
std::vector<std::size_t> order_of(const std::vector<NodePlan>& nodes, const std::vector<Edge>& edges,
                                  Problems& problems);

}  // namespace pelorus::graph
