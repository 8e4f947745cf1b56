#include "graph/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "graph/scalar_reader.hpp"
#include "graph/units.hpp"
#include "graph/yaml.hpp"
#include "host/description.hpp"

namespace pelorus::graph {

namespace {

using host::element;

plr_const_view packed(const std::vector<double>& numbers, std::size_t rows, std::size_t cols) {
    const auto r = static_cast<std::int64_t>(rows), c = static_cast<std::int64_t>(cols);
    return {numbers.data(), r, c, 1, 1, r, r * c};
}

/// Says how many `what` (elements, rows, columns) are wanted, if `count` are not. `hint`: what may have led to so many.
void check_count(std::size_t count, std::int32_t least, std::int32_t most, const std::string& what, const Value& value,
                 const std::string& label, const std::string& hint = {}) {
    const auto given = static_cast<std::int64_t>(count);
    if (given >= least && (most < 0 || given <= most)) return;
    std::string wanted = std::to_string(least);
    if (most < 0)
        wanted = "at least " + wanted;
    else if (most != least)
        wanted += " to " + std::to_string(most);
    throw ValueError(value.where, label, "expected " + wanted + " " + what + ", got " + std::to_string(count) + hint);
}

bool is_whole_number(const std::string& text) {
    const std::size_t sign = !text.empty() && (text.front() == '-' || text.front() == '+') ? 1 : 0;
    return text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string::npos;
}

bool is_number(const std::string& text) {
    try {
        parse_number(text);
        return true;
    } catch (const UnitError&) {
        return false;
    }
}

std::string indexed(const std::string& label, std::size_t index) { return label + "[" + std::to_string(index) + "]"; }

/// Whether only a comma, no blank, stands between two numbers of a list, where their places are known.
bool are_joined(const Value& first, const Value& second) {
    return first.where.line == second.where.line &&
           second.where.column == first.where.column + static_cast<int>(first.scalar.size()) + 1;
}

/// `0,15 deg` in a list is two elements: `0` and `15 deg`. "" if none looks like that.
std::string decimal_comma(const std::vector<Value>& list) {
    const auto is_bare = [](const Value& value) { return value.is_scalar() && !value.quoted && !value.scalar.empty(); };
    bool are_all_joined = true;
    for (std::size_t i = 0; i + 1 < list.size(); ++i)
        are_all_joined = are_all_joined && are_joined(list[i], list[i + 1]);
    for (std::size_t i = 0; i + 1 < list.size(); ++i) {
        const Value &whole = list[i], &decimals = list[i + 1];
        if (!is_bare(whole) || !is_bare(decimals) || !is_whole_number(whole.scalar)) continue;
        if (decimals.scalar.front() < '0' || decimals.scalar.front() > '9') continue;
        const bool has_unit = !is_whole_number(decimals.scalar);
        const bool has_place = whole.where.line > 0;
        if (has_place ? are_joined(whole, decimals) && (has_unit || !are_all_joined) : has_unit)
            return "; is '" + whole.scalar + "," + decimals.scalar +
                   "' one of them? Decimals stand after a point, not a comma";
    }
    return {};
}

/// One value for elements that do not measure the same: only a number without unit can be meant for all.
void check_fills(const Value& value, const std::vector<std::string>& units, std::size_t rows,
                 const std::string& label) {
    const std::vector<std::string> used(units.begin(), units.begin() + static_cast<std::ptrdiff_t>(rows));
    if (std::count(used.begin(), used.end(), used.front()) == static_cast<std::ptrdiff_t>(rows)) return;
    if (is_number(value.scalar)) return;
    throw ValueError(value.where, label,
                     "takes " + std::to_string(rows) + " values (" + join(used) + "), got one: " + value.described());
}

void read_vector(const plr_parameter& parameter, const Value& value, const std::string& label, StoredValue& stored) {
    const bool fills = value.is_scalar();
    if (!fills && !value.is_list())
        throw ValueError(value.where, label,
                         "expected a list, or one value for all elements, got " + value.described());
    if (!fills)
        check_count(value.list.size(), parameter.rows_min, parameter.rows_max, "elements", value, label,
                    decimal_comma(value.list));
    const std::size_t rows = fills ? static_cast<std::size_t>(std::max(parameter.rows_min, 1)) : value.list.size();
    const std::vector<std::string> units = element_units(parameter, rows, value.where, label);
    if (fills) check_fills(value, units, rows, label);
    for (std::size_t r = 0; r < rows; ++r)
        stored.numbers.push_back(fills ? read_double(parameter, units[r], value, label)
                                       : read_double(parameter, units[r], value.list[r], indexed(label, r)));
    stored.value.numbers = packed(stored.numbers, rows, 1);
}

void read_matrix(const plr_parameter& parameter, const Value& value, const std::string& label, StoredValue& stored) {
    if (!value.is_list()) throw ValueError(value.where, label, "expected a list of rows, got " + value.described());
    const std::size_t rows = value.list.size();
    check_count(rows, parameter.rows_min, parameter.rows_max, "rows", value, label);
    const std::size_t cols = rows == 0 ? 0 : value.list.front().list.size();
    const std::vector<std::string> units = element_units(parameter, rows, value.where, label);
    stored.numbers.resize(rows * cols);
    for (std::size_t r = 0; r < rows; ++r) {
        const Value& row = value.list[r];
        if (!row.is_list())
            throw ValueError(row.where, indexed(label, r),
                             "expected a list (one row of the matrix), got " + row.described());
        check_count(row.list.size(), parameter.cols_min, parameter.cols_max, "columns", row, indexed(label, r));
        if (row.list.size() != cols)
            throw ValueError(
                row.where, indexed(label, r),
                "has " + std::to_string(row.list.size()) + " columns, the first row has " + std::to_string(cols));
        for (std::size_t c = 0; c < cols; ++c)
            stored.numbers[c * rows + r] = read_double(parameter, units[r], row.list[c], indexed(indexed(label, r), c));
    }
    stored.value.numbers = packed(stored.numbers, rows, cols);
}

/// A table's cell: its number, and its text where the column has one.
void read_cell(const plr_parameter& column, const Value& value, const std::string& label, double& number,
               const char*& text, std::deque<std::string>& words) {
    switch (column.type) {
        case PLR_TYPE_BOOL:
            number = read_bool(value, label) ? 1 : 0;
            break;
        case PLR_TYPE_INT:
            number = static_cast<double>(read_integer(column, value, label));
            break;
        case PLR_TYPE_DOUBLE:
            number = read_double(column, element_units(column, 1, value.where, label).front(), value, label);
            break;
        case PLR_TYPE_CHOICE: {
            const std::uint32_t choice = read_choice(column, value, label);
            number = choice;
            text = column.choices[choice];
            break;
        }
        default:
            number = 0;
            text = words.emplace_back(read_string(value, label)).c_str();
    }
}

Value default_value(const plr_parameter& parameter, const ParameterContext& context) {
    return read_yaml(parameter.default_text, {context.where, {}, context.base});
}

class TableReader {
public:
    TableReader(const plr_parameter& parameter, const ParameterContext& context, StoredValue& stored)
        : parameter_(parameter), context_(context), stored_(stored) {
        for (std::uint32_t c = 0; c < parameter.column_count; ++c)
            names_.emplace_back(element(parameter.columns, c).name);
    }

