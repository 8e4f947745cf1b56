/// A value of a config as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "graph/value.hpp"

namespace pelorus::cli {

/// Scalars that are not quoted and look like a JSON number, `true` or `false` become these; all others are texts.
nlohmann::ordered_json value_json(const graph::Value& value);

/// YAML on one line, in flow style, that reads back as this value.
std::string flow_text(const nlohmann::ordered_json& value);

}  // namespace pelorus::cli
