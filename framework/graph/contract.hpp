/// What a plugin must keep to once an instance lives: its table and what its info() says.
#pragma once

#include <string>

#include <pelorus/abi/abi.h>

namespace pelorus::graph {

/// What is wrong with a space, or "": NULL, no components, names missing or doubled, units that are not SI. The priors of a
/// state space must be finite with a positive deviation; measurement components have none.
std::string space_problem(const plr_space* space, bool has_priors);

/// What is wrong with a freshly created instance, or "". Checks the table's size, every function that is not optional for what
/// the instance says of itself, and the figures in its info.
std::string instance_problem(const std::string& table_id, const plr_description& description,
                             const plr_instance& instance);

}  // namespace pelorus::graph
