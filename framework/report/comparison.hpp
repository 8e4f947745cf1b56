/// Two results side by side.
#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "report/result.hpp"

namespace pelorus::report {

/// Differences of the scalars of B's cell to A's, run by run: `{NAME: {difference, ci95}}`, or null where the runs are not kept.
using PairedCells = std::function<nlohmann::ordered_json(std::size_t cell_a, std::size_t cell_b)>;

/// All scalars in common, and what is not:
///
///     {a, b, paired, cells: [{variant_a, variant_b, sweep, scalars: {NAME: {unit, a, b, difference, ci95}}}], only_a: [..], only_b: [..]}
///
/// Cells belong together that have the same variant and sweep; where each result has one variant alone, these are compared whatever
/// their names. `difference` is B - A. Where the runs have the same random numbers and `paired` tells of them, its interval is that of paired
/// runs, else that of independent ones (the root of the sum of squares); null where one side has none.
nlohmann::ordered_json compare(const Result& a, const Result& b, const PairedCells& paired);

/// A table for each cell, `*` behind a difference that is larger than its interval; then what is not in common.
std::string comparison_table(const nlohmann::ordered_json& comparison);

}  // namespace pelorus::report
