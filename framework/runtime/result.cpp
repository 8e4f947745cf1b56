#include "runtime/result.hpp"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "runtime/message_fields.hpp"

namespace pelorus::runtime {
namespace {

Column column_of(const plr_column& from) {
    Column column{from.name, from.unit, from.reduce, from.quantile, {}};
    for (std::uint32_t i = 0; from.texts && i < from.text_count; ++i) column.texts.emplace_back(from.texts[i]);
    return column;
}

Table table_of(const std::string& node, const plr_table& from) {
    Table table;
    table.node = node;
    table.name = from.name;
    for (std::uint32_t i = 0; i < from.column_count; ++i)
        table.columns.push_back(column_of(known_element(from.columns, i)));
    if (from.rows.data) {
        table.rows.reserve(static_cast<std::size_t>(from.rows.count) * from.column_count);
        for (std::int64_t row = 0; row < from.rows.count; ++row)
            for (std::int64_t col = 0; col < from.column_count; ++col)
                table.rows.push_back(from.rows.data[row * from.rows.item_stride + col * from.rows.row_stride]);
    }
    for (std::uint32_t i = 0; i < from.scalar_count; ++i) {
        const plr_scalar scalar = known_element(from.scalars, i);
        table.scalars.push_back({scalar.name, scalar.unit, scalar.reduce, scalar.value, scalar.quantile,
                                 scalar.column ? scalar.column : "", scalar.weight == 0 ? 1 : scalar.weight});
    }
    return table;
}

void write_table(ByteWriter& writer, const Table& table) {
    writer.text(table.name);
    write_columns(writer, table.columns);
    writer.sized(table.rows.data(), table.rows.size() * sizeof(double));
    writer.number(std::uint64_t{table.scalars.size()});
    for (const Scalar& scalar : table.scalars) {
        writer.text(scalar.name);
        writer.text(scalar.unit);
        writer.number(scalar.reduce);
        writer.number(scalar.value);
        writer.number(scalar.quantile);
        writer.text(scalar.column);
        writer.number(scalar.weight);
    }
}

Table read_table(ByteReader& reader) {
    Table table;
    table.name = reader.text();
    table.columns = read_columns(reader);
    const std::size_t bytes = reader.count(1);
    const std::size_t row = std::max<std::size_t>(table.columns.size(), 1) * sizeof(double);
    if (bytes % row != 0 || (bytes > 0 && table.columns.empty())) throw CorruptBytes("a table has a broken row");
    table.rows.resize(bytes / sizeof(double));
    reader.block(table.rows.data(), bytes);
    table.scalars.resize(reader.count(52));
    for (Scalar& scalar : table.scalars) {
        scalar.name = reader.text();
        scalar.unit = reader.text();
        scalar.reduce = reader.number<std::uint32_t>();
        scalar.value = reader.number<double>();
        scalar.quantile = reader.number<double>();
        scalar.column = reader.text();
        scalar.weight = reader.number<double>();
    }
    return table;
}

}  // namespace

void write_columns(ByteWriter& writer, const std::vector<Column>& columns) {
    writer.number(std::uint64_t{columns.size()});
    for (const Column& column : columns) {
        writer.text(column.name);
        writer.text(column.unit);
        writer.number(column.reduce);
        writer.number(column.quantile);
        writer.number(std::uint64_t{column.texts.size()});
        for (const std::string& text : column.texts) writer.text(text);
    }
}

std::vector<Column> read_columns(ByteReader& reader) {
    std::vector<Column> columns(reader.count(36));
    for (Column& column : columns) {
        column.name = reader.text();
        column.unit = reader.text();
        column.reduce = reader.number<std::uint32_t>();
        column.quantile = reader.number<double>();
        column.texts.resize(reader.count(8));
        for (std::string& text : column.texts) text = reader.text();
    }
    return columns;
}

void ResultCollector::insert(std::size_t node_index, Table table) {
    std::size_t place = 0;
    while (place < nodes_.size() &&
           std::tie(nodes_[place], results_.tables[place].name) < std::tie(node_index, table.name))
        ++place;
    const auto offset = static_cast<std::ptrdiff_t>(place);
    if (place < nodes_.size() && nodes_[place] == node_index && results_.tables[place].name == table.name) {
        results_.tables[place] = std::move(table);
        return;
    }
    nodes_.insert(nodes_.begin() + offset, node_index);
    results_.tables.insert(results_.tables.begin() + offset, std::move(table));
}

void ResultCollector::collect(std::size_t node_index, const std::string& node, const plr_table& from) {
    Table table = table_of(node, from);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Table& other = results_.tables[i];
        if (nodes_[i] != node_index || other.name == table.name) continue;
        for (const Scalar& mine : table.scalars)
            for (const Scalar& theirs : other.scalars)
                if (mine.name == theirs.name)
                    throw std::invalid_argument("tables \"" + other.name + "\" and \"" + table.name +
                                                "\" have a scalar of the same name " + mine.name);
    }
    insert(node_index, std::move(table));
}

void ResultCollector::write(ByteWriter& writer) const {
    writer.number(std::uint64_t{nodes_.size()});
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        writer.number(std::uint64_t{nodes_[i]});
        write_table(writer, results_.tables[i]);
    }
}

void ResultCollector::read(ByteReader& reader, const std::vector<std::string>& nodes) {
    ResultCollector fresh;
    for (std::size_t left = reader.count(32); left > 0; --left) {
        const auto node = reader.number<std::uint64_t>();
        if (node >= nodes.size()) throw CorruptBytes("a table belongs to no node");
        Table table = read_table(reader);
        table.node = nodes[static_cast<std::size_t>(node)];
        fresh.insert(static_cast<std::size_t>(node), std::move(table));
    }
    *this = std::move(fresh);
}

}  // namespace pelorus::runtime
