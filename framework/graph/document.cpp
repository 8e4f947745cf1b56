#include "graph/document.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "graph/problems.hpp"
#include "graph/yaml.hpp"

namespace pelorus::graph {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const Location& where, const std::string& text) { throw ConfigError({{where, text}}); }

/// Names of files being read, each extended by the one before it.
struct Chain {
    std::vector<fs::path> canonical;
    std::vector<std::string> names;
};

/// What the name was perhaps meant to be: a file of that folder, or the folder that is not there.
std::string near_file(const fs::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    std::error_code error;
    std::vector<std::string> names;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
        names.push_back(it->path().filename().string());
    if (names.empty() && !fs::is_directory(folder, error)) return "; there is no folder " + folder.string() + " either";
    std::sort(names.begin(), names.end());
    std::vector<std::string> stems;  // the ending, which all configs share, makes no name near
    for (const std::string& name : names)
        if (fs::path(name).extension() == file.extension()) stems.push_back(fs::path(name).stem().string());
    std::string near = nearest(file.stem().string(), stems);
    if (!near.empty()) near += file.extension().string();
    for (const std::string& name : names)
        if (near.empty() && fs::path(name).stem() == file.filename()) near = name;
    return near.empty() ? "" : "; did you mean '" + (file.parent_path() / near).string() + "'?";
}

std::string read_file(const fs::path& file, const Location& named_at) {
    const std::string prefix = named_at.file.empty() ? file.string() + ": " : "extend: " + file.string() + ": ";
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) fail(named_at, prefix + "is a folder, not a config file");
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        const int reason = errno != 0 ? errno : EIO;
        fail(named_at, prefix + (reason == ENOENT ? "there is no such file" + near_file(file) : std::strerror(reason)));
    }
    std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (stream.bad()) fail(named_at, prefix + "cannot be read");
    return text;
}

Value read_extended(const std::string& text, const std::string& name, const fs::path& base, Chain& chain);

Value read_with_base(const fs::path& file, const Location& named_at, Chain& chain) {
    const std::string text = read_file(file, named_at);
    std::error_code error;
    fs::path canonical = fs::canonical(file, error);
    if (error) canonical = fs::absolute(file).lexically_normal();
    const auto seen = std::find(chain.canonical.begin(), chain.canonical.end(), canonical);
    if (seen != chain.canonical.end()) {
        std::vector<std::string> circle(chain.names.begin() + (seen - chain.canonical.begin()), chain.names.end());
        circle.push_back(file.string());
        fail(named_at, "config files extend each other in a circle: " + join(circle, " -> "));
    }
    chain.canonical.push_back(canonical);
    chain.names.push_back(file.string());
    return read_extended(text, file.string(), canonical.parent_path(), chain);
}

Value read_extended(const std::string& text, const std::string& name, const fs::path& base, Chain& chain) {
    Value root = read_yaml(text, TextOrigin{Location{}, name, base});
    if (root.is_null()) fail({name, 0, 0}, "the config is empty; it begins with `pelorus: 1`");
    if (!root.is_map()) fail(root.where, "a config is a map that begins with `pelorus: 1`, got " + root.described());
    const Value* extend = root.find("extend");
    if (extend == nullptr) return root;
    if (!extend->is_scalar() || extend->scalar.empty())
        fail(extend->where, "extend: expected the name of one config file, got " + extend->described());
    const fs::path relative(extend->scalar);
    const fs::path shown = relative.is_absolute() ? relative : fs::path(name).parent_path() / relative;
    Value below = read_with_base(shown.lexically_normal(), extend->where, chain);
    root.erase("extend");
    merge(below, std::move(root));
    return below;
}

}  // namespace

Document Document::load(const fs::path& file, const std::vector<Override>& overrides) {
    Document document;
    document.file_ = file;
    Chain chain;
    document.root_ = read_with_base(file, {}, chain);
    document.read_overrides(overrides);
    return document;
}

Document Document::without_campaign() const {
    Document one;
    one.root_.kind = root_.kind;
    one.root_.where = root_.where;
    one.root_.base = root_.base;
    for (const Value::Entry& entry : root_.map)
        if (entry.key != "campaign") one.root_.map.push_back(entry);
    one.file_ = file_;
    one.overrides_ = overrides_;
    one.assigned_ = assigned_;
    return one;
}

Document Document::parse(const std::string& text, const std::string& name, const fs::path& base,
                         const std::vector<Override>& overrides) {
    Document document;
    document.file_ = name;
    Chain chain;
    document.root_ = read_extended(text, name, fs::absolute(base), chain);
    document.read_overrides(overrides);
    return document;
}

void Document::read_overrides(const std::vector<Override>& overrides) {
    Problems problems;
    for (const Override& each : overrides) {
        const Location where{"--set " + each.address + "=" + each.text, 0, 0};
        if (each.text.find_first_not_of(" \t") == std::string::npos) {
            problems.add(where, "a value is missing; write ~ to remove what stands there");
            continue;
        }
        try {
            overrides_.push_back({each.address, where, read_yaml(each.text, {where, {}, fs::current_path()})});
        } catch (const ConfigError& error) {
            for (const ConfigError::Item& item : error.items()) problems.add(item.where, item.text);
        }
    }
    problems.raise();
}

void Document::assign(Assignment assignment) {
    overrides_.insert(overrides_.begin() + static_cast<std::ptrdiff_t>(assigned_++), std::move(assignment));
}

}  // namespace pelorus::graph
