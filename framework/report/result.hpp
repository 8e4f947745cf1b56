/// A result folder, read back.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "report/expected.hpp"

namespace pelorus::report {

struct Result {
    std::filesystem::path folder;
    nlohmann::ordered_json summary;
    nlohmann::ordered_json provenance, timing;  ///< null where the folder has none
    std::optional<Expected> expected;

    /// The title of the config, or the name of the folder.
    std::string title() const;
};

/// Throws Error: `folder` is none, or has no summary.json (Exit::misuse); a file is damaged, which is told with the place (Exit::run_failed).
/// Throws ConfigError for an expected.yaml that is wrong.
Result read_result(const std::filesystem::path& folder);

/// One JSON file. Null where there is none. Throws Error (Exit::run_failed) with line and column.
nlohmann::ordered_json read_json(const std::filesystem::path& file);

/// Whether the runs of two results have the same random numbers: the same seed, and as many runs.
bool have_same_runs(const Result& a, const Result& b);

}  // namespace pelorus::report
