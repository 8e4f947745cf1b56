#include "cli/expected.hpp"

#include "cli/output.hpp"
#include "report/expected_table.hpp"

namespace pelorus::cli {

std::optional<report::Expected> read_expected_of_config(const CommandLine& line) {
    const std::filesystem::path file = report::expected_file_of(line.argument(0));
    std::optional<report::Expected> expected = report::read_expected(file);
    if (!expected || line.has("run")) return std::nullopt;
    if (line.has("set")) {
        tell("--set makes another config of it: the figures of " + file.string() + " are left aside");
        return std::nullopt;
    }
    return expected;
}

std::string tell_beside_expected(const std::optional<report::Expected>& expected, const nlohmann::ordered_json& summary,
                                 nlohmann::ordered_json* json) {
    if (!expected) return "";
    const nlohmann::ordered_json beside = report::beside_expected(summary, expected->figures);
    if (json != nullptr) (*json)["expected"] = beside;
    return report::expected_table(beside);
}

}  // namespace pelorus::cli
