/// A cell that is done: its entry of summary.json, and what is needed to compare it with others.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "campaign/cell_totals.hpp"
#include "report/summary.hpp"

namespace pelorus::campaign {

/// What all runs reduce to, with intervals. `cell` brings the variant and the sweep.
///
/// An RMSE, and any other scalar that is the mean over the rows of a reduced column, has its interval from a jackknife over groups of
/// runs; one that has a value in each run from these values.
///
/// The answer has `cell` and `samples`: of each scalar its `reduce`, and `values` of the runs (`weights`, if any is not 1), or what it
/// is `without` each group, with the groups' `counts` of runs. What is not finite is null.
nlohmann::ordered_json finished_cell(const CellTotals& totals, report::Cell cell);

/// How the scalars of a cell differ from those of a reference cell with the same runs, both as finished_cell() made them:
/// `{NAME: {difference, unit, ci95}}`, for what both have. Runs are paired: they share their random numbers.
nlohmann::ordered_json paired_differences(const nlohmann::ordered_json& cell, const nlohmann::ordered_json& reference);

}  // namespace pelorus::campaign
