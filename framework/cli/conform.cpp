// `pelorus conform`: the conformance suites on one library, in the executable beside this one.
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <boost/dll/runtime_symbol_info.hpp>

#include "cli/command.hpp"
#include "cli/conform_grammar.hpp"
#include "host/error.hpp"

namespace pelorus::cli {

namespace {

/// Becomes pelorus-conform: it has to be the process that plugins are loaded into, see framework/conform/main.cpp.
int conform(const CommandLine& line) {
    const std::string runner = (boost::dll::program_location().parent_path() / "pelorus-conform").string();
    std::vector<std::string> words{runner};
    for (const Flag& flag : conform_grammar().flags)
        for (const std::string& value :
             line.has(flag.name) && flag.value.empty() ? std::vector<std::string>{""} : line.values(flag.name))
            words.push_back("--" + flag.name + (flag.value.empty() ? "" : "=" + value));
    if (!line.has("list")) words.push_back(line.argument(0));
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(runner.c_str(), arguments.data());
    throw Error(Exit::run_failed, "conform: " + runner + ": " + std::strerror(errno));
}

}  // namespace

Command conform_command() {
    return {
        "conform",
        "the conformance suites on the plugins of one library",
        "Tries whether the plugins of a library keep the contract of the plugin ABI and the laws of their kind: "
        "whether a Jacobian is the derivative, a covariance stays positive, one track of a batch comes out as it "
        "would alone, saved state comes back. Each check runs in a process of its own, so a crash or an endless "
        "loop is a verdict like any other. What fails is told with the place in the plugin's source where that can "
        "be seen (build with -g), and with the command that repeats it.\n\n"
        "Each plugin is tried with its defaults and with each other choice of its parameters, one at a time; a file "
        "of subjects (--subjects) names others, and the parts for its slots.\n\n"
        "Exit code 0: everything holds; 1: something does not; 2: nothing could be tried.",
        conform_grammar(),
        {{"pelorus conform build/drag.so", "a plugin that was just built, levels 1 to 3"},
         {"pelorus conform build/drag.so --only motion-jacobian-is-derivative --seed 7", "one check, other samples"},
         {"pelorus conform --list", "all checks, with the laws that they try"}},
        &conform};
}

}  // namespace pelorus::cli
