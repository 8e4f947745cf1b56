/// JSON documents as files that are either whole or not there.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace pelorus::report {

/// For people to read: objects and lists of structured values one entry a line, everything flat on a line of its own.
/// Numbers have the fewest digits that read back to the same double. Text that is not UTF-8 is repaired with U+FFFD.
std::string json_text(const nlohmann::ordered_json& document);

/// Writes beside the file, then renames. Throws Error (Exit::run_failed) with the path and the system's reason; the
/// file is then as before and nothing is left beside it.
void write_file(const std::filesystem::path& file, const std::string& text);

}  // namespace pelorus::report
