/// Values of parameters as a config would write them.
#pragma once

#include <string>
#include <vector>

#include "bench.hpp"

namespace pelorus::conformance {

/// A value, as YAML; a bare number is in the parameter's own unit. "" for a missing one.
std::string yaml_of(const plr_parameter& parameter, const plr_value& value);
/// Settings that differ from the subject's in as much as they can, as YAML maps: all parameters at once, then one at a time. A
/// plugin may refuse some of them.
std::vector<std::string> variations_of(const Bench& bench);

}  // namespace pelorus::conformance
