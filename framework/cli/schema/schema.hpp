/// The JSON Schema (draft-07) of a config: what a YAML language server completes, explains and checks by.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

namespace pelorus::cli {

/// `plugins` as description_json() tells them. `use` decides what may stand in `with`, `parts` and `in` beside it, by if/then: so a
/// mistake is told as what it is, and not as a failure of all alternatives.
///
/// A file that extends another is checked by a second set of rules, in which `~` may take away anything and nothing is required.
/// Parts without `use` (those that are like others, and what lies over the parts of an extended file) may hold anything.
nlohmann::ordered_json config_schema(const std::vector<nlohmann::ordered_json>& plugins);

}  // namespace pelorus::cli
