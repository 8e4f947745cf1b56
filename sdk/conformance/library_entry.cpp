// What a library's entry point and its factory answer.
#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "machine/bench.hpp"

namespace pelorus::conformance {

namespace {

std::vector<ManifestEntry> plugins_of(const Bench& bench) { return bench.host().manifests(bench.task().library); }

std::string upper(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

/// Ids that are none, each close to one in a way that authors' comparisons fall for.
std::vector<std::string> unknown_ids(const std::vector<ManifestEntry>& plugins, Sample sample) {
    std::vector<std::string> ids{"", ".", "motion", "org.example.there_is_no_such_plugin", std::string(5000, 'x')};
    for (const ManifestEntry& entry : plugins) {
        ids.push_back(entry.id.substr(0, entry.id.size() - 1));
        ids.push_back(entry.id.substr(entry.id.rfind('.') + 1));
        ids.push_back(entry.id + "x");
        ids.push_back(entry.id + " ");
        ids.push_back(upper(entry.id));
        ids.push_back(entry.kind);
        std::string random = entry.id;  // of the same length and ending
        for (std::size_t i = 0; i < random.size() / 2; ++i)
            random[i] = static_cast<char>('a' + static_cast<char>(sample.below(26)));
        ids.push_back(random);
    }
    const auto is_known = [&](const std::string& id) {
        return std::any_of(plugins.begin(), plugins.end(), [&](const ManifestEntry& each) { return each.id == id; });
    };
    ids.erase(std::remove_if(ids.begin(), ids.end(), is_known), ids.end());
    return ids;
}

}  // namespace

PELORUS_CHECK(
    library, "library-entry-is-whole", 1,
    "The entry point is as long as this ABI's and says the version that the manifest says; a shorter one ends before "
    "the factory.",
    {"library-loads", "library-manifest-readable"}) {
    const plr_entry_point& entry = bench.library().entry();
    if (entry.struct_size < sizeof(plr_entry_point) || entry.struct_size > 4096)
        FAIL(PLR_ENTRY_SYMBOL ".struct_size is " << entry.struct_size << ", expected sizeof(plr_entry_point), "
                                                 << sizeof(plr_entry_point));
    for (const ManifestEntry& plugin : plugins_of(bench))
        if (plugin.abi_major != entry.abi_major || plugin.abi_minor != entry.abi_minor)
            FAIL(fmt::format("{} says ABI {}.{}, the manifest of {} says {}.{}", PLR_ENTRY_SYMBOL, entry.abi_major,
                             entry.abi_minor, plugin.id, plugin.abi_major, plugin.abi_minor));
}

PELORUS_CHECK(
    library, "library-answers-its-plugins", 1,
    "The factory answers every plugin that the manifest names, whole: with a description, a table id and create. A "
    "host finds plugins by the manifest alone.",
    {"library-loads", "library-manifest-readable"}) {
    for (const ManifestEntry& entry : plugins_of(bench)) {
        const plr_plugin& plugin = bench.library().plugin(entry.id);
        if (plugin.struct_size < sizeof(plr_plugin))
            FAIL(entry.id << ": plr_plugin.struct_size is " << plugin.struct_size << ", expected at least "
                          << sizeof(plr_plugin));
    }
}

PELORUS_CHECK(
    library, "library-descriptor-equals-manifest", 1,
    "Id, kind, version and table of the loaded plugin are those of the manifest; a host that chose by the one would "
    "call the other through the wrong table.",
    {"library-answers-its-plugins"}) {
    for (const ManifestEntry& entry : plugins_of(bench)) {
        const plr_plugin& plugin = bench.library().plugin(entry.id);
        const plr_description& description = *plugin.description;
        const auto compare = [&](const char* what, const char* loaded, const std::string& manifest) {
            const std::string text = loaded == nullptr ? "NULL" : loaded;
            if (text != manifest)
                FAIL_CHECK(entry.id << ": the manifest says " << what << " `" << manifest << "`, the loaded plugin `"
                                    << text << "`");
        };
        compare("id", description.id, entry.id);
        compare("kind", description.kind, entry.kind);
        compare("version", description.version, entry.version);
        compare("table id", plugin.table_id, entry.table_id);
    }
}

PELORUS_CHECK(
    library, "library-unknown-ids-are-null", 2,
    "The factory answers NULL for every id that is not one of its own, however like one; a factory that answers for "
    "everything hides misspelt configs and shadows other libraries.",
    {"library-loads", "library-manifest-readable"}) {
    for (const std::string& id : unknown_ids(plugins_of(bench), bench.sample()))
        if (bench.library().entry().factory(id.c_str()) != nullptr)
            FAIL_CHECK("factory(\"" << (id.size() > 200 ? id.substr(0, 20) + "..." : id)
                                    << "\") answered a plugin, and the manifest has none of that id");
}

PELORUS_CHECK(
    library, "library-factory-is-constant", 2,
    "The factory answers the same pointer for the same id each time; hosts keep it for ever and compare by it.",
    {"library-answers-its-plugins"}) {
    for (const ManifestEntry& entry : plugins_of(bench)) {
        const plr_plugin* const first = &bench.library().plugin(entry.id);
        const plr_description* const description = first->description;
        for (const std::string& other : unknown_ids(plugins_of(bench), bench.sample()))
            bench.library().entry().factory(other.c_str());
        const plr_plugin* const again = &bench.library().plugin(entry.id);
        if (again != first) FAIL("factory(\"" << entry.id << "\") answers another plr_plugin each time");
        if (again->description != description)
            FAIL("factory(\"" << entry.id << "\") has changed the description of the plugin that it answered before");
    }
}

}  // namespace pelorus::conformance
