/// The subcommands of `pelorus`, each described once: its help is made from this.
#pragma once

#include <string>
#include <vector>

#include "cli/command_line.hpp"

namespace pelorus::cli {

struct Command {
    std::string name;
    std::string summary;  ///< a few words
    std::string about;    ///< paragraphs, separated by empty lines
    Grammar grammar;
    std::vector<std::vector<std::string>> examples;  ///< command, what it does
    /// Answers the process's exit code. Throws Error, OutputClosed.
    int (*run)(const CommandLine& line) = nullptr;
};

Command run_command();
Command merge_command();
Command report_command();
Command compare_command();
Command check_command();
Command list_command();
Command inspect_command();
Command new_command();
Command schema_command();
Command completion_command();
Command conform_command();

/// In the order in which help lists them.
const std::vector<Command>& commands();

/// The page of `pelorus --help`.
std::string overview();
/// The page of `pelorus help COMMAND`.
std::string help_page(const Command& command);

/// What main() does: finds the command, runs it, tells errors on standard error. Answers the exit code. Throws nothing.
int run_command_line(const std::vector<std::string>& words) noexcept;

}  // namespace pelorus::cli
