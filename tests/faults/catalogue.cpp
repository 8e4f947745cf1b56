#include "catalogue.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "../fixtures/temporary_folder.hpp"
#include "../support/line_match.hpp"
#include "../support/process.hpp"

namespace pelorus::test {

namespace {

namespace fs = std::filesystem;

void check_keys(const YAML::Node& map, const std::set<std::string>& known, const std::string& file) {
    for (const auto& entry : map)
        if (known.count(entry.first.as<std::string>()) == 0)
            throw std::runtime_error(file + ":" + std::to_string(entry.first.Mark().line + 1) + ": unknown key '" +
                                     entry.first.as<std::string>() + "'");
}

std::string text_of(const YAML::Node& map, const std::string& key, const std::string& otherwise = {}) {
    return map[key] ? map[key].as<std::string>() : otherwise;
}

std::vector<std::pair<std::string, std::string>> pairs_of(const YAML::Node& map) {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const auto& entry : map) pairs.emplace_back(entry.first.as<std::string>(), entry.second.as<std::string>());
    return pairs;
}

FaultCase read_case(const YAML::Node& node, const std::string& file) {
    check_keys(node,
               {"title", "of", "change", "files", "prepare", "needs", "command", "exit", "prints", "folder", "leaves",
                "holds", "cure"},
               file);
    FaultCase fault;
    fault.title = text_of(node, "title");
    fault.of = text_of(node, "of", fault.of);
    fault.change = pairs_of(node["change"]);
    fault.files = pairs_of(node["files"]);
    fault.prepare = text_of(node, "prepare");
    fault.needs = text_of(node, "needs");
    fault.command = text_of(node, "command");
    fault.exit = node["exit"].as<int>();
    fault.prints = text_of(node, "prints");
    fault.folder = text_of(node, "folder", fault.folder);
    for (const YAML::Node& name : node["leaves"]) fault.leaves.push_back(name.as<std::string>());
    for (const auto& [name, text] : pairs_of(node["holds"])) fault.holds[name] = text;
    fault.cure = text_of(node, "cure");
    return fault;
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

void lay_out(const FaultCase& fault, const TemporaryFolder& folder) {
    for (const auto& entry : fs::directory_iterator(fs::path(PELORUS_SOURCE_DIR) / "tests/faults/files"))
        fs::copy(entry.path(), folder.path());
    std::string config = folder.read(fault.of);
    for (const auto& [from, to] : fault.change) {
        if (count(config, from) != 1) throw std::runtime_error("'" + from + "' does not stand once in " + fault.of);
        replace_all(config, from, to);
    }
    folder.write(fault.of, config);
    for (const auto& [name, text] : fault.files) folder.write(name, text);
}

Ended shell(const std::string& commands, const TemporaryFolder& folder) {
    ProcessOptions options;
    options.folder = folder.path();
    const char* path = std::getenv("PATH");
    options.environment = {
        {"PATH", fs::path(PELORUS_SHIPPED_EXECUTABLE).parent_path().string() + ":" + (path == nullptr ? "/bin" : path)},
        {"PELORUS_PLUGIN_PATH", ""},
        {"FIXTURES", PELORUS_BUILD_DIR "/fixtures"},
        {"TEST_PLUGINS", PELORUS_TEST_PLUGINS},
        {"PLUGINS", PELORUS_PLUGIN_DIR}};
#ifdef PELORUS_ADDRESS_SANITIZER
    // The command tells of a crash itself, as in a build without the sanitizer.
    const char* given = std::getenv("ASAN_OPTIONS");
    options.environment["ASAN_OPTIONS"] = std::string(given == nullptr ? "" : given) + ":handle_segv=0:handle_sigbus=0";
#endif
    return run({"sh", "-c", commands}, options);
}

/// What differs from run to run and from machine to machine, by name.
std::string without_places(std::string text, const TemporaryFolder& folder) {
    replace_all(text, folder.path().string(), "${DIR}");
    replace_all(text, fs::path(PELORUS_SHIPPED_EXECUTABLE).parent_path().parent_path().string(), "${BUILD}");
    replace_all(text, PELORUS_BUILD_DIR, "${BUILD}");
    static const std::regex stamp(R"((^|\n)\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3} )");
    return std::regex_replace(text, stamp, "$1");
}

/// ${ANY} stands for any text.
bool fits(const std::string& line, const std::string& pattern) { return line_matches(pattern, line, "${ANY}"); }

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::string print_difference(const std::string& printed, const std::string& expected) {
    const std::vector<std::string> is = lines_of(printed), wanted = lines_of(expected);
    bool same = is.size() == wanted.size();
    for (std::size_t i = 0; same && i < is.size(); ++i) same = fits(is[i], wanted[i]);
    if (same) return {};
    std::string text = "standard error differs (- expected, + printed)\n";
    for (std::size_t i = 0; i < std::max(is.size(), wanted.size()); ++i) {
        if (i < is.size() && i < wanted.size() && fits(is[i], wanted[i])) {
            text += "    " + is[i] + "\n";
            continue;
        }
        if (i < wanted.size()) text += "  - " + wanted[i] + "\n";
        if (i < is.size()) text += "  + " + is[i] + "\n";
    }
    return text;
}

std::string list(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return "[" + text + "]";
}

std::string folder_difference(const FaultCase& fault, const TemporaryFolder& folder) {
    std::vector<std::string> names;
    std::error_code none;
    if (fs::is_directory(folder / fault.folder, none))
        for (const auto& entry : fs::directory_iterator(folder / fault.folder))
            names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    std::string text;
    if (names != fault.leaves)
        text +=
            "the result folder " + fault.folder + " holds " + list(names) + ", expected " + list(fault.leaves) + "\n";
    for (const auto& [file, part] : fault.holds)
        if (!folder.has(file))
            text += "there is no file " + file + "\n";
        else if (folder.read(file).find(part) == std::string::npos)
            text += file + " does not hold '" + part + "':\n" + folder.read(file).substr(0, 2000) + "\n";
    return text;
}

}  // namespace

FaultGroup read_group(const fs::path& file) {
    const YAML::Node root = YAML::LoadFile(file.string());
    check_keys(root, {"group", "about", "cases"}, file.string());
    FaultGroup group;
    group.name = root["group"].as<std::string>();
    group.about = text_of(root, "about");
    for (const YAML::Node& node : root["cases"]) group.cases.push_back(read_case(node, file.string()));
    return group;
}

std::string try_case(const FaultCase& fault, std::string& skipped) {
    const TemporaryFolder folder;
    lay_out(fault, folder);
    if (!fault.needs.empty() && shell(fault.needs, folder).exit != 0) {
        skipped = "this machine cannot do: " + fault.needs;
        return {};
    }
    if (!fault.prepare.empty()) {
        const Ended prepared = shell("set -e\n" + fault.prepare, folder);
        if (prepared.exit != 0) return "the preparation failed: " + prepared.err;
    }
    const Ended ended = shell(fault.command, folder);
    std::string text;
    if (ended.exit != fault.exit)
        text = "exit code " + std::to_string(ended.exit) + ", expected " + std::to_string(fault.exit) + "\n";
    return text + print_difference(without_places(ended.err, folder), fault.prints) + folder_difference(fault, folder);
}

}  // namespace pelorus::test
