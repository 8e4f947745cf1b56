/// The page of a report or of a comparison: one HTML file that loads nothing.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/result.hpp"

namespace pelorus::report {

/// What the page is given: JSON under names.
using Blocks = std::vector<std::pair<std::string, nlohmann::ordered_json>>;

/// What a report shows of a result. `samples` has for each cell the values of its scalars in the runs, or is null.
///
/// The summary is embedded whole, but for tables of more than 2000 rows: of these every k-th row and the last one, the smallest k with
/// which at most that many remain; such a table says so in `shown_every` and `all_rows`. Throws Error: a table of the folder is damaged.
Blocks report_blocks(const Result& result, const nlohmann::ordered_json& samples);

/// The page, from its parts in `parts` (share/pelorus/report of the installation). Blocks with null are left out. Throws Error
/// (Exit::run_failed): a part is missing.
std::string html_page(const std::filesystem::path& parts, const std::string& title, const Blocks& blocks);

}  // namespace pelorus::report
