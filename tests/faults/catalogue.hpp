/// The catalogue of faults: what is done, and what the command must say and leave behind.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pelorus::test {

/// One fault. It is tried in a folder of its own, which holds copies of faults/files.
struct FaultCase {
    std::string title;
    std::string of = "first.yaml";                            ///< the file that `change` changes
    std::vector<std::pair<std::string, std::string>> change;  ///< texts that stand there once, and what replaces them
    std::vector<std::pair<std::string, std::string>> files;   ///< name and content of further files
    std::string prepare;                                      ///< shell commands before, which must succeed
    std::string needs;                                        ///< a shell command; where it fails the case is skipped
    std::string command;                                      ///< shell commands
    int exit = 0;                                             ///< their exit code
    std::string prints;                                       ///< on standard error; ${ANY} is any text within a line
    std::string folder = "out";                               ///< the result folder
    std::vector<std::string> leaves;                          ///< files in it afterwards, sorted
    std::map<std::string, std::string> holds;                 ///< file in the case's folder: a text that stands in it
    std::string cure;                                         ///< what the reader is to do; Markdown
};

struct FaultGroup {
    std::string name, about;
    std::vector<FaultCase> cases;
};

/// Reads one file of faults/cases. Throws std::runtime_error naming the file and line of a key that is not known.
FaultGroup read_group(const std::filesystem::path& file);

/// Tries a case; answers what is not as the catalogue says, or "". A case that had to be skipped sets `skipped` to the reason.
std::string try_case(const FaultCase& fault, std::string& skipped);

/// The page docs/errors.md: all groups, in order.
std::string errors_page(const std::vector<FaultGroup>& groups);

}  // namespace pelorus::test
