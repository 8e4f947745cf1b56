#include "cli/completion/candidates.hpp"

#include <algorithm>
#include <exception>

#include "cli/command.hpp"
#include "cli/completion/config_addresses.hpp"
#include "host/catalog.hpp"
#include "host/kinds.hpp"

namespace pelorus::cli {

namespace {

using Words = std::vector<std::string>;

/// A command line that is still being written: its words without the `=` that bash splits off.
struct UnfinishedLine {
    const Command* command = nullptr;
    Words before;  ///< the words after the command's name and before the cursor
    Words all;     ///< those, and what stands after the cursor
};

bool is_flag(const std::string& word) { return word.size() > 1 && word.front() == '-'; }

const Flag* find_flag(const Command& command, const std::string& word) {
    for (const Flag& flag : command.grammar.flags)
        if (word == "--" + flag.name) return &flag;
    return nullptr;
}

/// Arguments among `words`; the values of flags are none.
Words arguments_of(const Command& command, const Words& words) {
    Words arguments;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const Flag* const flag = find_flag(command, words[i]);
        if (flag != nullptr && !flag->value.empty())
            ++i;
        else if (!is_flag(words[i]))
            arguments.push_back(words[i]);
    }
    return arguments;
}

std::vector<std::filesystem::path> folders_on(const Words& words) {
    std::vector<std::filesystem::path> folders;
    for (std::size_t i = 0; i + 1 < words.size(); ++i)
        if (words[i] == "--plugins") folders.emplace_back(words[i + 1]);
    return host::Catalog::default_folders(folders);
}

Words kinds() {
    Words names;
    for (const host::Kind& kind : host::kinds) names.emplace_back(kind.name);
    return names;
}

Words ids(const UnfinishedLine& line) {
    Words found;
    const host::Catalog catalog(folders_on(line.all));
    for (const host::PluginFile& file : catalog.plugins()) found.push_back(file.id);
    return found;
}

/// What stands for an argument or a flag's value, by the word that help has for it.
Words for_placeholder(const std::string& placeholder, const UnfinishedLine& line) {
    if (placeholder == "CONFIG") return {":files .yaml"};
    if (placeholder == "DIR" || placeholder == "A" || placeholder == "B") return {":folders"};
    if (placeholder == "FILE") return {":files"};
    if (placeholder == "KIND") return kinds();
    if (placeholder == "LEVEL") return {"trace", "debug", "info", "warning", "error"};
    if (placeholder == "MODE") return {"off", "start", "all"};
    if (placeholder == "FORMAT") return {"png", "svg"};
    if (placeholder == "1..5") return {"1", "2", "3", "4", "5"};
    if (placeholder == "LIB.so") return {":files .so"};
    if (placeholder == "SHELL") return {"bash"};
    if (placeholder == "ID|LIB.so|CONFIG") {
        Words found = ids(line);
        found.insert(found.end(), {":files .yaml", ":files .so"});
        return found;
    }
    if (placeholder == "V") {
        const Words arguments = arguments_of(*line.command, line.all);
        return arguments.empty() ? Words() : config_variants(arguments.front());
    }
    if (placeholder == "ADDRESS=VALUE") {
        const Words arguments = arguments_of(*line.command, line.all);
        return arguments.empty() ? Words() : config_addresses(arguments.front(), folders_on(line.all));
    }
    return {};
}

Words flags_left(const UnfinishedLine& line) {
    Words flags;
    for (const Flag& flag : line.command->grammar.flags) {
        const std::string word = "--" + flag.name;
        const bool is_there = std::find(line.all.begin(), line.all.end(), word) != line.all.end();
        if (flag.repeats || !is_there) flags.push_back(word);
    }
    flags.push_back("--help");
    return flags;
}

Words command_names() {
    Words names;
    for (const Command& command : commands()) names.push_back(command.name);
    return names;
}

Words after_command(const UnfinishedLine& line, const std::string& current) {
    if (!line.before.empty()) {
        const Flag* const flag = find_flag(*line.command, line.before.back());
        if (flag != nullptr && !flag->value.empty()) return for_placeholder(flag->value, line);
    }
    if (is_flag(current) || current == "-") return flags_left(line);
    const std::size_t given = arguments_of(*line.command, line.before).size();
    const Words& wanted = line.command->grammar.arguments;
    if (given < wanted.size()) return for_placeholder(wanted[given], line);
    return line.command->grammar.last_repeats ? for_placeholder(wanted.back(), line) : flags_left(line);
}

Words all_candidates(const Words& words, std::size_t at, const std::string& current) {
    if (at == 1) {
        Words names = command_names();
        names.insert(names.end(), {"help", "--help", "--version"});
        return names;
    }
    if (words[1] == "help") return at == 2 ? command_names() : Words();
    UnfinishedLine line;
    for (const Command& command : commands())
        if (command.name == words[1]) line.command = &command;
    if (line.command == nullptr) return {};
    for (std::size_t i = 2; i < words.size(); ++i) {
        if (words[i] == "=") {  // of `--flag=value`, or of `--set address=value`, whose value is free
            const bool is_of_flag = is_flag(words[i - 1]);
            if (!is_of_flag && i < at && i + 2 > at) return {};
            if (!is_of_flag) ++i;
            continue;
        }
        if (i < at) line.before.push_back(words[i]);
        if (i != at) line.all.push_back(words[i]);
    }
    return after_command(line, current);
}

}  // namespace

std::vector<std::string> candidates(const std::vector<std::string>& words, std::size_t at) noexcept {
    try {
        if (at == 0 || at > words.size()) return {};
        std::string current = at < words.size() ? words[at] : "";
        Words line = words;
        if (current == "=") {  // the cursor is just after it
            current.clear();
            line.insert(line.begin() + static_cast<std::ptrdiff_t>(at) + 1, "");
            ++at;
        }
        Words found;
        for (const std::string& word : all_candidates(line, at, current))
            if (word.front() == ':' || word.compare(0, current.size(), current) == 0) found.push_back(word);
        return found;
    } catch (const std::exception&) {  // a half-written line has no errors yet
        return {};
    }
}

}  // namespace pelorus::cli
