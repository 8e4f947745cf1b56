// Totals as bytes: how they are kept on disk and sent between processes.
#include <utility>

#include "campaign/totals.hpp"

namespace pelorus::campaign {

namespace {

using runtime::ByteReader;
using runtime::ByteWriter;

void write_numbers(ByteWriter& writer, const std::vector<double>& numbers) {
    writer.sized(numbers.data(), numbers.size() * sizeof(double));
}

template <class Number> std::vector<Number> read_numbers(ByteReader& reader) {
    const std::size_t bytes = reader.count(1);
    if (bytes % sizeof(Number) != 0) throw runtime::CorruptBytes("a list ends within a number");
    std::vector<Number> numbers(bytes / sizeof(Number));
    reader.block(numbers.data(), bytes);
    return numbers;
}

void write_row(ByteWriter& writer, const RowTotals& row) {
    write_numbers(writer, row.key);
    writer.number(row.occurrence);
    write_numbers(writer, row.values);
    writer.sized(row.counts.data(), row.counts.size() * sizeof(std::uint64_t));
    writer.number(std::uint64_t{row.sorted.size()});
    for (const std::vector<double>& values : row.sorted) write_numbers(writer, values);
}

RowTotals read_row(ByteReader& reader, std::size_t columns) {
    RowTotals row;
    row.key = read_numbers<double>(reader);
    row.occurrence = reader.number<std::uint64_t>();
    row.values = read_numbers<double>(reader);
    row.counts = read_numbers<std::uint64_t>(reader);
    if (row.values.size() != columns || row.counts.size() != columns)
        throw runtime::CorruptBytes("a row has not the columns of its table");
    row.sorted.resize(reader.count(8));
    for (std::vector<double>& values : row.sorted) values = read_numbers<double>(reader);
    return row;
}

void write_table(ByteWriter& writer, const TableTotals& table) {
    writer.text(table.node);
    writer.text(table.name);
    writer.number(table.non_finite);
    runtime::write_columns(writer, table.columns);
    writer.number(std::uint64_t{table.scalars.size()});
    for (const ColumnScalar& scalar : table.scalars) {
        writer.text(scalar.name);
        writer.text(scalar.unit);
        writer.text(scalar.column);
        writer.number(scalar.non_finite);
    }
    writer.number(std::uint64_t{table.rows.size()});
    for (const RowTotals& row : table.rows) write_row(writer, row);
}

TableTotals read_table(ByteReader& reader) {
    TableTotals table;
    table.node = reader.text();
    table.name = reader.text();
    table.non_finite = reader.number<std::uint64_t>();
    table.columns = runtime::read_columns(reader);
    table.scalars.resize(reader.count(32));
    for (ColumnScalar& scalar : table.scalars) {
        scalar.name = reader.text();
        scalar.unit = reader.text();
        scalar.column = reader.text();
        scalar.non_finite = reader.number<std::uint64_t>();
    }
    table.rows.resize(reader.count(40));
    for (RowTotals& row : table.rows) row = read_row(reader, table.columns.size());
    return table;
}

void write_scalar(ByteWriter& writer, const ScalarTotals& scalar) {
    writer.text(scalar.name);
    writer.text(scalar.unit);
    writer.number(scalar.reduce);
    writer.number(scalar.quantile);
    write_numbers(writer, scalar.values);
    write_numbers(writer, scalar.weights);
    writer.number(scalar.non_finite);
}

ScalarTotals read_scalar(ByteReader& reader, std::uint64_t runs) {
    ScalarTotals scalar;
    scalar.name = reader.text();
    scalar.unit = reader.text();
    scalar.reduce = reader.number<std::uint32_t>();
    scalar.quantile = reader.number<double>();
    scalar.values = read_numbers<double>(reader);
    scalar.weights = read_numbers<double>(reader);
    scalar.non_finite = reader.number<std::uint64_t>();
    if (scalar.values.size() != runs || scalar.weights.size() != runs)
        throw runtime::CorruptBytes("a scalar has not a value for each run");
    return scalar;
}

}  // namespace

void Totals::write(ByteWriter& writer) const {
    writer.number(runs_);
    writer.number(std::uint64_t{failed_.size()});
    for (const FailedRun& failed : failed_) {
        writer.number(failed.run);
        writer.text(failed.message);
    }
    writer.number(std::uint64_t{names_.size()});
    for (const std::string& name : names_) writer.text(name);
    writer.number(std::uint64_t{scalars_.size()});
    for (const ScalarTotals& scalar : scalars_) write_scalar(writer, scalar);
    writer.number(std::uint64_t{tables_.size()});
    for (const TableTotals& table : tables_) write_table(writer, table);
}

Totals Totals::read(ByteReader& reader) {
    Totals totals;
    totals.runs_ = reader.number<std::uint64_t>();
    totals.failed_.resize(reader.count(16));
    for (FailedRun& failed : totals.failed_) {
        failed.run = reader.number<std::uint64_t>();
        failed.message = reader.text();
    }
    totals.names_.resize(reader.count(8));
    for (std::string& name : totals.names_) name = reader.text();
    const std::size_t scalars = reader.count(52);
    for (std::size_t i = 0; i < scalars; ++i) totals.scalars_.push_back(read_scalar(reader, totals.runs_));
    totals.tables_.resize(reader.count(48));
    for (TableTotals& table : totals.tables_) table = read_table(reader);
    return totals;
}

}  // namespace pelorus::campaign
