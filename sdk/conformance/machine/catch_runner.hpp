/// Catch2, kept in one unit because it takes long to compile.
#pragma once

#include <string>

namespace pelorus::conformance {

/// Runs the case of that name; every assertion that fails is told in one text, the enclosing INFOs first.
void run_catch(const std::string& test_case, void (*failed)(const std::string& text));

}  // namespace pelorus::conformance
