#include "cli/project.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <system_error>

#include "host/error.hpp"
#include "host/kinds.hpp"
#include "report/json_file.hpp"

namespace pelorus::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* suffix = ".in";
constexpr const char* notes_file = "notes.md.in";  // becomes part of the README
constexpr std::size_t longest_name = 64;           // a manifest has room for an id of 127 bytes

using Words = std::map<std::string, std::string>;

[[noreturn]] void fail(const std::string& line) { throw Error(Exit::run_failed, line); }

std::string read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) fail("cannot read the template " + file.string());
    return text;
}

/// Replaces @WORD@ by its meaning; anything else between two @ stays.
std::string filled(const std::string& text, const Words& words) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text[at] == '@' ? text.find('@', at + 1) : std::string::npos;
        const auto word = end == std::string::npos ? words.end() : words.find(text.substr(at + 1, end - at - 1));
        if (word == words.end()) {
            out += text[at++];
        } else {
            out += word->second;
            at = end + 1;
        }
    }
    return out;
}

/// `range_rate` -> `RangeRate`
std::string camel_case(const std::string& name) {
    std::string out;
    bool upper = true;
    for (const char c : name) {
        if (c == '_') {
            upper = true;
            continue;
        }
        out += upper && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        upper = false;
    }
    return out;
}

/// The class's name ends with its kind, so that no name clashes with one that the author layer uses (`State`, `Noise`).
std::string class_name(const Project& project) {
    const std::string kind = camel_case(project.kind), name = camel_case(project.name);
    const bool has_kind = name.size() >= kind.size() && name.compare(name.size() - kind.size(), kind.size(), kind) == 0;
    return has_kind ? name : name + kind;
}

/// What every project has, then what its kind has: a file of the same name replaces the common one.
std::vector<fs::path> template_folders(const Project& project) {
    const fs::path root = executable_folder().parent_path() / "share" / "pelorus" / "templates";
    const host::Kind* const kind = host::find_kind(project.kind);
    fs::path own = root / project.kind;
    if (!fs::is_directory(own) && kind != nullptr && kind->is_stage) own = root / "stage";
    for (const fs::path& folder : {root / "common", own})
        if (!fs::is_directory(folder))
            fail("the templates of `pelorus new` are not installed: there is no folder " + folder.string());
    return {root / "common", own};
}

/// File name to text, filled in.
std::map<std::string, std::string> files_of(const Project& project) {
    Words words{
        {"KIND", project.kind}, {"NAME", project.name}, {"CLASS", class_name(project)}, {"ID", plugin_id(project)}};
    std::map<std::string, fs::path> templates;
    for (const fs::path& folder : template_folders(project))
        for (const fs::directory_entry& entry : fs::directory_iterator(folder))
            if (entry.path().extension() == suffix) templates[entry.path().filename().string()] = entry.path();
    const auto notes = templates.find(notes_file);
    if (notes != templates.end()) {
        std::string text = filled(read(notes->second), words);
        text.erase(text.find_last_not_of('\n') + 1);
        words["NOTES"] = text;
        templates.erase(notes);
    }
    std::map<std::string, std::string> files;
    for (const auto& [name, path] : templates) files[filled(path.stem().string(), words)] = filled(read(path), words);
    return files;
}

}  // namespace

std::string plugin_id(const Project& project) { return "org.example." + project.kind + "." + project.name; }

std::string name_problem(const std::string& name) {
    const bool good = !name.empty() && name[0] >= 'a' && name[0] <= 'z' &&
                      std::all_of(name.begin(), name.end(),
                                  [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
    if (!good)
        return "a name has lower-case letters, digits and underscores and begins with a letter, got '" + name + "'";
    if (name.size() > longest_name) return "a name has at most " + std::to_string(longest_name) + " letters";
    return {};
}

fs::path executable_folder() {
    std::error_code reason;
    const fs::path executable = fs::read_symlink("/proc/self/exe", reason);
    if (reason) fail("cannot find the folder of this executable: " + reason.message());
    return executable.parent_path();
}

std::vector<std::string> make_project(const Project& project) {
    const std::map<std::string, std::string> files = files_of(project);
    std::error_code reason;
    const bool made = fs::create_directory(project.folder, reason);
    if (reason) throw Error(Exit::misuse, "cannot make " + project.folder.string() + ": " + reason.message());
    if (!made) throw Error(Exit::misuse, project.folder.string() + " is there already; nothing was changed");
    std::vector<std::string> names;
    try {
        for (const auto& [name, text] : files) {
            report::write_file(project.folder / name, text);
            names.push_back(name);
        }
    } catch (...) {
        fs::remove_all(project.folder, reason);
        throw;
    }
    return names;
}

}  // namespace pelorus::cli
