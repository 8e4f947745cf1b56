// The pages of `pelorus help`, made from the commands' own descriptions.
#include <sstream>

#include "cli/command.hpp"
#include "cli/output.hpp"

namespace pelorus::cli {

namespace {

using Rows = std::vector<std::vector<std::string>>;

const Rows exit_codes = {{"0", "done"},
                         {"1", "the run failed or was stopped, or a file could not be written"},
                         {"2", "the command line or the config is wrong; every line says what and where"}};

const Rows variables = {
    {"PELORUS_PLUGIN_PATH", "folders with plugins, separated by colons; searched after --plugins DIR"},
    {"PELORUS_DATA", "folder with recordings, which configs name as ${PELORUS_DATA}"}};

std::string synopsis(const Command& command) {
    std::string text = command.name;
    for (const std::string& argument : command.grammar.arguments) text += " " + argument;
    return text;
}

std::string section(const std::string& heading, const std::string& text) { return "\n" + heading + "\n" + text; }

std::string paragraphs(const std::string& text) {
    std::string out, line, paragraph;
    std::istringstream lines(text);
    const auto end_paragraph = [&] {
        if (!paragraph.empty()) out += "\n" + wrapped(paragraph, 0);
        paragraph.clear();
    };
    while (std::getline(lines, line)) {
        if (line.empty()) end_paragraph();
        paragraph += " " + line;
        if (line.empty()) paragraph.clear();
    }
    end_paragraph();
    return out;
}

std::string flags_of(const Grammar& grammar) {
    Rows rows;
    for (const Flag& flag : grammar.flags)
        rows.push_back({"--" + flag.name + (flag.value.empty() ? "" : " " + flag.value),
                        flag.doc + (flag.repeats ? "; may be given several times" : "")});
    rows.push_back({"-h, --help", "this page"});
    return aligned(rows, 2);
}

}  // namespace

std::string overview() {
    Rows rows;
    for (const Command& command : commands()) rows.push_back({synopsis(command), command.summary});
    rows.push_back({"help COMMAND", "more about a command, with examples"});
    return "pelorus runs tracking pipelines that are made of plugins\n\n"
           "usage: pelorus COMMAND [ARGUMENTS] [FLAGS]\n" +
           section("commands", aligned(rows, 2)) +
           section("examples", aligned({{"pelorus run configs/airship.yaml", "run a pipeline, print its figures"},
                                        {"pelorus list --kind motion", "which motion models there are"},
                                        {"pelorus inspect ID", "what one of them does and takes"},
                                        {"pelorus new motion drag", "begin a motion model of your own in ./drag"}},
                                       2)) +
           section("flags", aligned({{"-h, --help", "this page"}, {"--version", "version of command and ABI"}}, 2)) +
           section("exit codes", aligned(exit_codes, 2)) + section("environment variables", aligned(variables, 2));
}

std::string help_page(const Command& command) {
    return "usage: pelorus " + synopsis(command) + " [FLAGS]\n" + paragraphs(command.about) +
           section("flags", flags_of(command.grammar)) + section("examples", aligned(command.examples, 2)) +
           section("exit codes", aligned(exit_codes, 2)) + section("environment variables", aligned(variables, 2));
}

}  // namespace pelorus::cli
