/// What belongs to the whole process, and what a plugin must therefore leave as it found it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pelorus::conformance {

std::size_t thread_count();
std::size_t open_file_count();
/// Bytes that have gone to standard output and standard error.
std::size_t bytes_written_to_terminal();

/// Settings of the process, each by name: floating point, signals, locale, folder, environment.
struct Setting {
    std::string name, value;
};
std::vector<Setting> process_settings();

}  // namespace pelorus::conformance
