/// A plugin laid out for people.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace pelorus::cli {

/// From what `pelorus inspect ID --json` prints.
std::string plugin_text(const nlohmann::ordered_json& plugin);

}  // namespace pelorus::cli
