/// Lays overrides on a config: `--set`, and the values of sweeps and variants.
#pragma once

#include <vector>

#include "graph/document.hpp"
#include "graph/part_tree.hpp"
#include "graph/problems.hpp"

namespace pelorus::graph {

/// Changes `root` (a whole config) in the order of the assignments. What an address means is decided by what stands in the
/// config and by the descriptions of the plugins there; whether a parameter exists is left to the check of the config, which
/// sees it under the assignment's place. An address that leads nowhere is a problem.
void apply_overrides(Value& root, const std::vector<Assignment>& assignments, const Descriptions& descriptions,
                     Problems& problems);

}  // namespace pelorus::graph
