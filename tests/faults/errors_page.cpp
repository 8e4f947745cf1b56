#include <sstream>

#include "catalogue.hpp"

namespace pelorus::test {

namespace {

const char* const head =
    R"(# Errors, and what to do about them

Every fault that the tests provoke on purpose: what is done, what is printed on standard error, which exit code comes of it, and the way out. Most of
them are provoked in one of two small configs, [first.yaml](../tests/faults/files/first.yaml), a simulated radar, and
[recorded.yaml](../tests/faults/files/recorded.yaml), a recording. What one fault is about is all that is changed there.

This page is made from the catalogue in `tests/faults/cases`, which the tests run; do not edit it here. `${DIR}` is the folder that the command runs
in, `${BUILD}` the build's, `${ANY}` any text.

Exit codes: 0 done, 1 the run failed or was stopped, 2 the command line or the config is wrong.
)";

std::string anchor(const std::string& title) {
    std::string text;
    for (const char c : title)
        if (c == ' ')
            text += '-';
        else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_')
            text += c;
        else if (c >= 'A' && c <= 'Z')
            text += static_cast<char>(c - 'A' + 'a');
    return text;
}

/// A block of the page. The documentation's own test passes it over: the catalogue is tried here.
std::string block(const std::string& text) {
    return "```text\n" + text + (text.empty() || text.back() == '\n' ? "" : "\n") + "```\n";
}

/// A text in backticks of its own, which may span lines.
std::string code(const std::string& text) {
    return text.find('\n') == std::string::npos ? "`" + text + "`" : "\n\n" + block(text) + "\n";
}

/// Tabs and such, which a reader could not see.
std::string visible(std::string text) {
    for (std::size_t at = text.find('\t'); at != std::string::npos; at = text.find('\t', at)) text.replace(at, 1, "⇥");
    return text;
}

std::string changes(const FaultCase& fault) {
    std::string text;
    for (const auto& [from, to] : fault.change)
        text += "In `" + fault.of + "`, " + code(visible(from)) +
                (to.empty() ? " is taken away" : " becomes " + code(visible(to))) +
                (to.find('\n') == std::string::npos ? ".\n" : "\n");
    for (const auto& [name, content] : fault.files) text += "`" + name + "`:\n\n" + block(visible(content)) + "\n";
    return text.empty() ? text : text + "\n";
}

std::string section(const FaultCase& fault) {
    std::string text =
        "### " + fault.title + "\n\n" + changes(fault) + block("$ " + fault.command + "\n" + fault.prints);
    text += "\nExit code " + std::to_string(fault.exit) + ". " + fault.cure + "\n";
    return text;
}

}  // namespace

std::string errors_page(const std::vector<FaultGroup>& groups) {
    std::string text = head;
    for (const FaultGroup& group : groups) {
        text += "\n- [" + group.name + "](#" + anchor(group.name) + ")";
    }
    text += "\n";
    for (const FaultGroup& group : groups) {
        text += "\n## " + group.name + "\n";
        if (!group.about.empty()) text += "\n" + group.about + "\n";
        for (const FaultCase& fault : group.cases) text += "\n" + section(fault);
    }
    return text;
}

}  // namespace pelorus::test
