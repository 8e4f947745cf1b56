#include "cli/command_line.hpp"

#include <charconv>
#include <limits>

#include <boost/program_options.hpp>
#include <fmt/format.h>

#include "host/error.hpp"

namespace pelorus::cli {

namespace {

namespace options = boost::program_options;

[[noreturn]] void refuse(const std::string& line) { throw Error(Exit::misuse, line); }

options::options_description described(const Grammar& grammar) {
    options::options_description all;
    all.add_options()("help,h", "");
    const auto add = [&all](const std::string& name, bool takes_value) {
        if (takes_value)
            all.add_options()(name.c_str(), options::value<std::vector<std::string>>(), "");
        else
            all.add_options()(name.c_str(), "");
    };
    for (const Flag& flag : grammar.flags) add(flag.name, !flag.value.empty());
    for (const AbsentFlag& flag : grammar.absent) add(flag.name, !flag.value.empty());
    return all;
}

std::string unknown_flag(const std::string& command, const Grammar& grammar, const std::string& word) {
    std::vector<std::string> known{"--help"};
    for (const Flag& flag : grammar.flags) known.push_back("--" + flag.name);
    const std::string near = nearest(word, known);
    return fmt::format("{}: unknown flag {}{}", command, word,
                       near.empty() ? "; see: pelorus help " + command : "; did you mean " + near + "?");
}

/// `--out` at the end of the line, and the like.
std::string missing_value(const std::string& command, const Grammar& grammar,
                          const options::invalid_command_line_syntax& problem) {
    for (const Flag& flag : grammar.flags)
        if (problem.kind() == options::invalid_command_line_syntax::missing_parameter &&
            "--" + flag.name == problem.get_option_name())
            return fmt::format("{}: --{}: {} is missing; usage: --{} {}", command, flag.name, flag.value, flag.name,
                               flag.value);
    return command + ": " + problem.what();
}

std::string usage(const std::string& command, const Grammar& grammar) {
    std::string text = "pelorus " + command;
    for (const std::string& argument : grammar.arguments) text += " " + argument;
    return text + (grammar.last_repeats ? "..." : "");
}

/// Why there may be an argument too many: `--set world.period 2s` for `--set world.period=2s`, or a value in two words.
std::string left_over_hint(const CommandLine& line, const Grammar& grammar) {
    for (const Flag& flag : grammar.flags) {
        if (flag.value.find('=') == std::string::npos) continue;
        for (const std::string& value : line.values(flag.name))
            if (value.find('=') == std::string::npos)
                return fmt::format("--{} takes {}, joined by '='; it got '{}'", flag.name, flag.value, value);
    }
    return "quote a value that has a blank";
}

/// Words to flags and arguments, each as often and in the order in which it was given.
std::vector<options::option> split(const std::string& command, const Grammar& grammar,
                                   const std::vector<std::string>& words) {
    namespace style = options::command_line_style;
    try {
        return options::command_line_parser(words)
            .options(described(grammar))
            .style(style::allow_long | style::long_allow_adjacent | style::long_allow_next | style::allow_short |
                   style::allow_dash_for_short | style::short_allow_next)
            .run()
            .options;
    } catch (const options::unknown_option& problem) {
        refuse(unknown_flag(command, grammar, problem.get_option_name()));
    } catch (const options::invalid_command_line_syntax& problem) {
        refuse(missing_value(command, grammar, problem));
    } catch (const options::error& problem) {
        refuse(command + ": " + problem.what());
    }
}

}  // namespace

CommandLine CommandLine::parse(const std::string& command, const Grammar& grammar,
                               const std::vector<std::string>& words) {
    CommandLine line;
    for (const options::option& option : split(command, grammar, words)) {
        if (option.string_key.empty())
            line.arguments_.insert(line.arguments_.end(), option.value.begin(), option.value.end());
        else {
            std::vector<std::string>& values = line.flags_[option.string_key];
            values.insert(values.end(), option.value.begin(), option.value.end());
        }
    }
    if (line.wants_help()) return line;
    for (const AbsentFlag& flag : grammar.absent)
        if (line.has(flag.name)) refuse(fmt::format("{}: --{} {}", command, flag.name, flag.reason));
    for (const Flag& flag : grammar.flags)
        if (!flag.repeats && line.values(flag.name).size() > 1)
            refuse(fmt::format("{}: --{} is given more than once", command, flag.name));
    const bool has_none = !grammar.without_arguments.empty() && line.has(grammar.without_arguments);
    const std::size_t wanted = has_none ? 0 : grammar.arguments.size();
    if (line.arguments_.size() < wanted)
        refuse(fmt::format("{}: {} is missing; usage: {}", command, grammar.arguments[line.arguments_.size()],
                           usage(command, grammar)));
    if (line.arguments_.size() > wanted && !grammar.last_repeats)
        refuse(fmt::format("{}: unexpected argument '{}' ({}); usage: {}", command, line.arguments_[wanted],
                           left_over_hint(line, grammar), usage(command, grammar)));
    return line;
}

std::string CommandLine::value(const std::string& flag, const std::string& otherwise) const {
    const auto found = flags_.find(flag);
    return found == flags_.end() ? otherwise : found->second.front();
}

std::vector<std::string> CommandLine::values(const std::string& flag) const {
    const auto found = flags_.find(flag);
    return found == flags_.end() ? std::vector<std::string>() : found->second;
}

std::uint64_t CommandLine::number(const std::string& flag, std::uint64_t otherwise, std::uint64_t most,
                                  std::uint64_t least) const {
    if (!has(flag)) return otherwise;
    const std::string text = value(flag);
    std::uint64_t number = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (problem != std::errc() || end != text.data() + text.size() || number > most || number < least) {
        const bool is_any = most == std::numeric_limits<std::uint64_t>::max();
        refuse(fmt::format("--{}: expected a whole number from {} to {}, got '{}'", flag, least,
                           is_any ? "2^64 - 1" : std::to_string(most), text));
    }
    return number;
}

}  // namespace pelorus::cli
