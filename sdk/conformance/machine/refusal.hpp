/// What a refusal must tell.
#pragma once

#include <string>

#include "creation.hpp"

namespace pelorus::conformance {

/// What is wrong with the way in which create refused the values, in words; "" if nothing.
std::string refusal_problem(const Creation& refused, const plr_description& description);

}  // namespace pelorus::conformance
