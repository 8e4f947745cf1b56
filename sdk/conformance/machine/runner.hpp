/// Runs checks on a library, each in a process of its own, and tells what came of them.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "child.hpp"

namespace pelorus::conformance {

struct Options {
    std::filesystem::path library;   ///< absolute
    std::vector<std::string> kinds;  ///< plugins of these kinds alone; empty: all
    std::vector<std::string> only;   ///< these checks and what they rest on; empty: all of the level
    int level = 3;
    std::uint64_t seed = 1;
    std::filesystem::path subjects;           ///< file of subjects, or empty
    std::filesystem::path json, junit;        ///< files to write, `-` for standard output; empty: none
    unsigned jobs = 0;                        ///< processes at once; 0: one a core
    double time_limit = 20;                   ///< s of processor time, of each check
    bool is_quiet = false;                    ///< tell what did not pass, and the sum, alone
    std::vector<std::string> repeat;          ///< what a command that repeats a check has besides `--only NAME`
    const std::atomic<bool>* stop = nullptr;  ///< once it is set, what is not done is skipped
};

/// One check of one plugin (or of the library: plugin "").
struct Result {
    const Check* check = nullptr;
    std::string plugin, kind;
    Outcome outcome;
    std::string repeat;  ///< the command that repeats it
};

struct Report {
    std::filesystem::path library;
    std::uint64_t seed = 1;
    int level = 3;
    std::vector<Result> results;
    double seconds = 0;
    bool was_interrupted = false;
    bool is_well() const;  ///< every plugin was tried, and nothing failed, crashed or hung
};

/// Throws Refused where nothing can be tried: no such file, no such check, no plugin of that kind.
Report run_checks(const Host& host, const Options& options);

/// Names of the checks that run_checks would make, a line each. Throws Refused like it.
std::string selected_names(const Host& host, const Options& options);

/// Names of what a check rests on, its group's common prerequisites included.
std::vector<std::string> prerequisites_of(const Check& check);

std::string text_report(const Report& report, bool is_quiet);
std::string json_report(const Report& report);
std::string junit_report(const Report& report);
/// What json_report wrote, of these checks alone if any are named. Throws Refused where it is no such report, or has no such check.
Report read_report(const std::string& json, const std::vector<std::string>& only);
/// All checks with their laws: as text, and as JSON.
std::string text_list();
std::string json_list();

}  // namespace pelorus::conformance
