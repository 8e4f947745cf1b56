/// The blocks of a config that do not depend on plugins, as JSON Schema.
#pragma once

#include <nlohmann/json.hpp>

namespace pelorus::cli {

/// Schema of the keys that name a node, part or frame.
nlohmann::ordered_json name_schema();

/// In a file that extends another, `~` takes away what is there: whatever fits `schema`, or nothing.
nlohmann::ordered_json or_nothing(nlohmann::ordered_json schema);

nlohmann::ordered_json run_schema();
nlohmann::ordered_json frames_schema(bool extends);
nlohmann::ordered_json campaign_schema(bool extends);

}  // namespace pelorus::cli