    void read(const Value& value, const std::string& label) {
        if (!value.is_list())
            throw ValueError(
                value.where, label,
                "expected a list of rows (maps from column to value, or lists of values), got " + value.described());
        const std::size_t rows = value.list.size();
        check_count(rows, parameter_.rows_min, parameter_.rows_max, "rows", value, label);
        stored_.numbers.resize(rows * names_.size());
        stored_.texts.resize(rows * names_.size(), nullptr);
        for (std::size_t r = 0; r < rows; ++r) read_row(value.list[r], r, rows, indexed(label, r));
        stored_.value.numbers = packed(stored_.numbers, rows, names_.size());
        stored_.value.texts = stored_.texts.data();
    }

private:
    /// A row is a map from column to value, or a list of values in the order of the columns.
    void read_row(const Value& row, std::size_t r, std::size_t rows, const std::string& label) {
        if (!row.is_map() && !row.is_list())
            throw ValueError(row.where, label,
                             "expected a map from column to value, or a list of values, got " + row.described());
        if (row.is_list() && row.list.size() > names_.size())
            throw ValueError(row.list[names_.size()].where, label,
                             "has " + std::to_string(row.list.size()) + " values, columns are " + join(names_));
        for (const Value::Entry& entry : row.map)
            if (std::find(names_.begin(), names_.end(), entry.key) == names_.end())
                throw ValueError(entry.where, label,
                                 "there is no column '" + entry.key + "'" + suggestion(entry.key, names_, "columns"));
        for (std::uint32_t c = 0; c < names_.size(); ++c) {
            const plr_parameter& column = element(parameter_.columns, c);
            double& number = stored_.numbers[c * rows + r];
            const char*& text = stored_.texts[r * names_.size() + c];
            const std::string cell = label + "." + names_[c];
            const Value* given = row.is_map() ? row.find(names_[c]) : c < row.list.size() ? &row.list[c] : nullptr;
            if (given != nullptr)
                read_cell(column, *given, cell, number, text, stored_.words);
            else if ((column.flags & PLR_PARAMETER_OPTIONAL) != 0)
                missing(column, number);
            else if (column.default_text == nullptr || (column.flags & PLR_PARAMETER_REQUIRED) != 0)
                throw ValueError(row.where, label, "column '" + names_[c] + "' is required");
            else
                read_cell(column, default_value(column, context_), cell, number, text, stored_.words);
        }
    }

