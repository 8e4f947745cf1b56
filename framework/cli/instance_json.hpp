/// What an instance of a plugin answers when it is asked what it is.
#pragma once

#include <nlohmann/json.hpp>

#include "host/catalog.hpp"

namespace pelorus::cli {

/// Makes an instance with default parameters and no parts, and asks it: `spaces` by name, `record` (doubles), `extensions`, and
/// what else its kind tells. `{"unavailable": reason}` where it cannot be made so.
nlohmann::ordered_json instance_json(const host::LoadedPlugin& plugin);

}  // namespace pelorus::cli
