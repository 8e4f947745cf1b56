/// summary.json: the results of a config, one cell for each variant and grid point.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "runtime/result.hpp"

namespace pelorus::report {

/// A scalar over all runs of a cell. Non-finite values were left out and counted; a value of which nothing is left is
/// NaN.
struct ScalarResult {
    std::string name;  ///< `errors.position_rmse`
    std::string unit;
    double value = 0;
    std::optional<double> ci95;  ///< half width of the 95 % confidence interval; none at one run
    std::uint64_t non_finite = 0;
};

/// A table over all runs of a cell.
struct TableResult {
    std::string name;  ///< `errors.by_time`
    std::vector<runtime::Column> columns;
    std::vector<double> rows;  ///< row by row; an element of a text column counts into its texts
    std::uint64_t non_finite = 0;
    std::size_t row_count() const { return columns.empty() ? 0 : rows.size() / columns.size(); }
};

struct Cell {
    std::string variant = "default";
    nlohmann::ordered_json sweep = nlohmann::ordered_json::object();  ///< address -> value
    std::uint64_t runs = 1;
    std::vector<std::uint64_t> failed_runs;  ///< their numbers; they count among `runs` and have no values
    std::string failure;                     ///< what the first of them said
    std::vector<ScalarResult> scalars;
    std::vector<TableResult> tables;
};

/// What a value is after reduction (PLR_REDUCE_...) over this one run: a root mean square is its magnitude, a count is
/// 1 if it is finite and else 0, degrees of freedom become a bound at `quantile`, all others are the value itself.
double reduce_one(double value, std::uint32_t reduce, double quantile = 0);

/// The cell of a single run. A scalar of a column is the mean of that column's reduced finite elements.
Cell cell_of_run(const runtime::Results& results);

/// One entry of `cells`. Non-finite numbers become null; where there are any, `non_finite` says how many.
nlohmann::ordered_json cell_json(const Cell& cell);

/// The document.
nlohmann::ordered_json summary(const std::vector<Cell>& cells);

}  // namespace pelorus::report