    static void missing(const plr_parameter& column, double& number) {
        number = column.type == PLR_TYPE_STRING ? 0 : std::numeric_limits<double>::quiet_NaN();
    }

    const plr_parameter& parameter_;
    const ParameterContext& context_;
    StoredValue& stored_;
    std::vector<std::string> names_;
};

void read_value(const plr_parameter& parameter, const Value& value, const std::string& label,
                const ParameterContext& context, StoredValue& stored) {
    plr_value& out = stored.value;
    switch (parameter.type) {
        case PLR_TYPE_BOOL:
            out.integer = read_bool(value, label) ? 1 : 0;
            break;
        case PLR_TYPE_INT:
            out.integer = read_integer(parameter, value, label);
            break;
        case PLR_TYPE_DOUBLE:
            out.number = read_double(parameter, element_units(parameter, 1, value.where, label).front(), value, label);
            break;
        case PLR_TYPE_STRING:
            stored.text = read_string(value, label);
            break;
        case PLR_TYPE_PATH:
            stored.text = read_path(value, label, context.variables);
            break;
        case PLR_TYPE_CHOICE:
            out.integer = read_choice(parameter, value, label);
            out.text = parameter.choices[out.integer];
            break;
        case PLR_TYPE_VECTOR:
            read_vector(parameter, value, label, stored);
            break;
        case PLR_TYPE_MATRIX:
            read_matrix(parameter, value, label, stored);
            break;
        case PLR_TYPE_TABLE:
            TableReader(parameter, context, stored).read(value, label);
            break;
        default:
            throw ValueError(value.where, label, "the plugin declares a type that this host does not know");
    }
    if (parameter.type == PLR_TYPE_STRING || parameter.type == PLR_TYPE_PATH) out.text = stored.text.c_str();
    out.present = 1;
}

void read_default(const plr_parameter& parameter, const ParameterContext& context, StoredValue& stored) {
    if ((parameter.flags & PLR_PARAMETER_OPTIONAL) != 0) {
        stored.value.number = std::numeric_limits<double>::quiet_NaN();
        return;
    }
    const std::string name = parameter.name;
    if ((parameter.flags & PLR_PARAMETER_REQUIRED) != 0 || parameter.default_text == nullptr) {
        const std::string doc = parameter.doc;
        context.problems.add(context.where, context.address + ": parameter '" + name + "' is required" +
                                                (doc.empty() ? "" : " (" + doc + ")"));
        return;
    }
    const std::string prefix = "plugin " + context.plugin + " declares a default that does not fit: ";
    try {
        Value value = default_value(parameter, context);
        // An empty default is the empty text, not the absence of a value.
        if (value.is_null() && (parameter.type == PLR_TYPE_STRING || parameter.type == PLR_TYPE_PATH)) {
            value.kind = Value::Kind::scalar;
            value.quoted = true;
        }
        read_value(parameter, value, name, context, stored);
    } catch (const ValueError& error) {
        // A path's default may name a variable; that one is not set is the user's business, not the plugin's.
        context.problems.add(error.where, parameter.type == PLR_TYPE_PATH ? context.address + "." + error.what()
                                                                          : prefix + error.what());
    } catch (const ConfigError& error) {
        context.problems.add(context.where, prefix + name + ": " + error.items().front().text);
    }
}

}  // namespace

void ParameterSet::complete() {
    values_.clear();
    for (const StoredValue& stored : stored_) values_.push_back(stored.value);
}

ParameterSet read_parameters(const plr_parameter* first, std::uint32_t count, const Value& with,
                             const ParameterContext& context) {
    ParameterSet values;
    for (std::uint32_t i = 0; i < count; ++i) {
        const plr_parameter& parameter = element(first, i);
        StoredValue& stored = values.append();
        stored.value.struct_size = sizeof(plr_value);
        const std::string label = context.address + "." + parameter.name;
        const Value::Entry* given = with.entry(parameter.name);
        if (given == nullptr || (given->value.is_null() && given->where.line == 0)) {
            read_default(parameter, context, stored);
        } else if (given->value.is_null()) {
            context.problems.add(given->where,
                                 label + ": has no value; give one, or leave the key out for the default");
        } else {
            try {
                read_value(parameter, given->value, label, context, stored);
            } catch (const ValueError& error) {
                context.problems.add(error.where, error.what());
            }
        }
    }
    values.complete();
    return values;
}

namespace {

nlohmann::ordered_json number_json(double number) {
    return std::isfinite(number) ? nlohmann::ordered_json(number) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json table_json(const plr_parameter& parameter, const plr_value& value) {
    auto rows = nlohmann::ordered_json::array();
    const auto columns = static_cast<std::int64_t>(parameter.column_count);
    for (std::int64_t r = 0; r < value.numbers.rows; ++r) {
        auto row = nlohmann::ordered_json::object();
        for (std::int64_t c = 0; c < columns; ++c) {
            const plr_parameter& column = element(parameter.columns, static_cast<std::uint32_t>(c));
            const double number = value.numbers.data[c * value.numbers.rows + r];
            const char* text = value.texts[r * columns + c];
            const bool is_text = column.type == PLR_TYPE_STRING || column.type == PLR_TYPE_CHOICE;
            if (is_text ? text == nullptr : std::isnan(number)) continue;
            if (is_text)
                row[column.name] = text;
            else if (column.type == PLR_TYPE_BOOL)
                row[column.name] = number != 0;
            else if (column.type == PLR_TYPE_INT)
                row[column.name] = static_cast<std::int64_t>(number);
            else
                row[column.name] = number;
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

nlohmann::ordered_json value_json(const plr_parameter& parameter, const plr_value& value) {
    switch (parameter.type) {
        case PLR_TYPE_BOOL:
            return value.integer != 0;
        case PLR_TYPE_INT:
            return value.integer;
        case PLR_TYPE_DOUBLE:
            return number_json(value.number);
        case PLR_TYPE_TABLE:
            return table_json(parameter, value);
        case PLR_TYPE_VECTOR:
        case PLR_TYPE_MATRIX:
            break;
        default:
            return value.text == nullptr ? "" : value.text;
    }
    auto rows = nlohmann::ordered_json::array();
    for (std::int64_t r = 0; r < value.numbers.rows; ++r) {
        auto row = nlohmann::ordered_json::array();
        for (std::int64_t c = 0; c < value.numbers.cols; ++c)
            row.push_back(number_json(value.numbers.data[c * value.numbers.rows + r]));
        rows.push_back(parameter.type == PLR_TYPE_VECTOR ? row.front() : row);
    }
    return rows;
}

}  // namespace

nlohmann::ordered_json parameters_json(const plr_parameter* first, const ParameterSet& values) {
    auto json = nlohmann::ordered_json::object();
    for (std::uint32_t i = 0; i < values.size(); ++i) {
        const plr_parameter& parameter = element(first, i);
        if (values[i].present != 0) json[parameter.name] = value_json(parameter, values[i]);
    }
    return json;
}

}  // namespace pelorus::graph
