#include "report/campaign_table.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "report/text_table.hpp"

namespace pelorus::report {

namespace {

using Json = nlohmann::ordered_json;

std::string value_text(const Json& value) {
    if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
    return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string scalar_text(const Json* scalar, bool with_interval) {
    if (scalar == nullptr || !scalar->at("value").is_number()) return "-";
    std::string text = fmt::format("{:.4g}", scalar->at("value").get<double>());
    if (with_interval && scalar->at("ci95").is_number())
        text += fmt::format(" +- {:.2g}", scalar->at("ci95").get<double>());
    return text;
}

/// Cells by variant and grid point, in the order in which they come.
struct Grid {
    Words variants, points;
    std::map<std::string, const Json*> sweeps;                         // of points
    std::map<std::pair<std::string, std::string>, const Json*> cells;  // by variant and point
    Words scalars;
    std::map<std::string, std::string> units;  // of scalars

    explicit Grid(const Json& summary) {
        for (const Json& cell : summary.at("cells")) {
            const std::string variant = cell.at("variant").get<std::string>(), point = cell.at("sweep").dump();
            add_once(variants, variant);
            add_once(points, point);
            sweeps[point] = &cell.at("sweep");
            cells[{variant, point}] = &cell;
            for (const auto& [name, scalar] : cell.at("scalars").items()) {
                add_once(scalars, name);
                units[name] = scalar.at("unit").get<std::string>();
            }
        }
    }

    const Json* scalar(const std::string& name, const std::string& variant, const std::string& point) const {
        const auto cell = cells.find({variant, point});
        if (cell == cells.end()) return nullptr;
        const auto found = cell->second->at("scalars").find(name);
        return found == cell->second->at("scalars").end() ? nullptr : &*found;
    }
};

/// Lines of the head: an address each, with its value at each point; then a line for each variant.
std::vector<Words> rows_of(const Grid& grid, const std::string& name, const Words& points, bool with_interval) {
    Words addresses;
    for (const std::string& point : points)
        for (const auto& [address, value] : grid.sweeps.at(point)->items()) add_once(addresses, address);
    std::vector<Words> rows;
    for (const std::string& address : addresses) {
        Words row{address};
        for (const std::string& point : points) {
            const auto value = grid.sweeps.at(point)->find(address);
            row.push_back(value == grid.sweeps.at(point)->end() ? "" : value_text(*value));
        }
        rows.push_back(std::move(row));
    }
    for (const std::string& variant : grid.variants) {
        Words row{variant};
        for (const std::string& point : points)
            row.push_back(scalar_text(grid.scalar(name, variant, point), with_interval));
        if (std::any_of(row.begin() + 1, row.end(), [](const std::string& word) { return word != "-"; }))
            rows.push_back(std::move(row));
    }
    return rows;
}

/// As many points beside each other as a line takes, then the next.
std::string scalar_table(const Grid& grid, const std::string& name) {
    const std::string& unit = grid.units.at(name);
    std::string text = name + (unit.empty() ? "" : " [" + unit + "]") + '\n';
    std::size_t from = 0;
    while (from < grid.points.size()) {
        Words lines;
        std::size_t to = from;
        for (std::size_t more = from + 1; more <= grid.points.size(); ++more) {
            const Words points(grid.points.begin() + static_cast<std::ptrdiff_t>(from),
                               grid.points.begin() + static_cast<std::ptrdiff_t>(more));
            Words wider = aligned_lines(rows_of(grid, name, points, grid.points.size() <= 3));
            if (to > from && width_of(wider) > widest_line) break;
            lines = std::move(wider);
            to = more;
        }
        text += joined(lines);
        from = to;
    }
    return text;
}

std::string runs_text(const Json& summary) {
    std::uint64_t least = 0, failed = 0;
    bool is_first = true, differs = false;
    for (const Json& cell : summary.at("cells")) {
        const auto runs = cell.at("runs").get<std::uint64_t>();
        differs = differs || (!is_first && runs != least);
        least = is_first ? runs : std::min(least, runs);
        is_first = false;
        failed += cell.value("failed", std::uint64_t{0});
    }
    const std::size_t cells = summary.at("cells").size();
    return fmt::format("{} {} of {}{} {}{}\n", cells, cells == 1 ? "cell" : "cells", differs ? "at least " : "", least,
                       least == 1 ? "run" : "runs", failed > 0 ? fmt::format(", {} failed", failed) : "");
}

}  // namespace

std::string campaign_table(const Json& summary) {
    const Grid grid(summary);
    std::string text = runs_text(summary);
    for (const std::string& name : grid.scalars) text += '\n' + scalar_table(grid, name);
    return text + '\n';
}

}  // namespace pelorus::report
