/// The arguments of one subcommand, read by its grammar (with Boost.Program_options).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace pelorus::cli {

struct Flag {
    std::string name;   ///< without dashes
    std::string value;  ///< what it takes, as help shows it (`DIR`); "" : nothing
    std::string doc;    ///< one sentence
    bool repeats = false;
};

/// A flag that belongs to the command but not to this version.
struct AbsentFlag {
    std::string name, value, reason;
};

struct Grammar {
    std::vector<std::string> arguments;  ///< `CONFIG`; each is required
    std::vector<Flag> flags;
    std::vector<AbsentFlag> absent;
    std::string without_arguments = {};  ///< a flag with which no argument is wanted, or ""
    bool last_repeats = false;           ///< the last argument may be given several times
};

class CommandLine {
public:
    /// `words` follow the subcommand's name. --help is understood by all. Throws Error (Exit::misuse) for the first thing wrong.
    static CommandLine parse(const std::string& command, const Grammar& grammar, const std::vector<std::string>& words);

    bool wants_help() const { return has("help"); }
    const std::string& argument(std::size_t index) const { return arguments_[index]; }
    const std::vector<std::string>& arguments() const { return arguments_; }
    bool has(const std::string& flag) const { return flags_.count(flag) != 0; }
    /// Of a flag that does not repeat.
    std::string value(const std::string& flag, const std::string& otherwise = {}) const;
    std::vector<std::string> values(const std::string& flag) const;
    /// A whole number from `least` to `most`; `otherwise` where the flag is not given. Throws Error (Exit::misuse).
    std::uint64_t number(const std::string& flag, std::uint64_t otherwise, std::uint64_t most,
                         std::uint64_t least = 0) const;

private:
    std::vector<std::string> arguments_;
    std::map<std::string, std::vector<std::string>> flags_;
};

}  // namespace pelorus::cli
