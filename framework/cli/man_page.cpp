// `pelorus help --man`: the pages of help as a manual page.
#include "cli/help.hpp"

namespace pelorus::cli {

namespace {

/// As roff shows it unchanged: a `-` is one that can be copied, and no line begins with a request.
std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else if (c == '\'')
            out += "\\(aq";
        else
            out += c == '\n' ? ' ' : c;
    }
    return !out.empty() && out.front() == '.' ? "\\&" + out : out;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }

std::string terms(const HelpRows& rows) {
    std::string text;
    for (const std::vector<std::string>& row : rows) text += ".TP\n" + bold(row[0]) + "\n" + escaped(row[1]) + "\n";
    return text;
}

std::string command_text(const Command& command) {
    std::string text = ".SS \"pelorus " + escaped(synopsis(command)) + "\"\n" + escaped(command.summary) + ".\n";
    for (const std::string& paragraph : paragraphs(command.about)) text += ".PP\n" + escaped(paragraph) + "\n";
    HelpRows flags = flag_rows(command.grammar);
    flags.pop_back();  // --help stands under OPTIONS
    return text + terms(flags) + ".PP\nExamples:\n" + terms(command.examples);
}

}  // namespace

std::string man_page() {
    std::string text = std::string(".TH PELORUS 1 \"\" \"Pelorus " PELORUS_VERSION "\" \"Pelorus\"\n") +
                       ".SH NAME\npelorus \\- " + purpose +
                       "\n.SH SYNOPSIS\n\\fBpelorus\\fR \\fICOMMAND\\fR [\\fIARGUMENTS\\fR] [\\fIFLAGS\\fR]\n"
                       ".SH DESCRIPTION\nResults go to standard output or to files, everything else (progress, log, "
                       "errors) to standard error.\n.SH OPTIONS\n" +
                       terms({{"-h, --help", "tells all commands; after a command: explains it, with examples"},
                              {"--version", "version of command and ABI"}}) +
                       ".SH COMMANDS\n";
    for (const Command& command : commands()) text += command_text(command);
    return text + ".SH EXIT STATUS\n" + terms(exit_codes()) + ".SH ENVIRONMENT\n" + terms(environment_variables()) +
           ".SH EXAMPLES\n" + terms(overview_examples());
}

}  // namespace pelorus::cli
