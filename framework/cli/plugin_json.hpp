/// All that a plugin says of itself, as JSON: `pelorus inspect --json`, and what its text and the schema are made from.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/catalog.hpp"

namespace pelorus::cli {

/// Identity and description of a loaded plugin, but for the digest of its library: to read that takes longer than all the rest, and
/// most often it is of no interest.
nlohmann::ordered_json description_json(const host::LoadedPlugin& plugin);
/// With the digest, `sha256`.
nlohmann::ordered_json description_with_digest(const host::LoadedPlugin& plugin);

/// Descriptions of all plugins of the catalog, by id. What cannot be loaded is left out; its errors are appended to `problems`.
std::vector<nlohmann::ordered_json> all_descriptions(host::Catalog& catalog, std::vector<std::string>& problems);

}  // namespace pelorus::cli
