/// What a refusal must tell.
#pragma once

#include <string>

#include "creation.hpp"

namespace pelorus::conformance {

/// What is wrong with the way in which create refused the values, in words; "" if nothing. Values that a host would refuse by the
/// description (`are_described` false) may also have made it fail.
std::string refusal_problem(const Creation& refused, const plr_description& description, bool are_described);

}  // namespace pelorus::conformance
