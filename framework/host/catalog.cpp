#include "host/catalog.hpp"

#include <algorithm>
#include <utility>

#include "host/description.hpp"
#include "host/error.hpp"
#include "host/kinds.hpp"
#include "host/library.hpp"
#include "host/manifest.hpp"
#include "host/plugin_error.hpp"
#include "host/search.hpp"

namespace pelorus::host {

namespace {

constexpr std::size_t longest_id = 1024;

[[noreturn]] void refuse(const std::string& text) { throw Error(Exit::misuse, text); }

std::string kind_names() {
    std::string names;
    for (const Kind& kind : kinds) names += (names.empty() ? "" : ", ") + std::string(kind.name);
    return names;
}

std::string folder_names(const std::vector<std::filesystem::path>& folders) {
    std::string names;
    for (const std::filesystem::path& folder : folders) names += (names.empty() ? "" : ", ") + folder.string();
    return names.empty() ? "no folder at all" : names;
}

/// All that can be known before any code of the plugin runs. "" if it may be loaded.
std::string manifest_problem(const PluginFile& file) {
    if (file.abi_major != PLR_ABI_MAJOR)
        return "speaks ABI " + std::to_string(file.abi_major) + ", this host " + std::to_string(PLR_ABI_MAJOR) +
               ": rebuild it with the SDK of this host";
    const Kind* kind = find_kind(file.kind);
    if (kind == nullptr)
        return "is of kind " + file.kind + ", which this host does not know (it knows " + kind_names() + ")";
    if (file.table_id != kind->table_id)
        return "speaks " + file.table_id + ", this host " + kind->table_id + ": rebuild it with the SDK of this host";
    return {};
}

std::string differs(const char* what, const char* from_library, const std::string& from_manifest) {
    const std::string text = one_line(from_library, longest_id);
    if (from_library != nullptr && text == from_manifest) return {};
    return std::string("the ") + what + " of the loaded plugin is \"" + text + "\", its manifest says \"" +
           from_manifest + "\"";
}

/// A process may run for months, and its plugins be replaced meanwhile: then nothing that was read before holds.
std::string change_problem(const PluginFile& file) {
    const std::string unsafe = why_unsafe(file.library);
    if (!unsafe.empty()) return unsafe;
    for (const PluginFile& now : read_manifests(file.library).plugins)
        if (now.id == file.id && now.abi_major == file.abi_major && now.table_id == file.table_id &&
            now.version == file.version)
            return {};
    return "the file has changed since it was found";
}

/// What the factory answered, against the manifest and against itself. "" if all is well.
std::string plugin_problem(const plr_plugin& plugin, const PluginFile& file) {
    if (plugin.struct_size < sizeof(plr_plugin))
        return "its plr_plugin has " + std::to_string(plugin.struct_size) + " bytes, expected at least " +
               std::to_string(sizeof(plr_plugin));
    if (plugin.description == nullptr) return "it has no description";
    if (plugin.create == nullptr) return "it has no create function";
    const plr_description& description = *plugin.description;
    const std::string problem = description_problem(description);
    if (!problem.empty()) return "its description is wrong: " + problem;
    for (const std::string& difference :
         {differs("table id", plugin.table_id, file.table_id), differs("id", description.id, file.id),
          differs("kind", description.kind, file.kind), differs("version", description.version, file.version)})
        if (!difference.empty()) return difference;
    return {};
}

}  // namespace

std::string LoadedPlugin::sha256() const { return library == nullptr ? "" : sha256_of(*library); }

Catalog::Catalog(std::vector<std::filesystem::path> folders) : folders_(std::move(folders)) {
    for (const std::filesystem::path& library : find_libraries(folders_, rejected_)) add(library);
    std::sort(plugins_.begin(), plugins_.end(), [](const PluginFile& a, const PluginFile& b) { return a.id < b.id; });
}

void Catalog::add(const std::filesystem::path& library) {
    Manifests manifests = read_manifests(library);
    std::vector<std::string> ids;
    for (const PluginFile& plugin : manifests.plugins) ids.push_back(plugin.id);
    const std::string problem = manifests.problem.empty() ? why_unsafe(library) : manifests.problem;
    if (!problem.empty()) {
        rejected_.push_back({library, problem, std::move(ids)});
        return;
    }
    for (PluginFile& plugin : manifests.plugins) {
        const auto same =
            std::find_if(plugins_.begin(), plugins_.end(), [&](const PluginFile& p) { return p.id == plugin.id; });
        if (same == plugins_.end()) {
            plugins_.push_back(std::move(plugin));
            continue;
        }
        if (!is_example(library)) clashes_.emplace(plugin.id, library);
        rejected_.push_back(
            {library, "its plugin " + plugin.id + " is in " + same->library.string() + " as well", {plugin.id}});
    }
}

const PluginFile* Catalog::find(const std::string& id) const noexcept {
    const auto found =
        std::lower_bound(plugins_.begin(), plugins_.end(), id,
                         [](const PluginFile& plugin, const std::string& wanted) { return plugin.id < wanted; });
    return found != plugins_.end() && found->id == id ? &*found : nullptr;
}

namespace {

std::string last_word(const std::string& id) { return id.substr(id.rfind('.') + 1); }

/// `sensor.bearing` of `org.example.sensor.bearing`.
std::string last_two_words(const std::string& id) {
    const std::size_t dot = id.rfind('.');
    if (dot == std::string::npos || dot == 0) return id;
    const std::size_t before = id.rfind('.', dot - 1);
    return before == std::string::npos ? id : id.substr(before + 1);
}

/// What was perhaps meant: a near id, else one that ends in the same name (`singer` for `motion.singer`). Ids that have no more in
/// common than a long beginning (`org.example.sensor.`) are not near.
std::string likely(const std::string& id, const std::vector<std::string>& ids) {
    std::string near = nearest(id, ids);
    if (!near.empty() && nearest(last_two_words(id), {last_two_words(near)}).empty()) near.clear();
    for (const std::string& candidate : ids)
        if (near.empty() && last_word(candidate) == last_word(id)) near = candidate;
    return near;
}

/// Whether a guess is near enough to go on with: parameters of another plugin must not be held against it. An id that has an owner
/// (`org.example.`) does not stand for one that has none.
bool is_sure(const std::string& id, const std::string& guess) {
    const auto dots = [](const std::string& text) { return std::count(text.begin(), text.end(), '.'); };
    return dots(id) <= dots(guess) && !nearest(last_word(id), {last_word(guess)}).empty();
}

/// Where nothing is near: what there is of the kind that the id begins with, if that is little.
std::string others_of_kind(const std::string& id, const std::vector<PluginFile>& plugins) {
    constexpr std::size_t few = 12;
    const Kind* kind = find_kind(id.substr(0, id.find('.')));
    std::vector<std::string> ids;
    for (const PluginFile& plugin : plugins)
        if (kind != nullptr && plugin.kind == kind->name) ids.push_back(plugin.id);
    if (ids.empty() || ids.size() > few) return {};
    std::string text;
    for (const std::string& other : ids) text += (text.empty() ? "" : ", ") + other;
    return std::string("; of kind ") + kind->name + " there are: " + text;
}

}  // namespace

const PluginFile& Catalog::require(const std::string& id) const {
    const PluginFile* const file = find(id);
    if (file == nullptr) {
        for (const RejectedFile& rejected : rejected_)
            if (std::find(rejected.ids.begin(), rejected.ids.end(), id) != rejected.ids.end())
                refuse("plugin " + id + " (" + rejected.library.string() + ") is not used: " + rejected.reason);
        std::vector<std::string> ids;
        for (const PluginFile& plugin : plugins_) ids.push_back(plugin.id);
        const std::string meant = likely(id, ids);
        throw UnknownPlugin(
            "no plugin " + id + (meant.empty() ? others_of_kind(id, plugins_) : " (did you mean " + meant + "?)") +
                "; searched " + folder_names(folders_) + "; more folders: --plugins DIR or PELORUS_PLUGIN_PATH",
            is_sure(id, meant) ? meant : std::string());
    }
    const auto clash = clashes_.find(id);
    if (clash != clashes_.end())
        refuse("plugin " + id + " is in two libraries: " + file->library.string() + " and " + clash->second.string() +
               "; remove one");
    return *file;
}

const LoadedPlugin& Catalog::load(const std::string& id) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto known = loaded_.find(id);
    if (known != loaded_.end()) return *known->second;

    const PluginFile& file = require(id);
    const std::string problem = manifest_problem(file);
    if (!problem.empty()) refuse("plugin " + id + " " + problem + " (" + file.library.string() + ")");
    const std::string where = "plugin " + id + " (" + file.library.string() + "): ";
    const std::string change = change_problem(file);
    if (!change.empty()) refuse(where + change);
    auto loaded = std::make_unique<LoadedPlugin>();
    try {
        const Library& library = load_library(file.library);
        loaded->file = file;
        loaded->library = &library;
        loaded->plugin = &make_plugin(library, id);
    } catch (const Error& error) {
        refuse(where + error.what());
    }
    const std::string wrong = plugin_problem(*loaded->plugin, file);
    if (!wrong.empty()) refuse(where + wrong);
    return *loaded_.emplace(id, std::move(loaded)).first->second;
}

}  // namespace pelorus::host
