/// Single values of a parameter, table column or vector element.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <pelorus/abi/describe.h>

#include "graph/parameters.hpp"
#include "graph/value.hpp"

namespace pelorus::graph {

/// A value that does not fit its description. `label` names it: `legs[2].duration`.
struct ValueError : std::runtime_error {
    ValueError(Location where_, const std::string& label, const std::string& text)
        : std::runtime_error(label + ": " + text), where(std::move(where_)) {}
    Location where;
};

bool read_bool(const Value& value, const std::string& label);
std::int64_t read_integer(const plr_parameter& parameter, const Value& value, const std::string& label);
/// In SI; `unit` is the element's own.
double read_double(const plr_parameter& parameter, const std::string& unit, const Value& value,
                   const std::string& label);
std::string read_string(const Value& value, const std::string& label);
/// The index into the choices.
std::uint32_t read_choice(const plr_parameter& parameter, const Value& value, const std::string& label);
/// Absolute; variables expanded.
std::string read_path(const Value& value, const std::string& label, const Variables& variables);

/// The unit of each of `rows` elements: one for all, or one each, separated by commas. Throws ValueError (a fault of the plugin).
std::vector<std::string> element_units(const plr_parameter& parameter, std::size_t rows, const Location& where,
                                       const std::string& label);

}  // namespace pelorus::graph
