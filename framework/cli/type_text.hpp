/// What may be given for a parameter, in words.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace pelorus::cli {

/// Of `{min, max}`: `1`, `1 to 3`, `1 or more`.
std::string range_text(const nlohmann::ordered_json& range);

/// Of a parameter as description_json() tells it: `vector of 3 [m], default [0, 0, 0], at least 0`.
std::string type_text(const nlohmann::ordered_json& parameter);

}  // namespace pelorus::cli
