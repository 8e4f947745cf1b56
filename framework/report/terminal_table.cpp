#include "report/terminal_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "report/text_width.hpp"

namespace pelorus::report {
namespace {

std::string significant(double x) { return std::isfinite(x) ? fmt::format("{:.5g}", x) : "-"; }

using Row = std::array<std::string, 4>;  // name, value, unit, remark

Row row_of(const ScalarResult& scalar) {
    std::string remark;
    if (scalar.ci95) remark = "+- " + significant(*scalar.ci95);
    if (scalar.non_finite > 0)
        remark += fmt::format("{}({} not finite, left out)", remark.empty() ? "" : " ", scalar.non_finite);
    return {scalar.name, significant(scalar.value), scalar.unit, remark};
}

std::string aligned(const std::vector<Row>& rows) {
    std::array<std::size_t, 3> widths{};
    for (const Row& row : rows)
        for (std::size_t i = 0; i < widths.size(); ++i) widths[i] = std::max(widths[i], text_width(row[i]));
    std::string text;
    for (const Row& row : rows) {
        const auto space = [&](std::size_t i) { return std::string(widths[i] - text_width(row[i]), ' '); };
        std::string line = row[0] + space(0) + "  " + space(1) + row[1] + "  " + row[2] + space(2) + "  " + row[3];
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    }
    return text;
}

std::string heading(const Cell& cell) {
    std::string text = cell.variant;
    for (const auto& [address, value] : cell.sweep.items()) text += fmt::format(", {} = {}", address, value.dump());
    return fmt::format("{} ({} {})\n", text, cell.runs, cell.runs == 1 ? "run" : "runs");
}

}  // namespace

std::string terminal_table(const std::vector<Cell>& cells) {
    std::string text;
    for (const Cell& cell : cells) {
        if (cells.size() > 1) text += (text.empty() ? "" : "\n") + heading(cell);
        std::vector<Row> rows;
        for (const ScalarResult& scalar : cell.scalars) rows.push_back(row_of(scalar));
        text += aligned(rows);
        std::string tables;
        for (const TableResult& table : cell.tables)
            tables += fmt::format("{}{} ({} {})", tables.empty() ? "" : ", ", table.name, table.row_count(),
                                  table.row_count() == 1 ? "row" : "rows");
        if (!tables.empty()) text += "tables: " + tables + '\n';
    }
    return text;
}

std::string counter_lines(const Timings& timings) {
    std::string text;
    for (const NodeReport& node : timings.nodes) {
        std::string counters;
        for (const auto& [name, value] : node.counters)
            if (value != 0) counters += fmt::format("{}{} {}", counters.empty() ? "" : ", ", name, value);
        if (!counters.empty()) text += fmt::format("{} counted: {}\n", node.timing.node, counters);
    }
    return text;
}

std::vector<std::string> file_names(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code unreadable;
    for (std::filesystem::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable))
        if (entry->is_regular_file(unreadable)) names.push_back(entry->path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::string file_line(const std::filesystem::path& folder) {
    std::string list;
    for (const std::string& name : file_names(folder)) list += (list.empty() ? "" : ", ") + name;
    return list.empty() ? "" : folder.string() + ": " + list + '\n';
}

}  // namespace pelorus::report
