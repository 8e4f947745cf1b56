/// Figures that are expected of a config, at the command line.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "cli/command_line.hpp"
#include "report/expected.hpp"

namespace pelorus::cli {

/// Those beside the config that is the first argument. None where the command line makes another config of it (--set, which is told) or
/// asks for one run alone (--run): what is known of the one holds for the other no more. Throws ConfigError.
std::optional<report::Expected> read_expected_of_config(const CommandLine& line);

/// The table that is printed below a result; "" without expected figures. Puts the comparison into `json`, unless that is null.
std::string tell_beside_expected(const std::optional<report::Expected>& expected, const nlohmann::ordered_json& summary,
                                 nlohmann::ordered_json* json);

}  // namespace pelorus::cli
