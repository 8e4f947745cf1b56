/// Which settings of a plugin are tried when nobody names any.
#pragma once

#include <vector>

#include "bench.hpp"

namespace pelorus::conformance {

/// The defaults, and each other choice of each parameter of type choice, and each other value of an int parameter with few values,
/// one at a time; those that the plugin refuses by themselves are left out.
std::vector<Subject> subjects_of(const Task& task);

}  // namespace pelorus::conformance
