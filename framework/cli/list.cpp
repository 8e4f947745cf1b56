// `pelorus list`: the plugins that are there.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/config_flags.hpp"
#include "cli/output.hpp"
#include "host/catalog.hpp"
#include "host/error.hpp"
#include "host/kinds.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Entry {
    const host::PluginFile* file;
    std::string title;
};

void check_kind(const std::string& wanted) {
    if (wanted.empty() || host::find_kind(wanted) != nullptr) return;
    std::vector<std::string> names;
    std::string all;
    for (const host::Kind& kind : host::kinds) {
        names.emplace_back(kind.name);
        all += (all.empty() ? "" : ", ") + names.back();
    }
    const std::string near = nearest(wanted, names);
    throw Error(Exit::misuse, fmt::format("--kind: there is no kind '{}'; {}", wanted,
                                          near.empty() ? "kinds: " + all : "did you mean '" + near + "'?"));
}

/// Loads each for its title; what cannot be loaded is told and left out.
std::vector<Entry> load_titles(host::Catalog& catalog, const std::string& wanted) {
    std::vector<Entry> entries;
    for (const host::PluginFile& file : catalog.plugins()) {
        if (!wanted.empty() && file.kind != wanted) continue;
        try {
            entries.push_back({&file, catalog.load(file.id).description().title});
        } catch (const Error& problem) {
            tell(problem.what());
        }
    }
    return entries;
}

void tell_rejected(const host::Catalog& catalog) {
    for (const host::RejectedFile& rejected : catalog.rejected())
        tell("not used: " + rejected.library.string() + ": " + rejected.reason);
}

std::string text(const std::vector<Entry>& entries) {
    std::string out;
    for (const host::Kind& kind : host::kinds) {
        std::vector<std::vector<std::string>> rows;
        for (const Entry& entry : entries)
            if (entry.file->kind == kind.name) rows.push_back({entry.file->id, entry.title});
        if (!rows.empty()) out += (out.empty() ? "" : "\n") + std::string(kind.name) + "\n" + aligned(rows, 2);
    }
    return out;
}

Json entries_json(const std::vector<Entry>& entries) {
    Json list = Json::array();
    for (const Entry& entry : entries)
        list.push_back({{"id", entry.file->id},
                        {"kind", entry.file->kind},
                        {"version", entry.file->version},
                        {"title", entry.title},
                        {"library", entry.file->library.string()}});
    return list;
}

int list(const CommandLine& line) {
    const std::string wanted = line.value("kind");
    check_kind(wanted);
    host::Catalog catalog(plugin_folders(line));
    tell_rejected(catalog);
    const std::vector<Entry> entries = load_titles(catalog, wanted);
    if (entries.empty()) {
        std::string folders;
        for (const auto& folder : catalog.folders()) folders += (folders.empty() ? "" : ", ") + folder.string();
        tell("no plugins" + (wanted.empty() ? "" : " of kind " + wanted) + " in " + folders);
    }
    if (line.has("json"))
        print_json(entries_json(entries));
    else
        print(text(entries));
    return static_cast<int>(Exit::done);
}

}  // namespace

Command list_command() {
    return {
        "list",
        "plugins that are there, by kind",
        "Lists the plugins that a config may use: their ids by kind, each with its title. Libraries that were found "
        "but cannot be used are told on standard error, each with the reason. Plugins are looked for in the folders "
        "given by --plugins, in those of PELORUS_PLUGIN_PATH and in lib/pelorus beside the command's own folder, "
        "subfolders included.",
        {{},
         {{"kind", "KIND", "only this kind: motion, sensor, tracker, ..."},
          {"json", "", "as JSON, for programs"},
          plugins_flag()},
         {}},
        {{"pelorus list --kind motion", "motion models"},
         {"pelorus list --plugins ./build", "with plugins that were just built"}},
        &list};
}

}  // namespace pelorus::cli
