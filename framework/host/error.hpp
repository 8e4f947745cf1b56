/// Errors of the host. Every one is a line that says what is wrong, where, and what was expected.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace pelorus {

/// A place in a config file, or on the command line (file "--set world.period=..", line 0).
struct Location {
    std::string file;
    int line;    ///< from 1; 0: not in a file
    int column;  ///< from 1

    // Not an aggregate: GCC 12 warns of uninitialised members in nested `{}` at -O3, wrongly.
    Location(std::string in_file = {}, int at_line = 0, int at_column = 0)
        : file(std::move(in_file)), line(at_line), column(at_column) {}

    /// `file:line:column`, `file`, or "" where nothing is known.
    std::string text() const;
};

/// What the process answers when the error reaches main().
enum class Exit { done = 0, run_failed = 1, misuse = 2 };

class Error : public std::runtime_error {
public:
    Error(Exit exit, const std::string& line) : std::runtime_error(line), exit_(exit) {}
    Exit exit() const noexcept { return exit_; }

private:
    Exit exit_;
};

/// One or several things wrong with a config (or the command line): all that could be found in one pass.
class ConfigError : public Error {
public:
    struct Item {
        Location where;
        std::string text;
    };
    explicit ConfigError(std::vector<Item> items);
    const std::vector<Item>& items() const noexcept { return items_; }

private:
    std::vector<Item> items_;
};

/// The nearest of `candidates` to a misspelt word (Damerau-Levenshtein distance at most a third), else the only one that begins
/// with it (three letters or more), or "".
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace pelorus
