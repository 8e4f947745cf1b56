/// All that a plugin says of itself, as JSON: `pelorus inspect --json`, and what its text and the schema are made from.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/catalog.hpp"

namespace pelorus::cli {

/// Identity and description of a loaded plugin.
nlohmann::ordered_json description_json(const host::LoadedPlugin& plugin);

/// Of all plugins of the catalog, by id. What cannot be loaded is left out; its errors are appended to `problems`.
std::vector<nlohmann::ordered_json> all_descriptions(host::Catalog& catalog, std::vector<std::string>& problems);

}  // namespace pelorus::cli
