#include "report/expected_table.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "report/text_table.hpp"
#include "report/text_width.hpp"

namespace pelorus::report {

namespace {

using Json = nlohmann::ordered_json;

std::string value_text(const Json& value) {
    if (value.is_number()) return fmt::format("{:.4g}", value.get<double>());
    return value.is_string() ? value.get<std::string>() : value.is_null() ? "-" : value.dump();
}

/// The shortest end of each address that no other one has: `noise`, or `radar.noise` beside `camera.noise`.
std::string short_address(const std::string& address, const Words& all) {
    for (std::size_t dot = address.rfind('.'); dot != std::string::npos && dot > 0; dot = address.rfind('.', dot - 1)) {
        const std::string end = address.substr(dot);
        const auto has_it = [&](const std::string& other) {
            return ('.' + other).size() >= end.size() &&
                   ('.' + other).compare(other.size() + 1 - end.size(), end.size(), end) == 0;
        };
        if (std::count_if(all.begin(), all.end(), has_it) == 1) return end.substr(1);
    }
    return address;
}

std::string node_of(const std::string& scalar) { return scalar.substr(0, scalar.find('.')); }

/// The figures of one node, by cell and scalar, in the order in which they come.
struct NodeTable {
    Words cells, scalars, addresses;
    std::map<std::string, const Json*> cell_of;                          // any figure of the cell
    std::map<std::pair<std::string, std::string>, const Json*> figures;  // by cell and scalar

    void add(const Json& figure) {
        const std::string scalar = figure.at("scalar").get<std::string>(),
                          cell = figure.at("variant").dump() + figure.at("sweep").dump();
        add_once(cells, cell);
        add_once(scalars, scalar);
        for (const auto& [address, value] : figure.at("sweep").items()) add_once(addresses, address);
        cell_of.emplace(cell, &figure);
        figures.emplace(std::make_pair(cell, scalar), &figure);
    }

    /// Variant and grid point of each cell.
    Words head_lines() const {
        std::vector<Words> rows{{"variant"}};
        for (const std::string& address : addresses) rows[0].push_back(short_address(address, addresses));
        for (const std::string& cell : cells) {
            Words row{cell_of.at(cell)->at("variant").get<std::string>()};
            for (const std::string& address : addresses) {
                const Json& sweep = cell_of.at(cell)->at("sweep");
                row.push_back(sweep.contains(address) ? value_text(sweep.at(address)) : "");
            }
            rows.push_back(std::move(row));
        }
        Words lines = aligned_lines(rows);
        lines.insert(lines.begin(), "");
        return lines;
    }

    /// Value and expected figures of one scalar, under its name.
    Words scalar_lines(const std::string& scalar) const {
        Words kinds;
        std::string unit;
        for (const std::string& cell : cells)
            if (const auto found = figures.find({cell, scalar}); found != figures.end()) {
                unit = found->second->at("unit").get<std::string>();
                for (const Json& each : found->second->at("expected"))
                    add_once(kinds, each.at("kind").get<std::string>());
            }
        std::vector<Words> rows{{"value "}};
        rows[0].insert(rows[0].end(), kinds.begin(), kinds.end());
        for (const std::string& cell : cells) {
            const auto found = figures.find({cell, scalar});
            rows.push_back(found == figures.end() ? Words{""} : figure_words(*found->second, kinds));
        }
        Words lines = aligned_lines(rows);
        lines.insert(lines.begin(), "  " + scalar + (unit.empty() ? "" : " [" + unit + "]"));
        return lines;
    }

    static Words figure_words(const Json& figure, const Words& kinds) {
        Words words(kinds.size() + 1);
        bool is_outside = false;
        for (const Json& each : figure.at("expected")) {
            const auto kind = std::find(kinds.begin(), kinds.end(), each.at("kind").get<std::string>());
            words[static_cast<std::size_t>(kind - kinds.begin()) + 1] = value_text(each.at("value"));
            is_outside = is_outside || each.at("within") == false;
        }
        words[0] = value_text(figure.at("value")) + (is_outside ? "*" : "");
        return words;
    }
};

/// The blocks beside each other; `left` fills up where a line of it is short.
Words beside(Words left, const Words& right) {
    const std::size_t width = width_of(left);
    for (std::size_t i = 0; i < left.size(); ++i)
        if (!right[i].empty()) left[i] += std::string(width - text_width(left[i]), ' ') + right[i];
    return left;
}

std::string table_text(const NodeTable& table) {
    std::string text;
    const Words head = table.head_lines();
    Words lines = head;
    bool is_begun = false;
    for (const std::string& scalar : table.scalars) {
        Words wider = beside(lines, table.scalar_lines(scalar));
        if (is_begun && width_of(wider) > widest_line) {
            text += joined(lines) + '\n';
            wider = beside(head, table.scalar_lines(scalar));
        }
        lines = std::move(wider);
        is_begun = true;
    }
    return text + joined(lines) + '\n';
}

}  // namespace

std::string expected_table(const Json& beside) {
    Words nodes;
    std::map<std::string, NodeTable> tables;
    for (const Json& figure : beside.at("figures")) {
        const std::string node = node_of(figure.at("scalar").get<std::string>());
        add_once(nodes, node);
        tables[node].add(figure);
    }
    if (nodes.empty()) return "";
    std::string text = "beside what is expected\n";
    for (const std::string& node : nodes) text += table_text(tables.at(node));
    const auto judged = beside.at("judged").get<std::size_t>(), outside = beside.at("outside").get<std::size_t>();
    if (judged > 0)
        text += fmt::format("{} of {} figures keep within their bands and limits{}\n\n", judged - outside, judged,
                            outside > 0 ? "; those that do not are marked *" : "");
    return text;
}

}  // namespace pelorus::report
