/// The figures of a campaign as text.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace pelorus::report {

/// For each scalar a table: a line for each variant, a column for each grid point, under the values of the sweep. What has no
/// finite value is `-`. `summary` is the document of summary.json.
std::string campaign_table(const nlohmann::ordered_json& summary);

}  // namespace pelorus::report
