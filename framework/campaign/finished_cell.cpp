#include "campaign/finished_cell.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <pelorus/abi/abi.h>

#include "campaign/statistics.hpp"

namespace pelorus::campaign {

namespace {

using Json = nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json numbers(const std::vector<double>& from) {
    Json list = Json::array();
    for (const double x : from) list.push_back(number(x));
    return list;
}

std::vector<double> numbers_of(const Json& list) {
    std::vector<double> numbers;
    for (const Json& each : list) numbers.push_back(each.is_number() ? each.get<double>() : nan);
    return numbers;
}

Totals all_of(const CellTotals& totals) {
    Totals all;
    for (const Totals& group : totals.groups()) all.merge(group);
    return all;
}

report::TableResult table_result(const TableTotals& table) {
    report::TableResult result{table.node + '.' + table.name, table.columns, {}, table.non_finite};
    for (const RowTotals& row : table.rows) {
        std::size_t quantiles = 0;
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
            result.rows.push_back(reduced(table.columns[c], row, c, quantiles));
            if (table.columns[c].reduce == PLR_REDUCE_QUANTILE) ++quantiles;
        }
    }
    return result;
}

/// A column by groups of runs, rows as all runs have them together.
struct GroupedColumn {
    runtime::Column column;
    std::vector<double> whole;                       // [rows] reduced over all runs
    std::vector<std::vector<double>> sums;           // [groups][rows]
    std::vector<std::vector<std::uint64_t>> counts;  // [groups][rows]
    bool is_comparable = true;                       // rows of the groups have the keys of those of all runs
};

const TableTotals* table_in(const Totals& totals, const TableTotals& like) {
    for (const TableTotals& table : totals.tables())
        if (table.node == like.node && table.name == like.name) return &table;
    return nullptr;
}

bool is_same_row(const RowTotals& a, const RowTotals& b) { return a.occurrence == b.occurrence && a.key == b.key; }

GroupedColumn grouped(const CellTotals& totals, const TableTotals& whole, std::size_t c) {
    GroupedColumn result;
    result.column = whole.columns[c];
    const auto quantile = static_cast<std::size_t>(
        std::count_if(whole.columns.begin(), whole.columns.begin() + static_cast<std::ptrdiff_t>(c),
                      [](const auto& column) { return column.reduce == PLR_REDUCE_QUANTILE; }));
    for (const RowTotals& row : whole.rows) result.whole.push_back(reduced(whole.columns[c], row, c, quantile));
    for (const Totals& group : totals.groups()) {
        std::vector<double> sums(whole.rows.size(), 0);
        std::vector<std::uint64_t> counts(whole.rows.size(), 0);
        const TableTotals* table = table_in(group, whole);
        // Numbers of texts are those of the group.
        for (std::size_t k = 0; table != nullptr && k < whole.columns.size(); ++k)
            if (table->columns[k].texts != whole.columns[k].texts && whole.columns[k].reduce == PLR_REDUCE_KEY)
                result.is_comparable = false;
        std::size_t at = 0;
        for (std::size_t i = 0; result.is_comparable && table != nullptr && i < table->rows.size(); ++i) {
            const RowTotals& row = table->rows[i];
            if (at >= whole.rows.size() || !is_same_row(whole.rows[at], row))
                at = static_cast<std::size_t>(
                    std::find_if(whole.rows.begin(), whole.rows.end(),
                                 [&](const RowTotals& other) { return is_same_row(other, row); }) -
                    whole.rows.begin());
            if (at >= whole.rows.size()) throw std::logic_error("a group of runs has a row that all of them have not");
            sums[at] = row.values[c];
            counts[at] = row.counts[c];
            ++at;
        }
        result.sums.push_back(std::move(sums));
        result.counts.push_back(std::move(counts));
    }
    return result;
}

double mean_over_rows(const std::vector<double>& rows) {
    double sum = 0;
    std::size_t count = 0;
    for (const double x : rows)
        if (std::isfinite(x)) sum += x, ++count;
    return count > 0 ? sum / static_cast<double>(count) : nan;
}

/// The column's mean over rows from the runs that stand in `sums` and `counts`, a `share` of all.
double mean_of_column(const GroupedColumn& column, const std::vector<double>& sums,
                      const std::vector<std::uint64_t>& counts, double share) {
    std::vector<double> rows;
    for (std::size_t r = 0; r < sums.size(); ++r) {
        RowTotals row;
        row.values = {sums[r]};
        row.counts = {counts[r]};
        double value = reduced(column.column, row, 0, 0);
        if (column.column.reduce == PLR_REDUCE_SUM || column.column.reduce == PLR_REDUCE_COUNT) value /= share;
        rows.push_back(value);
    }
    return mean_over_rows(rows);
}

bool has_jackknife(std::uint32_t reduce) {
    return reduce == PLR_REDUCE_MEAN || reduce == PLR_REDUCE_ROOT_MEAN_SQUARE || reduce == PLR_REDUCE_SUM ||
           reduce == PLR_REDUCE_COUNT;
}

std::uint64_t good_runs(const Totals& totals) { return totals.runs() - totals.failed().size(); }

/// Leaves out each group in turn. Sums of what is before and behind a group are added, so that nothing is subtracted.
Jackknife jackknife_of(const CellTotals& totals, const GroupedColumn& column) {
    Jackknife jackknife;
    const std::size_t groups = totals.groups().size(), rows = column.whole.size();
    std::uint64_t all = 0;
    for (const Totals& group : totals.groups()) {
        jackknife.counts.push_back(good_runs(group));
        all += jackknife.counts.back();
    }
    std::vector<std::vector<double>> behind(groups + 1, std::vector<double>(rows, 0));
    std::vector<std::vector<std::uint64_t>> counts_behind(groups + 1, std::vector<std::uint64_t>(rows, 0));
    for (std::size_t g = groups; g-- > 0;)
        for (std::size_t r = 0; r < rows; ++r) {
            behind[g][r] = behind[g + 1][r] + column.sums[g][r];
            counts_behind[g][r] = counts_behind[g + 1][r] + column.counts[g][r];
        }
    std::vector<double> before(rows, 0), sums(rows, 0);
    std::vector<std::uint64_t> counts_before(rows, 0), counts(rows, 0);
    for (std::size_t g = 0; g < groups; ++g) {
        for (std::size_t r = 0; r < rows; ++r) {
            sums[r] = before[r] + behind[g + 1][r];
            counts[r] = counts_before[r] + counts_behind[g + 1][r];
            before[r] += column.sums[g][r];
            counts_before[r] += column.counts[g][r];
        }
        const double share =
            static_cast<double>(all - jackknife.counts[g]) / static_cast<double>(std::max<std::uint64_t>(all, 1));
        jackknife.without.push_back(mean_of_column(column, sums, counts, share));
    }
    return jackknife;
}

/// A cell under construction: its entry and the samples behind it.
struct Result {
    report::Cell cell;
    Json samples = Json::object();
};

void add_scalar(const ScalarTotals& scalar, Result& result) {
    const Estimate estimate = estimate_of(scalar.reduce, scalar.quantile, scalar.values, scalar.weights);
    report::ScalarResult told{scalar.name, scalar.unit, estimate.value, {}, scalar.non_finite};
    if (scalar.reduce == PLR_REDUCE_QUANTILE) {
        std::vector<double> sorted;
        std::copy_if(scalar.values.begin(), scalar.values.end(), std::back_inserter(sorted),
                     [](double x) { return std::isfinite(x); });
        std::sort(sorted.begin(), sorted.end());
        told.ci95 = quantile_ci95(sorted, scalar.quantile);
    } else {
        told.ci95 =
            ci95_of(estimate.contributions, scalar.reduce == PLR_REDUCE_COUNT ? scalar.values.size() : estimate.finite);
    }
    result.cell.scalars.push_back(std::move(told));
    Json& sample = result.samples[scalar.name];
    sample = {{"reduce", scalar.reduce}, {"quantile", scalar.quantile}, {"values", numbers(scalar.values)}};
    const auto is_one = [](double weight) { return weight >= 1 && weight <= 1; };
    if (!std::all_of(scalar.weights.begin(), scalar.weights.end(), is_one)) sample["weights"] = numbers(scalar.weights);
}

void add_scalar(const CellTotals& totals, const TableTotals& table, const ColumnScalar& scalar, Result& result) {
    report::ScalarResult told{scalar.name, scalar.unit, nan, {}, scalar.non_finite};
    const auto column = std::find_if(table.columns.begin(), table.columns.end(),
                                     [&](const auto& candidate) { return candidate.name == scalar.column; });
    if (column != table.columns.end()) {
        const GroupedColumn grouping = grouped(totals, table, static_cast<std::size_t>(column - table.columns.begin()));
        told.value = mean_over_rows(grouping.whole);
        if (has_jackknife(column->reduce) && grouping.is_comparable) {
            const Jackknife jackknife = jackknife_of(totals, grouping);
            told.ci95 = jackknife_ci95(told.value, jackknife);
            result.samples[scalar.name] = {
                {"reduce", column->reduce}, {"without", numbers(jackknife.without)}, {"counts", jackknife.counts}};
        }
    }
    result.cell.scalars.push_back(std::move(told));
}

void add_named(const CellTotals& totals, const Totals& all, const std::string& name, Result& result) {
    for (const ScalarTotals& scalar : all.scalars())
        if (scalar.name == name) return add_scalar(scalar, result);
    for (const TableTotals& table : all.tables())
        for (const ColumnScalar& scalar : table.scalars)
            if (scalar.name == name) return add_scalar(totals, table, scalar, result);
}

std::vector<double> weights_of(const Json& sample, std::size_t count) {
    const auto found = sample.find("weights");
    return found == sample.end() ? std::vector<double>(count, 1) : numbers_of(*found);
}

/// The difference of two scalars that have a value in each run.
std::optional<double> ci95_of_values(const Json& mine, const Json& theirs) {
    const std::vector<double> values = numbers_of(mine.at("values")), others = numbers_of(theirs.at("values"));
    if (values.size() != others.size()) return std::nullopt;
    const auto estimate = [](const Json& sample, const std::vector<double>& of) {
        return estimate_of(sample.at("reduce").get<std::uint32_t>(), sample.at("quantile").get<double>(), of,
                           weights_of(sample, of.size()));
    };
    Estimate left = estimate(mine, values);
    const Estimate right = estimate(theirs, others);
    if (left.contributions.size() != right.contributions.size()) return std::nullopt;
    std::size_t runs = 0;
    for (std::size_t r = 0; r < left.contributions.size(); ++r) {
        left.contributions[r] -= right.contributions[r];
        if (std::isfinite(values[r]) || std::isfinite(others[r])) ++runs;
    }
    return ci95_of(left.contributions, runs);
}

/// The difference of two means over the rows of a column.
std::optional<double> ci95_of_columns(double difference, const Json& mine, const Json& theirs) {
    Jackknife jackknife{numbers_of(mine.at("without")), mine.at("counts").get<std::vector<std::uint64_t>>()};
    const std::vector<double> others = numbers_of(theirs.at("without"));
    if (others.size() != jackknife.without.size()) return std::nullopt;
    for (std::size_t g = 0; g < others.size(); ++g) jackknife.without[g] -= others[g];
    return jackknife_ci95(difference, jackknife);
}

}  // namespace

