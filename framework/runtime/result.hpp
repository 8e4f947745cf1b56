/// Tables and scalars of one run, as nodes published them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/abi/abi.h>

#include "runtime/bytes.hpp"

namespace pelorus::runtime {

struct Column {
    std::string name, unit;
    std::uint32_t reduce = 0;  ///< PLR_REDUCE_...
    double quantile = 0;
    std::vector<std::string> texts;  ///< of a text column: an element counts into these; empty: a column of numbers
};

struct Scalar {
    std::string name, unit;
    std::uint32_t reduce = 0;
    double value = 0;
    double quantile = 0;
    std::string column;  ///< of the same table, or ""
    double weight = 1;   ///< of this run in a mean over runs
};

struct Table {
    std::string node;
    std::string name;  ///< "" : only scalars
    std::vector<Column> columns;
    std::vector<double> rows;  ///< row by row
    std::vector<Scalar> scalars;
    std::size_t row_count() const { return columns.empty() ? 0 : rows.size() / columns.size(); }
};

/// In the order of nodes in the file, then by name.
struct Results {
    std::vector<Table> tables;
};

void write_columns(ByteWriter& writer, const std::vector<Column>& columns);
/// Throws CorruptBytes.
std::vector<Column> read_columns(ByteReader& reader);

/// Takes the tables that nodes publish. A table of the same node and name replaces the one before.
class ResultCollector {
public:
    /// `table` has passed check_message. Throws std::invalid_argument when another table of the node has a scalar of
    /// the same name: both would be called NODE.SCALAR in the summary.
    void collect(std::size_t node_index, const std::string& node, const plr_table& table);

    const Results& results() const noexcept { return results_; }
    void write(ByteWriter& writer) const;
    /// Replaces everything. `nodes` are the names in file order. Throws CorruptBytes.
    void read(ByteReader& reader, const std::vector<std::string>& nodes);

private:
    void insert(std::size_t node_index, Table table);
    Results results_;
    std::vector<std::size_t> nodes_;  // [tables] indices in file order
};

}  // namespace pelorus::runtime
