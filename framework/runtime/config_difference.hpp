/// Where two runs differ that should be the same.
#pragma once

#include <string>

namespace pelorus::runtime {

/// The first difference between two Wiring::parameters, by its address and with both values: `world.period is 2 there, 1
/// here`. "" if there is none, or if one of them is not readable.
std::string first_difference(const std::string& there, const std::string& here);

}  // namespace pelorus::runtime
