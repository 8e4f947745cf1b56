#include "cli/command.hpp"

#include <algorithm>
#include <exception>

#include <fmt/format.h>
#include <pelorus/abi/threads.h>

#include "cli/output.hpp"
#include "host/error.hpp"

namespace pelorus::cli {

namespace {

/// Commands that the design names and this version does not have.
const std::vector<std::string> later_commands = {"conform", "report", "compare"};

const Command* find_command(const std::string& name) {
    const auto found =
        std::find_if(commands().begin(), commands().end(), [&](const Command& c) { return c.name == name; });
    return found == commands().end() ? nullptr : &*found;
}

const Command& require_command(const std::string& name) {
    if (const Command* command = find_command(name)) return *command;
    if (std::find(later_commands.begin(), later_commands.end(), name) != later_commands.end())
        throw Error(Exit::misuse, name + ": not in this version");
    std::vector<std::string> names{"help"};
    for (const Command& command : commands()) names.push_back(command.name);
    const std::string near = nearest(name, names);
    const std::string what = !name.empty() && name[0] == '-' ? "flag" : "command";
    throw Error(Exit::misuse, fmt::format("unknown {} '{}'; {}", what, name,
                                          near.empty() ? "see: pelorus --help" : "did you mean '" + near + "'?"));
}

int help(const std::vector<std::string>& topics) {
    if (topics.size() > 1) throw Error(Exit::misuse, "help: one command at a time, got '" + topics[1] + "' as well");
    print(topics.empty() || topics[0] == "help" ? overview() : help_page(require_command(topics[0])));
    return static_cast<int>(Exit::done);
}

int dispatch(const std::vector<std::string>& words) {
    if (words.empty()) {
        tell_raw(overview());
        return static_cast<int>(Exit::misuse);
    }
    const std::string& first = words[0];
    const std::vector<std::string> rest(words.begin() + 1, words.end());
    if (first == "--help" || first == "-h" || first == "help") return help(rest);
    if (first == "--version") {
        if (!rest.empty()) throw Error(Exit::misuse, "--version: unexpected argument '" + rest[0] + "'");
        print(fmt::format("pelorus {} (plugin ABI {}.{})\n", PELORUS_VERSION, PLR_ABI_MAJOR, PLR_ABI_MINOR));
        return static_cast<int>(Exit::done);
    }
    const Command& command = require_command(first);
    const CommandLine line = CommandLine::parse(command.name, command.grammar, rest);
    if (!line.wants_help()) return command.run(line);
    print(help_page(command));
    return static_cast<int>(Exit::done);
}

}  // namespace

const std::vector<Command>& commands() {
    static const std::vector<Command> all = {run_command(),     check_command(), list_command(),
                                             inspect_command(), new_command(),   schema_command()};
    return all;
}

int run_command_line(const std::vector<std::string>& words) noexcept {
    try {
        return dispatch(words);
    } catch (const OutputClosed&) {
        return static_cast<int>(Exit::run_failed);
    } catch (const ConfigError& problem) {
        tell_raw(std::string(problem.what()) + "\n");  // a line each, which begins with its place
        return static_cast<int>(problem.exit());
    } catch (const Error& problem) {
        tell(problem.what());
        return static_cast<int>(problem.exit());
    } catch (const std::bad_alloc&) {
        tell_raw("pelorus: out of memory\n");
    } catch (const std::exception& problem) {
        tell(std::string("unexpected error: ") + problem.what());
    } catch (...) {
        tell_raw("pelorus: unexpected error of an unknown kind\n");
    }
    return static_cast<int>(Exit::run_failed);
}

}  // namespace pelorus::cli
