/// What runs add up to. Totals of blocks of runs are merged in the order of the runs, so that the sums are the same however the
/// blocks were shared out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/bytes.hpp"
#include "runtime/result.hpp"

namespace pelorus::campaign {

/// A scalar that has a value in each run. The values are kept, 8 bytes a run: medians, intervals and paired differences need them.
struct ScalarTotals {
    std::string name;  ///< `errors.track_count`
    std::string unit;
    std::uint32_t reduce = 0;  ///< PLR_REDUCE_...
    double quantile = 0;
    std::vector<double> values;   ///< [runs]; NaN: not finite, or the run has no such scalar
    std::vector<double> weights;  ///< [runs]
    std::uint64_t non_finite = 0;
};

/// A scalar that is the mean over the rows of a reduced column.
struct ColumnScalar {
    std::string name, unit;
    std::string column;  ///< of the table under whose totals it stands
    std::uint64_t non_finite = 0;
};

/// A row of a table, found in every run by its key.
struct RowTotals {
    std::vector<double> key;       ///< of the key columns; without any, the row's number
    std::uint64_t occurrence = 0;  ///< among the rows of a run with this key
    /// [columns] of a column of sums: the sum of finite elements (of their squares, for a root mean square); else the least, the
    /// greatest, or that of run 0.
    std::vector<double> values;
    std::vector<std::uint64_t> counts;        ///< [columns] finite elements
    std::vector<std::vector<double>> sorted;  ///< [quantile columns] all finite elements, ascending
};

struct TableTotals {
    std::string node, name;
    std::vector<runtime::Column> columns;
    std::vector<RowTotals> rows;
    std::vector<ColumnScalar> scalars;
    std::uint64_t non_finite = 0;
};

/// A run that failed, and its message.
struct FailedRun {
    std::uint64_t run = 0;
    std::string message;
};

/// Totals of consecutive runs of one cell.
class Totals {
public:
    /// Adds a run that went well, the one after those that are in already. Throws std::runtime_error where it has a table of
    /// other columns than the runs before.
    void add(const runtime::Results& results, std::uint64_t run);
    /// Adds a run that failed: it counts, and has no values.
    void add_failed(FailedRun failed);
    /// Adds the totals of the runs that follow. Throws like add().
    void merge(Totals later);

    std::uint64_t runs() const noexcept { return runs_; }  ///< failed ones included
    const std::vector<FailedRun>& failed() const noexcept { return failed_; }
    /// Names of all scalars, of columns or not, as they come in a run.
    const std::vector<std::string>& names() const noexcept { return names_; }
    /// Both in the order of nodes in the file, then of names.
    const std::vector<ScalarTotals>& scalars() const noexcept { return scalars_; }
    const std::vector<TableTotals>& tables() const noexcept { return tables_; }

    void write(runtime::ByteWriter& writer) const;
    /// Throws CorruptBytes.
    static Totals read(runtime::ByteReader& reader);

private:
    void merge_scalars(std::vector<ScalarTotals> later, std::uint64_t count);

    std::uint64_t runs_ = 0;
    std::vector<FailedRun> failed_;
    std::vector<std::string> names_;
    std::vector<ScalarTotals> scalars_;
    std::vector<TableTotals> tables_;
};

/// The reduced element of a row: of a column of totals, NaN where nothing finite went in.
double reduced(const runtime::Column& column, const RowTotals& row, std::size_t index, std::size_t quantile_index);

/// The quantile of ascending values by linear interpolation (Hyndman and Fan 1996, definition 7); NaN of none.
double quantile_of(const std::vector<double>& sorted, double probability) noexcept;

}  // namespace pelorus::campaign
