/// What a JSON Schema says of one parameter.
#pragma once

#include <nlohmann/json.hpp>

namespace pelorus::cli {

/// From a parameter as description_json() tells it. YAML has no units: `5 km` arrives as a string, `5` as a number, which is SI;
/// the bounds are checked of numbers only.
nlohmann::ordered_json parameter_schema(const nlohmann::ordered_json& parameter);

}  // namespace pelorus::cli