Json finished_cell(const CellTotals& totals, report::Cell cell) {
    const Totals all = all_of(totals);
    Result result;
    result.cell = std::move(cell);
    result.cell.runs = all.runs();
    for (const FailedRun& failed : all.failed()) result.cell.failed_runs.push_back(failed.run);
    if (!all.failed().empty()) result.cell.failure = all.failed().front().message;
    for (const std::string& name : all.names()) add_named(totals, all, name, result);
    for (const TableTotals& table : all.tables())
        // The columns of a table without a name only serve its scalars.
        if (!table.name.empty()) result.cell.tables.push_back(table_result(table));
    return {{"cell", report::cell_json(result.cell)}, {"samples", std::move(result.samples)}};
}

Json paired_differences(const Json& cell, const Json& reference) {
    Json differences = Json::object();
    const Json& others = reference.at("cell").at("scalars");
    for (const auto& [name, scalar] : cell.at("cell").at("scalars").items()) {
        const auto other = others.find(name);
        if (other == others.end() || other->at("unit") != scalar.at("unit")) continue;
        Json& told = differences[name];
        told = {{"difference", nullptr}, {"unit", scalar.at("unit")}, {"ci95", nullptr}};
        if (!scalar.at("value").is_number() || !other->at("value").is_number()) continue;
        const double difference = scalar.at("value").get<double>() - other->at("value").get<double>();
        told["difference"] = difference;
        const auto mine = cell.at("samples").find(name), theirs = reference.at("samples").find(name);
        if (mine == cell.at("samples").end() || theirs == reference.at("samples").end()) continue;
        std::optional<double> ci95;
        if (mine->contains("values") && theirs->contains("values")) ci95 = ci95_of_values(*mine, *theirs);
        if (mine->contains("without") && theirs->contains("without"))
            ci95 = ci95_of_columns(difference, *mine, *theirs);
        if (ci95 && std::isfinite(*ci95)) told["ci95"] = *ci95;
    }
    return differences;
}

}  // namespace pelorus::campaign
