/// All that a plugin says of itself, as JSON: `pelorus inspect --json`, and what its text and the schema are made from.
#pragma once

#include <nlohmann/json.hpp>

#include "host/catalog.hpp"

namespace pelorus::cli {

/// Identity and description of a loaded plugin.
nlohmann::ordered_json description_json(const host::LoadedPlugin& plugin);

}  // namespace pelorus::cli
