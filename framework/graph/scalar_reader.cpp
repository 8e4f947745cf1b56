#include "graph/scalar_reader.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "graph/units.hpp"

namespace pelorus::graph {

namespace {

std::string number_text(double number) {
    char text[32];
    const auto [end, error] = std::to_chars(text, text + sizeof text, number);
    return error == std::errc() ? std::string(text, end) : std::to_string(number);
}

/// `at least 0 m and less than 5 m`
std::string range_text(const plr_parameter& parameter, const std::string& unit) {
    const std::string after = unit.empty() ? "" : " " + unit;
    std::string text;
    if (std::isfinite(parameter.min))
        text = ((parameter.flags & PLR_PARAMETER_MIN_EXCLUSIVE) != 0 ? "greater than " : "at least ") +
               number_text(parameter.min) + after;
    if (std::isfinite(parameter.max))
        text += std::string(text.empty() ? "" : " and ") +
                ((parameter.flags & PLR_PARAMETER_MAX_EXCLUSIVE) != 0 ? "less than " : "at most ") +
                number_text(parameter.max) + after;
    return text;
}

void check_range(const plr_parameter& parameter, double number, const std::string& unit, const Value& value,
                 const std::string& label) {
    const bool too_small =
        (parameter.flags & PLR_PARAMETER_MIN_EXCLUSIVE) != 0 ? number <= parameter.min : number < parameter.min;
    const bool too_large =
        (parameter.flags & PLR_PARAMETER_MAX_EXCLUSIVE) != 0 ? number >= parameter.max : number > parameter.max;
    if (too_small || too_large)
        throw ValueError(value.where, label, "must be " + range_text(parameter, unit) + ", got " + value.described());
}

const std::string& text_of(const Value& value, const std::string& expected, const std::string& label) {
    if (!value.is_scalar()) throw ValueError(value.where, label, expected + ", got " + value.described());
    if (value.scalar.find('\0') != std::string::npos)  // plugins get C strings
        throw ValueError(value.where, label, expected + ", got a text with a zero byte");
    return value.scalar;
}

}  // namespace

bool read_bool(const Value& value, const std::string& label) {
    const std::string& text = text_of(value, "expected true or false", label);
    if (text == "true") return true;
    if (text == "false") return false;
    throw ValueError(value.where, label, "expected true or false, got " + value.described());
}

std::int64_t read_integer(const plr_parameter& parameter, const Value& value, const std::string& label) {
    const std::string unit = parameter.unit;
    const std::string& text =
        text_of(value, unit.empty() ? "expected a whole number" : "expected a whole number in " + unit, label);
    try {
        std::int64_t integer = 0;
        if (unit.empty() || text.find_first_not_of("+-0123456789") == std::string::npos) {
            integer = parse_integer(text);
        } else {
            const double number = parse_quantity(text, unit);
            if (number != std::floor(number) || std::abs(number) > 9007199254740992.0)
                throw UnitError("expected a whole number in " + unit + ", got '" + text + "'");
            integer = static_cast<std::int64_t>(number);
        }
        check_range(parameter, static_cast<double>(integer), unit, value, label);
        return integer;
    } catch (const UnitError& error) {
        throw ValueError(value.where, label, error.what());
    }
}

double read_double(const plr_parameter& parameter, const std::string& unit, const Value& value,
                   const std::string& label) {
    const std::string expected = unit.empty() ? "expected a pure number" : "expected a value in " + unit;
    const std::string& text = text_of(value, expected, label);
    double number = 0;
    try {
        number = parse_quantity(text, unit);
    } catch (const UnitError& error) {
        throw ValueError(value.where, label, error.what());
    }
    check_range(parameter, number, unit, value, label);
    return number;
}

std::string read_string(const Value& value, const std::string& label) {
    return text_of(value, "expected a text", label);
}

std::uint32_t read_choice(const plr_parameter& parameter, const Value& value, const std::string& label) {
    std::vector<std::string> words;
    for (std::uint32_t i = 0; i < parameter.choice_count; ++i) words.emplace_back(parameter.choices[i]);
    const std::string expected = "expected one of " + join(words);
    const std::string& text = text_of(value, expected, label);
    for (std::uint32_t i = 0; i < parameter.choice_count; ++i)
        if (words[i] == text) return i;
    const std::string near = nearest(text, words);
    throw ValueError(value.where, label,
                     expected + ", got '" + text + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

std::string read_path(const Value& value, const std::string& label, const Variables& variables) {
    const std::string& text = text_of(value, "expected a path", label);
    std::string expanded;
    for (std::size_t at = 0; at < text.size();) {
        if (text.compare(at, 2, "${") != 0) {
            expanded += text[at++];
            continue;
        }
        const std::size_t end = text.find('}', at);
        if (end == std::string::npos) throw ValueError(value.where, label, "'${' without '}' in '" + text + "'");
        const std::string name = text.substr(at + 2, end - at - 2);
        const std::optional<std::string> found = variables(name);
        if (!found) throw ValueError(value.where, label, "environment variable " + name + " is not set");
        expanded += *found;
        at = end + 1;
    }
    if (expanded.empty()) throw ValueError(value.where, label, "expected a path, got ''");
    return (value.base / expanded).lexically_normal().string();
}

std::vector<std::string> element_units(const plr_parameter& parameter, std::size_t rows, const Location& where,
                                       const std::string& label) {
    std::vector<std::string> units(1);
    for (const char* c = parameter.unit; *c != '\0'; ++c) {
        if (*c == ',')
            units.emplace_back();
        else if (*c != ' ' || !units.back().empty())
            units.back() += *c;
    }
    try {
        for (const std::string& unit : units)
            if (!parse_unit(unit).is_si()) throw UnitError("'" + unit + "' is not an SI unit");
    } catch (const UnitError& error) {
        throw ValueError(where, label, std::string("the plugin declares a wrong unit: ") + error.what());
    }
    if (units.size() == 1) units.resize(rows, units.front());
    if (units.size() < rows)
        throw ValueError(where, label,
                         "the plugin declares units for " + std::to_string(units.size()) + " elements, there are " +
                             std::to_string(rows));
    return units;
}

}  // namespace pelorus::graph
