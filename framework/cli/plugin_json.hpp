/// All that a plugin says of itself, as JSON: `pelorus inspect --json`, and what its text is made from.
#pragma once

#include <nlohmann/json.hpp>

#include "host/catalog.hpp"

namespace pelorus::cli {

/// Identity and description of a loaded plugin. Models: under `instance` what an instance with default parameters answers (spaces,
/// record, extensions), or `{"unavailable": reason}` for one that cannot be made without parts or required parameters.
nlohmann::ordered_json plugin_json(const host::LoadedPlugin& plugin);

}  // namespace pelorus::cli
