/// Results go to standard output, talk to standard error.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace pelorus::cli {

/// Whoever read standard output has gone (`pelorus list | head -1`): nobody is left to complain to.
struct OutputClosed {};

/// Gives standard input, output and error something to refer to where the caller closed them: otherwise the first file that is
/// opened would get their number, and results would be written into it. A closed pipe becomes an error instead of a signal.
void prepare_streams();

/// Writes to standard output at once. Throws OutputClosed, or Error (Exit::run_failed) with the system's reason.
void print(const std::string& text);

/// The same, of JSON: indented, with a line end; bytes that are no UTF-8 are replaced.
void print_json(const nlohmann::ordered_json& json);

/// One line to standard error, `pelorus: LINE`.
void tell(const std::string& line);

/// Text to standard error as it is.
void tell_raw(const std::string& text);

/// Whether somebody looks at standard error while it is written.
bool error_is_terminal();

/// Rows with aligned columns (the last one ragged), each line after `indent` blanks. Cells too many or too few are no problem.
std::string aligned(const std::vector<std::vector<std::string>>& rows, std::size_t indent = 0);

/// A paragraph broken at blanks into lines of at most 100 characters, each after `indent` blanks.
std::string wrapped(const std::string& paragraph, std::size_t indent);

}  // namespace pelorus::cli
