#include "campaign/totals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <pelorus/abi/abi.h>
#include <pelorus/abi/consistency.h>

#include "campaign/in_order.hpp"
#include "report/chi_square.hpp"

namespace pelorus::campaign {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool is_sum(std::uint32_t reduce) {
    return reduce == PLR_REDUCE_MEAN || reduce == PLR_REDUCE_ROOT_MEAN_SQUARE || reduce == PLR_REDUCE_SUM ||
           reduce == PLR_REDUCE_COUNT || reduce == PLR_REDUCE_CHI_SQUARE;
}

/// The number that an element of a text column has among the texts of all runs; new texts are appended.
double number_of(double element, const runtime::Column& from, runtime::Column& to) {
    if (from.texts.empty() || !(element >= 0) || element >= static_cast<double>(from.texts.size())) return element;
    const std::string& text = from.texts[static_cast<std::size_t>(element)];
    const auto found = std::find(to.texts.begin(), to.texts.end(), text);
    if (found == to.texts.end()) to.texts.push_back(text);
    return static_cast<double>(std::find(to.texts.begin(), to.texts.end(), text) - to.texts.begin());
}

void check_same_columns(const TableTotals& table, const std::vector<runtime::Column>& columns) {
    const bool same = std::equal(table.columns.begin(), table.columns.end(), columns.begin(), columns.end(),
                                 [](const runtime::Column& a, const runtime::Column& b) {
                                     return a.name == b.name && a.unit == b.unit && a.reduce == b.reduce &&
                                            a.texts.empty() == b.texts.empty();
                                 });
    if (!same)
        throw std::runtime_error("node " + table.node + ": the table '" + table.name +
                                 "' has other columns than in the runs before");
}

RowTotals row_totals(const runtime::Table& table, std::size_t number, TableTotals& into, std::uint64_t run) {
    RowTotals row;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        const std::uint32_t reduce = into.columns[c].reduce;
        const double element = table.rows[number * table.columns.size() + c];
        const bool finite = std::isfinite(element);
        const bool is_text = !table.columns[c].texts.empty();
        if (!finite && !is_text) ++into.non_finite;
        double kept = element;
        if (reduce == PLR_REDUCE_KEY) row.key.push_back(element);
        if (reduce == PLR_REDUCE_ROOT_MEAN_SQUARE) kept = element * element;
        if (reduce == PLR_REDUCE_COUNT) kept = 1;
        if (is_sum(reduce) && !finite) kept = 0;
        if (reduce == PLR_REDUCE_FIRST_RUN && run != 0) kept = nan;
        row.values.push_back(kept);
        row.counts.push_back(finite ? 1 : 0);
        if (reduce == PLR_REDUCE_QUANTILE)
            row.sorted.push_back(finite ? std::vector<double>{element} : std::vector<double>());
    }
    if (row.key.empty()) row.key.push_back(static_cast<double>(number));
    return row;
}

std::uint64_t non_finite(const runtime::Table& table, const std::string& column) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < table.rows.size(); ++i)
        if (table.columns[i % table.columns.size()].name == column && !std::isfinite(table.rows[i])) ++count;
    return count;
}

/// One run's table. Rows with a key that came before in the same run are told apart by their number among those.
TableTotals table_totals(const runtime::Table& table, std::uint64_t run) {
    TableTotals totals;
    totals.node = table.node;
    totals.name = table.name;
    totals.columns = table.columns;
    std::map<std::vector<double>, std::uint64_t> seen;
    for (std::size_t number = 0; number < table.row_count(); ++number) {
        totals.rows.push_back(row_totals(table, number, totals, run));
        RowTotals& row = totals.rows.back();
        // NaN has no place in an order; as a key it equals itself all the same.
        for (double& part : row.key)
            if (std::isnan(part)) part = std::numeric_limits<double>::max();
        row.occurrence = seen[row.key]++;
    }
    return totals;
}

void merge_element(std::uint32_t reduce, RowTotals& row, const RowTotals& later, std::size_t c) {
    double& value = row.values[c];
    const double other = later.values[c];
    if (is_sum(reduce)) value += other;
    if (reduce == PLR_REDUCE_MIN && later.counts[c] > 0 && (row.counts[c] == 0 || other < value)) value = other;
    if (reduce == PLR_REDUCE_MAX && later.counts[c] > 0 && (row.counts[c] == 0 || other > value)) value = other;
    row.counts[c] += later.counts[c];
}

void merge_row(const std::vector<runtime::Column>& columns, RowTotals& row, RowTotals later) {
    for (std::size_t c = 0; c < columns.size(); ++c) merge_element(columns[c].reduce, row, later, c);
    for (std::size_t q = 0; q < row.sorted.size(); ++q) {
        std::vector<double>& to = row.sorted[q];
        const std::size_t middle = to.size();
        to.insert(to.end(), later.sorted[q].begin(), later.sorted[q].end());
        std::inplace_merge(to.begin(), to.begin() + static_cast<std::ptrdiff_t>(middle), to.end());
    }
}

