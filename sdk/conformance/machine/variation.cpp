#include "variation.hpp"

#include <cmath>

#include <fmt/format.h>

#include "creation.hpp"

namespace pelorus::conformance {

namespace {

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

std::string number_text(double number) { return fmt::format("{:.17g}", number); }

/// A list of maps, without the cells that are not given.
std::string table_yaml(const plr_parameter& parameter, const plr_value& table) {
    std::vector<std::string> rows;
    const plr_const_view& numbers = table.numbers;
    for (std::int64_t r = 0; r < numbers.rows; ++r) {
        std::vector<std::string> cells;
        for (std::uint32_t c = 0; c < parameter.column_count; ++c) {
            const plr_parameter& column = element_of(parameter.columns, c);
            plr_value cell{};
            cell.number = numbers.data[c * numbers.col_stride + r * numbers.row_stride];
            cell.text = table.texts[r * numbers.cols + c];
            const bool is_text = column.type == PLR_TYPE_STRING || column.type == PLR_TYPE_CHOICE;
            if (is_text ? cell.text == nullptr : std::isnan(cell.number)) continue;
            if (column.type == PLR_TYPE_BOOL || column.type == PLR_TYPE_INT)
                cell.integer = static_cast<std::int64_t>(cell.number);
            cells.push_back(fmt::format("{}: {}", column.name, yaml_of(column, cell)));
        }
        rows.push_back(fmt::format("{{{}}}", fmt::join(cells, ", ")));
    }
    return fmt::format("[{}]", fmt::join(rows, ", "));
}

/// Another number that the description allows: half as much again, or half way to a bound.
double other_number(const plr_parameter& parameter, double number) {
    double other = number == 0 ? 1 : number * 1.5;
    if (other >= parameter.max) other = number + (parameter.max - number) / 2;
    if (other == number || other <= parameter.min) other = number - (number - parameter.min) / 2;
    return other;
}

std::string other_value(const plr_parameter& parameter, plr_value value) {
    if (value.present == 0) return {};
    switch (parameter.type) {
        case PLR_TYPE_BOOL:
            value.integer = value.integer == 0;
            break;
        case PLR_TYPE_INT:
            value.integer += static_cast<double>(value.integer) + 1 <= parameter.max ? 1 : -1;
            if (static_cast<double>(value.integer) < parameter.min) return {};
            break;
        case PLR_TYPE_DOUBLE:
            value.number = other_number(parameter, value.number);
            break;
        case PLR_TYPE_CHOICE:
            value.integer = (value.integer + 1) % parameter.choice_count;
            value.text = parameter.choices[value.integer];
            break;
        case PLR_TYPE_VECTOR: {
            std::string list;
            for (std::int64_t r = 0; r < value.numbers.rows; ++r)
                list += (r == 0 ? "" : ", ") + number_text(other_number(parameter, value.numbers.data[r]));
            return list.empty() ? "" : "[" + list + "]";
        }
        default:
            return {};
    }
    return yaml_of(parameter, value);
}

}  // namespace

std::string yaml_of(const plr_parameter& parameter, const plr_value& value) {
    switch (parameter.type) {
        case PLR_TYPE_BOOL:
            return value.integer != 0 ? "true" : "false";
        case PLR_TYPE_INT:
            return std::to_string(value.integer);
        case PLR_TYPE_DOUBLE:
            return number_text(value.number);
        case PLR_TYPE_STRING:
        case PLR_TYPE_PATH:
            return quoted(value.text == nullptr ? "" : value.text);
        case PLR_TYPE_CHOICE:
            return value.text;
        case PLR_TYPE_VECTOR:
        case PLR_TYPE_MATRIX: {
            const bool is_matrix = parameter.type == PLR_TYPE_MATRIX;
            std::string rows;
            for (std::int64_t r = 0; r < value.numbers.rows; ++r) {
                std::string row;
                for (std::int64_t c = 0; c < value.numbers.cols; ++c)
                    row += (c == 0 ? "" : ", ") + number_text(value.numbers.data[c * value.numbers.col_stride + r]);
                rows += (r == 0 ? "" : ", ") + (is_matrix ? "[" + row + "]" : row);
            }
            return "[" + rows + "]";
        }
        case PLR_TYPE_TABLE:
            return table_yaml(parameter, value);
        default:
            return {};
    }
}

std::vector<std::string> variations_of(const Bench& bench) {
    const plr_description& description = bench.description();
    const auto values = bench.host().values(description.parameters, description.parameter_count,
                                            bench.subject().node.with.get(), description.id);
    std::vector<std::string> single;
    for (std::uint32_t p = 0; p < description.parameter_count; ++p) {
        const plr_parameter& parameter = element_of(description.parameters, p);
        const std::string text = other_value(parameter, values->data()[p]);
        if (!text.empty()) single.push_back(fmt::format("{}: {}", parameter.name, text));
    }
    std::vector<std::string> all{fmt::format("{{{}}}", fmt::join(single, ", "))};
    for (const std::string& each : single) all.push_back("{" + each + "}");
    return all;
}

}  // namespace pelorus::conformance
