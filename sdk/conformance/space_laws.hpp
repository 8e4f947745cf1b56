/// What a space of any model must look like.
#pragma once

#include <string>
#include <vector>

#include <pelorus/abi/space.h>

namespace pelorus::conformance {

enum class Priors { positive, zero, free };

/// What is wrong with a space, a line each: names, units, order, angles, priors.
std::vector<std::string> faults_of(const plr_space* space, const std::string& what, Priors priors);

/// How many leading components are positions on the axes x, y, z.
int leading_positions(const plr_space& space);

}  // namespace pelorus::conformance
