#include "report/summary.hpp"

#include <cmath>
#include <limits>

#include <pelorus/abi/abi.h>
#include <pelorus/abi/consistency.h>

#include "report/chi_square.hpp"

namespace pelorus::report {
namespace {

using Json = nlohmann::ordered_json;

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

TableResult table_of(const runtime::Table& table) {
    TableResult result{table.node + '.' + table.name, table.columns, table.rows, 0};
    const std::size_t width = table.columns.size();
    for (std::size_t i = 0; i < result.rows.size(); ++i) {
        const runtime::Column& column = table.columns[i % width];
        if (!column.texts.empty()) continue;
        if (!std::isfinite(result.rows[i])) ++result.non_finite;
        result.rows[i] = reduce_one(result.rows[i], column.reduce, column.quantile);
    }
    return result;
}

/// Mean of a reduced column over its rows.
ScalarResult mean_of_column(const runtime::Table& table, const runtime::Scalar& scalar) {
    ScalarResult result{table.node + '.' + scalar.name, scalar.unit, std::numeric_limits<double>::quiet_NaN(), {}, 0};
    const std::size_t width = table.columns.size();
    for (std::size_t col = 0; col < width; ++col) {
        if (table.columns[col].name != scalar.column) continue;
        double sum = 0;
        std::uint64_t count = 0;
        for (std::size_t i = col; i < table.rows.size(); i += width) {
            if (!std::isfinite(table.rows[i])) ++result.non_finite;
            const runtime::Column& column = table.columns[col];
            const double reduced = reduce_one(table.rows[i], column.reduce, column.quantile);
            if (!std::isfinite(reduced)) continue;
            sum += reduced;
            ++count;
        }
        if (count > 0) result.value = sum / static_cast<double>(count);
    }
    return result;
}

ScalarResult scalar_of(const runtime::Table& table, const runtime::Scalar& scalar) {
    if (!scalar.column.empty()) return mean_of_column(table, scalar);
    const std::uint64_t non_finite = std::isfinite(scalar.value) ? 0 : 1;
    const double value = reduce_one(scalar.value, scalar.reduce, scalar.quantile);
    return {table.node + '.' + scalar.name, scalar.unit, value, {}, non_finite};
}

Json scalar_json(const ScalarResult& scalar) {
    Json json{{"value", number(scalar.value)}, {"unit", scalar.unit}};
    json["ci95"] = scalar.ci95 ? number(*scalar.ci95) : Json(nullptr);
    if (scalar.non_finite > 0) json["non_finite"] = scalar.non_finite;
    return json;
}

Json element_json(const runtime::Column& column, double x) {
    if (!column.texts.empty() && x >= 0 && x < static_cast<double>(column.texts.size()))
        return column.texts[static_cast<std::size_t>(x)];
    return number(x);
}

Json table_json(const TableResult& table) {
    Json json{{"columns", Json::array()}, {"rows", Json::array()}};
    for (const runtime::Column& column : table.columns)
        json["columns"].push_back({{"name", column.name}, {"unit", column.unit}});
    const std::size_t width = table.columns.size();
    for (std::size_t row = 0; row < table.row_count(); ++row) {
        Json elements = Json::array();
        for (std::size_t col = 0; col < width; ++col)
            elements.push_back(element_json(table.columns[col], table.rows[row * width + col]));
        json["rows"].push_back(std::move(elements));
    }
    if (table.non_finite > 0) json["non_finite"] = table.non_finite;
    return json;
}

}  // namespace

double reduce_one(double value, std::uint32_t reduce, double quantile) {
    switch (reduce) {
        case PLR_REDUCE_ROOT_MEAN_SQUARE:
            return std::fabs(value);
        case PLR_REDUCE_COUNT:
            return std::isfinite(value) ? 1 : 0;
        case PLR_REDUCE_CHI_SQUARE:
            return chi_square_bound(value, quantile);
        default:
            return value;
    }
}

Cell cell_of_run(const runtime::Results& results) {
    Cell cell;
    for (const runtime::Table& table : results.tables) {
        for (const runtime::Scalar& scalar : table.scalars) cell.scalars.push_back(scalar_of(table, scalar));
        // The columns of a table without a name only serve its scalars.
        if (!table.name.empty()) cell.tables.push_back(table_of(table));
    }
    return cell;
}

Json cell_json(const Cell& cell) {
    Json json{{"variant", cell.variant}, {"sweep", cell.sweep}, {"runs", cell.runs}};
    if (!cell.failed_runs.empty()) {
        json["failed"] = cell.failed_runs.size();
        json["failed_runs"] = cell.failed_runs;
        json["failure"] = cell.failure;
    }
    json["scalars"] = Json::object();
    json["tables"] = Json::object();
    for (const ScalarResult& scalar : cell.scalars) json["scalars"][scalar.name] = scalar_json(scalar);
    for (const TableResult& table : cell.tables) json["tables"][table.name] = table_json(table);
    return json;
}

Json summary(const std::vector<Cell>& cells) {
    Json document{{"cells", Json::array()}};
    for (const Cell& cell : cells) document["cells"].push_back(cell_json(cell));
    return document;
}

}  // namespace pelorus::report