/// Texts of `table` get the numbers that they have in `into`.
void renumber_texts(TableTotals& table, TableTotals& into) {
    std::size_t key = 0;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        const bool is_key = table.columns[c].reduce == PLR_REDUCE_KEY;
        if (!table.columns[c].texts.empty() && table.columns[c].texts != into.columns[c].texts)
            for (RowTotals& row : table.rows) {
                row.values[c] = number_of(row.values[c], table.columns[c], into.columns[c]);
                if (is_key) row.key[key] = row.values[c];
            }
        if (is_key) ++key;
    }
}

void merge_table(TableTotals& table, TableTotals later) {
    check_same_columns(table, later.columns);
    renumber_texts(later, table);
    table.non_finite += later.non_finite;
    merge_in_order(
        table.rows, std::move(later.rows), [](const RowTotals& row) { return std::tie(row.key, row.occurrence); },
        [&](RowTotals& row, RowTotals other) { merge_row(table.columns, row, std::move(other)); });
    merge_in_order(
        table.scalars, std::move(later.scalars),
        [](const ColumnScalar& scalar) -> const std::string& { return scalar.name; },
        [](ColumnScalar& scalar, const ColumnScalar& other) { scalar.non_finite += other.non_finite; });
}

}  // namespace

void Totals::add(const runtime::Results& results, std::uint64_t run) {
    Totals one;
    one.runs_ = 1;
    for (const runtime::Table& table : results.tables) {
        TableTotals totals = table_totals(table, run);
        for (const runtime::Scalar& scalar : table.scalars) {
            const std::string name = table.node + '.' + scalar.name;
            one.names_.push_back(name);
            if (!scalar.column.empty()) {
                totals.scalars.push_back({name, scalar.unit, scalar.column, non_finite(table, scalar.column)});
                continue;
            }
            const bool finite = std::isfinite(scalar.value);
            const bool is_lost = scalar.reduce == PLR_REDUCE_FIRST_RUN && run != 0;
            one.scalars_.push_back({name,
                                    scalar.unit,
                                    scalar.reduce,
                                    scalar.quantile,
                                    {finite && !is_lost ? scalar.value : nan},
                                    {scalar.weight},
                                    finite ? 0u : 1u});
        }
        one.tables_.push_back(std::move(totals));
    }
    merge(std::move(one));
}

void Totals::add_failed(FailedRun failed) {
    Totals one;
    one.runs_ = 1;
    one.failed_.push_back(std::move(failed));
    merge(std::move(one));
}

void Totals::merge_scalars(std::vector<ScalarTotals> later, std::uint64_t count) {
    for (ScalarTotals& scalar : later) {  // one that is new had no value so far
        scalar.values.insert(scalar.values.begin(), runs_, nan);
        scalar.weights.insert(scalar.weights.begin(), runs_, 1);
    }
    merge_in_order(
        scalars_, std::move(later), [](const ScalarTotals& scalar) -> const std::string& { return scalar.name; },
        [&](ScalarTotals& scalar, const ScalarTotals& other) {
            const auto from = static_cast<std::ptrdiff_t>(runs_);
            scalar.values.insert(scalar.values.end(), other.values.begin() + from, other.values.end());
            scalar.weights.insert(scalar.weights.end(), other.weights.begin() + from, other.weights.end());
            scalar.non_finite += other.non_finite;
        });
    for (ScalarTotals& scalar : scalars_) {  // one that did not come has none in these runs
        scalar.values.resize(runs_ + count, nan);
        scalar.weights.resize(runs_ + count, 1);
    }
}

void Totals::merge(Totals later) {
    merge_in_order(
        tables_, std::move(later.tables_), [](const TableTotals& table) { return std::tie(table.node, table.name); },
        [](TableTotals& table, TableTotals other) { merge_table(table, std::move(other)); });
    merge_in_order(
        names_, std::move(later.names_), [](const std::string& name) -> const std::string& { return name; },
        [](const std::string&, const std::string&) {});
    merge_scalars(std::move(later.scalars_), later.runs_);
    failed_.insert(failed_.end(), later.failed_.begin(), later.failed_.end());
    runs_ += later.runs_;
}

double quantile_of(const std::vector<double>& sorted, double probability) noexcept {
    if (sorted.empty()) return nan;
    const double place = probability * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    if (below + 1 >= sorted.size()) return sorted.back();
    return sorted[below] + (place - static_cast<double>(below)) * (sorted[below + 1] - sorted[below]);
}

double reduced(const runtime::Column& column, const RowTotals& row, std::size_t index, std::size_t quantile_index) {
    const double value = row.values[index];
    const auto count = static_cast<double>(row.counts[index]);
    switch (column.reduce) {
        case PLR_REDUCE_COUNT:
            return value;
        case PLR_REDUCE_MEAN:
            return count > 0 ? value / count : nan;
        case PLR_REDUCE_ROOT_MEAN_SQUARE:
            return count > 0 ? std::sqrt(value / count) : nan;
        case PLR_REDUCE_CHI_SQUARE:
            return report::chi_square_bound(value, column.quantile);
        case PLR_REDUCE_QUANTILE:
            return quantile_of(row.sorted[quantile_index], column.quantile);
        case PLR_REDUCE_KEY:
        case PLR_REDUCE_FIRST_RUN:
            return value;
        default:
            return count > 0 ? value : nan;
    }
}

}  // namespace pelorus::campaign
