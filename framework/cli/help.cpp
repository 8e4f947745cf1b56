// The pages of `pelorus help`, made from the commands' own descriptions.
#include "cli/help.hpp"

#include <algorithm>

#include "cli/output.hpp"

namespace pelorus::cli {

namespace {

std::string section(const std::string& heading, const std::string& text) { return "\n" + heading + "\n" + text; }

std::string about(const Command& command) {
    std::string text;
    for (const std::string& paragraph : paragraphs(command.about)) text += "\n" + wrapped(paragraph, 0);
    return text;
}

}  // namespace

const char* const purpose = "runs tracking pipelines that are made of plugins";

const HelpRows& exit_codes() {
    static const HelpRows rows{{"0", "done"},
                               {"1", "the run failed or was stopped, or a file could not be written"},
                               {"2", "the command line or the config is wrong; every line says what and where"}};
    return rows;
}

const HelpRows& environment_variables() {
    static const HelpRows rows{
        {"PELORUS_PLUGIN_PATH", "folders with plugins, separated by colons; searched after --plugins DIR"},
        {"PELORUS_DATA", "folder with recordings, which configs name as ${PELORUS_DATA}"}};
    return rows;
}

const HelpRows& overview_examples() {
    static const HelpRows rows{
        {"pelorus run configs/airship.yaml", "run a pipeline, print its figures"},
        {"pelorus inspect configs/airship.yaml", "what it is made of, and what flows through it"},
        {"pelorus list --kind motion", "which motion models there are"},
        {"pelorus inspect ID", "what one of them does and takes"},
        {"pelorus new motion drag", "begin a motion model of your own in ./drag"},
        {"pelorus conform build/motion/drag.so", "whether it keeps the contract and the laws of its kind"}};
    return rows;
}

std::string synopsis(const Command& command) {
    std::string text = command.name;
    for (const std::string& argument : command.grammar.arguments) text += " " + argument;
    if (command.grammar.last_repeats) text += "...";
    return text;
}

HelpRows flag_rows(const Grammar& grammar) {
    HelpRows rows;
    for (const Flag& flag : grammar.flags)
        rows.push_back({"--" + flag.name + (flag.value.empty() ? "" : " " + flag.value),
                        flag.doc + (flag.repeats ? "; may be given several times" : "")});
    rows.push_back({"-h, --help", "this page"});
    return rows;
}

std::vector<std::string> paragraphs(const std::string& text) {
    std::vector<std::string> found;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find("\n\n", begin), text.size());
        found.push_back(text.substr(begin, end - begin));
        begin = end + 2;
    }
    return found;
}

std::string overview() {
    HelpRows rows;
    for (const Command& command : commands()) rows.push_back({synopsis(command), command.summary});
    rows.push_back({"help COMMAND", "more about a command, with examples"});
    return std::string("pelorus ") + purpose + "\n\nusage: pelorus COMMAND [ARGUMENTS] [FLAGS]\n" +
           section("commands", aligned(rows, 2)) + section("examples", aligned(overview_examples(), 2)) +
           section("flags", aligned({{"-h, --help", "this page"}, {"--version", "version of command and ABI"}}, 2)) +
           section("exit codes", aligned(exit_codes(), 2)) +
           section("environment variables", aligned(environment_variables(), 2));
}

std::string help_page(const Command& command) {
    return "usage: pelorus " + synopsis(command) + " [FLAGS]\n" + about(command) +
           section("flags", aligned(flag_rows(command.grammar), 2)) +
           section("examples", aligned(command.examples, 2)) + section("exit codes", aligned(exit_codes(), 2)) +
           section("environment variables", aligned(environment_variables(), 2));
}

}  // namespace pelorus::cli
