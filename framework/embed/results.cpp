#include "embed/results.hpp"

#include <utility>

namespace pelorus::embed {

Results::Results(report::Cell cell, report::Timings timings) : cell_(std::move(cell)), timings_(std::move(timings)) {
    for (const report::ScalarResult& scalar : cell_.scalars)
        scalars_.push_back({sizeof(pelorus_scalar_info), 0, scalar.name.c_str(), scalar.unit.c_str(), scalar.value});
    for (const report::TableResult& table : cell_.tables) add_table(table);
    for (const report::NodeReport& node : timings_.nodes) add_diagnostics(node);
}

void Results::add_table(const report::TableResult& table) {
    std::vector<plr_column>& columns = columns_.emplace_back();
    for (const runtime::Column& column : table.columns) {
        std::vector<const char*>& texts = texts_.emplace_back();
        for (const std::string& text : column.texts) texts.push_back(text.c_str());
        columns.push_back({sizeof(plr_column), column.reduce, column.name.c_str(), column.unit.c_str(), column.quantile,
                           texts.empty() ? nullptr : texts.data(), static_cast<std::uint32_t>(texts.size()), 0});
    }
    const auto width = static_cast<std::int64_t>(columns.size());
    const auto height = static_cast<std::int64_t>(table.row_count());
    plr_table answer{};
    answer.struct_size = sizeof answer;
    answer.column_count = static_cast<std::uint32_t>(width);
    answer.name = table.name.c_str();
    answer.columns = columns.data();
    answer.rows = {table.rows.data(), width, 1, height, 1, width, width};
    tables_.push_back(answer);
}

void Results::add_diagnostics(const report::NodeReport& node) {
    const char* name = node.timing.node.c_str();
    for (const auto& [counter, value] : node.counters)
        diagnostics_.push_back({sizeof(pelorus_diagnostic_info), 1, name, counter.c_str(), "", value, 0});
    for (const auto& [gauge, told] : node.gauges)
        diagnostics_.push_back(
            {sizeof(pelorus_diagnostic_info), 0, name, gauge.c_str(), told.unit.c_str(), 0, told.value});
}

}  // namespace pelorus::embed
