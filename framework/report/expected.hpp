/// Figures that are known of a config before it is run: `NAME.expected.yaml` beside `NAME.yaml`, and the copy of it in a result folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace pelorus::report {

constexpr const char* expected_file_name = "expected.yaml";  ///< in a result folder

struct Expected {
    std::string text;  ///< of the file
    /// `{config, band: {KIND: x, rounding: x}, cells: [{variant, sweep, scalars: {NAME: {KIND: x}}}]}`, KIND is published, reproduced or limit.
    nlohmann::ordered_json figures;
};

/// `airship.expected.yaml` for `airship.yaml`.
std::filesystem::path expected_file_of(const std::filesystem::path& config);

/// Nothing where there is no such file. Throws ConfigError with all that is wrong in it, Error where it cannot be read.
std::optional<Expected> read_expected(const std::filesystem::path& file);

/// What a summary says beside what was expected of it, in the order of the expected file:
///
///     {"figures": [{variant, sweep, scalar, unit, value, ci95, expected: [{kind, value, deviation, band, within}]}],
///      "judged": 31, "outside": 0}
///
/// A cell is found by its variant and its sweep; what the summary does not have is left out. `deviation` is relative. `within` is null
/// where the file states no band; of a `limit` it says whether the value is at most that. `summary` is the document of summary.json.
nlohmann::ordered_json beside_expected(const nlohmann::ordered_json& summary, const nlohmann::ordered_json& figures);

}  // namespace pelorus::report
