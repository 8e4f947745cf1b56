/// What every page of help tells, and the man page, which is made from the same.
#pragma once

#include <string>
#include <vector>

#include "cli/command.hpp"

namespace pelorus::cli {

using HelpRows = std::vector<std::vector<std::string>>;  ///< term, explanation

extern const char* const purpose;
const HelpRows& exit_codes();
const HelpRows& environment_variables();
const HelpRows& overview_examples();

/// `run CONFIG`
std::string synopsis(const Command& command);
/// The flags that the grammar has, and --help.
HelpRows flag_rows(const Grammar& grammar);
/// A text whose paragraphs are separated by empty lines.
std::vector<std::string> paragraphs(const std::string& text);

/// All commands as one manual page, in the language of man(7).
std::string man_page();

}  // namespace pelorus::cli
