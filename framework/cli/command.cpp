#include "cli/command.hpp"

#include <algorithm>
#include <charconv>
#include <exception>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pelorus/abi/threads.h>

#include "cli/completion/candidates.hpp"
#include "cli/help.hpp"
#include "cli/output.hpp"
#include "host/error.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;

const Command* find_command(const std::string& name) {
    const auto found =
        std::find_if(commands().begin(), commands().end(), [&](const Command& c) { return c.name == name; });
    return found == commands().end() ? nullptr : &*found;
}

const Command& require_command(const std::string& name) {
    if (const Command* command = find_command(name)) return *command;
    std::vector<std::string> names{"help"};
    for (const Command& command : commands()) names.push_back(command.name);
    const std::string near = nearest(name, names);
    const std::string what = !name.empty() && name[0] == '-' ? "flag" : "command";
    throw Error(Exit::misuse, fmt::format("unknown {} '{}'; {}", what, name,
                                          near.empty() ? "see: pelorus --help" : "did you mean '" + near + "'?"));
}

int help(const std::vector<std::string>& topics) {
    if (topics == std::vector<std::string>{"--man"}) {
        print(man_page());
        return static_cast<int>(Exit::done);
    }
    if (topics.size() > 1) throw Error(Exit::misuse, "help: one command at a time, got '" + topics[1] + "' as well");
    print(topics.empty() || topics[0] == "help" ? overview() : help_page(require_command(topics[0])));
    return static_cast<int>(Exit::done);
}

/// Whoever asked for JSON gets it when the command fails as well.
void print_error(const std::vector<std::string>& words, const Error& problem) {
    if (std::find(words.begin(), words.end(), "--json") == words.end()) return;
    Json problems = Json::array();
    if (const auto* config = dynamic_cast<const ConfigError*>(&problem))
        for (const ConfigError::Item& item : config->items())
            problems.push_back({{"file", item.where.file},
                                {"line", item.where.line},
                                {"column", item.where.column},
                                {"message", item.text}});
    const std::string text = problem.what();
    try {
        print_json({{"error", text.substr(0, text.find('\n'))},
                    {"exit", static_cast<int>(problem.exit())},
                    {"problems", std::move(problems)}});
    } catch (...) {  // nobody reads it: the lines on standard error and the exit code have said it
        return;
    }
}

/// `complete AT WORD...`, which the script of `pelorus completion` calls; nobody types it.
int complete(const std::vector<std::string>& words) {
    std::size_t at = 0;
    const std::string place = words.empty() ? "" : words[0];
    const auto [end, problem] = std::from_chars(place.data(), place.data() + place.size(), at);
    if (problem != std::errc() || end != place.data() + place.size() || place.empty())
        throw Error(Exit::misuse, "complete: expected the number of a word and the words of a command line");
    std::string text;
    for (const std::string& candidate : candidates({words.begin() + 1, words.end()}, at)) text += candidate + "\n";
    print(text);
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
        if (rest == std::vector<std::string>{"--json"}) {
            print_json({{"version", PELORUS_VERSION}, {"abi", {{"major", PLR_ABI_MAJOR}, {"minor", PLR_ABI_MINOR}}}});
            return static_cast<int>(Exit::done);
        }
        if (!rest.empty()) throw Error(Exit::misuse, "--version: unexpected argument '" + rest[0] + "'");
        print(fmt::format("pelorus {} (plugin ABI {}.{})\n", PELORUS_VERSION, PLR_ABI_MAJOR, PLR_ABI_MINOR));
        return static_cast<int>(Exit::done);
    }
    if (first == "complete") return complete(rest);
    const Command& command = require_command(first);
    const CommandLine line = CommandLine::parse(command.name, command.grammar, rest);
    if (!line.wants_help()) return command.run(line);
    print(help_page(command));
    return static_cast<int>(Exit::done);
}

}  // namespace

const std::vector<Command>& commands() {
    static const std::vector<Command> all = {
        run_command(),     merge_command(), report_command(),  compare_command(), check_command(),     list_command(),
        inspect_command(), new_command(),   conform_command(), schema_command(),  completion_command()};
    return all;
}

int run_command_line(const std::vector<std::string>& words) noexcept {
    try {
        return dispatch(words);
    } catch (const OutputClosed&) {
        return static_cast<int>(Exit::run_failed);
    } catch (const ConfigError& problem) {
        tell_raw(std::string(problem.what()) + "\n");  // a line each, which begins with its place
        print_error(words, problem);
        return static_cast<int>(problem.exit());
    } catch (const Error& problem) {
        tell(problem.what());
        print_error(words, problem);
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
