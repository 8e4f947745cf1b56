/// Results beside expected figures, as text.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace pelorus::report {

/// For each node a table: a line for each cell, under each scalar the value and what was expected, `*` behind a value that keeps out of
/// a band or above a limit. "" where there is nothing to be told. `beside` is what beside_expected() says.
std::string expected_table(const nlohmann::ordered_json& beside);

}  // namespace pelorus::report
