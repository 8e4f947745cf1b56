// `pelorus inspect`: one plugin, all plugins of a library, or the graph of a config.
#include <algorithm>

#include <fmt/format.h>

#include "cli/command.hpp"
#include "cli/config_flags.hpp"
#include "cli/draw/drawing.hpp"
#include "cli/draw/graph_json.hpp"
#include "cli/example.hpp"
#include "cli/instance_json.hpp"
#include "cli/output.hpp"
#include "cli/plugin_json.hpp"
#include "cli/plugin_text.hpp"
#include "graph/graph.hpp"
#include "host/error.hpp"

namespace pelorus::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Ids of the plugins of a kind, and of those that have a slot for it.
class Neighbours {
public:
    explicit Neighbours(const std::vector<Json>& plugins) : plugins_(plugins) {}

    Json of_kind(const std::string& kind) const {
        Json ids = Json::array();
        for (const Json& plugin : plugins_)
            if (plugin["kind"] == kind) ids.push_back(plugin["id"]);
        return ids;
    }

    Json slots_for(const std::string& kind) const {
        Json places = Json::array();
        for (const Json& plugin : plugins_)
            for (const Json& slot : plugin["slots"])
                if (slot["kind"] == kind) places.push_back({{"plugin", plugin["id"]}, {"slot", slot["name"]}});
        return places;
    }

private:
    const std::vector<Json>& plugins_;
};

/// All that can be said of a plugin; the others of the catalog serve as its parts and neighbours.
Json whole_json(Json plugin, const std::vector<Json>& all, const graph::PluginFinder& finder) {
    const Neighbours neighbours(all);
    const Json example = ExampleMaker(all).example(plugin);
    for (Json& slot : plugin["slots"]) slot["takes"] = neighbours.of_kind(slot["kind"]);
    if (plugin["tier"] == "model") {
        plugin["stands_in"] = neighbours.slots_for(plugin["kind"]);
        plugin["instance"] = instance_json(example, finder);
    }
    plugin["example"] = example;
    return plugin;
}

void show(const Json& json, const std::string& text, const CommandLine& line) {
    if (line.has("json"))
        print_json(json);
    else
        print(text);
}

void refuse_config_flags(const CommandLine& line, const std::string& what) {
    for (const char* flag : {"set", "seed", "dot"})
        if (line.has(flag))
            throw Error(Exit::misuse,
                        fmt::format("inspect: --{} is for configs, and {} is {}", flag, line.argument(0), what));
}

int inspect_plugin(const CommandLine& line) {
    refuse_config_flags(line, "taken for a plugin's id");
    host::Catalog catalog(plugin_folders(line));
    const std::string& id = line.argument(0);
    std::error_code ignored_reason;
    if (catalog.find(id) == nullptr && fs::is_directory(id, ignored_reason))
        throw Error(Exit::misuse,
                    fmt::format("{} is a folder; `pelorus list --plugins {}` lists the plugins in it", id, id));
    Json plugin = description_with_digest(catalog.load(id));
    std::vector<std::string> ignored;  // of plugins that nobody asked for
    plugin = whole_json(std::move(plugin), all_descriptions(catalog, ignored),
                        [&catalog](const std::string& any) -> const host::LoadedPlugin& { return catalog.load(any); });
    show(plugin, plugin_text(plugin), line);
    return static_cast<int>(Exit::done);
}

int inspect_library(const CommandLine& line) {
    refuse_config_flags(line, "a library");
    const fs::path file = line.argument(0);
    std::error_code ignored_reason;
    if (!fs::exists(file, ignored_reason)) throw Error(Exit::misuse, file.string() + ": there is no such file");
    host::Catalog library({fs::absolute(file)});
    if (!library.rejected().empty())
        throw Error(Exit::misuse, file.string() + ": " + library.rejected().front().reason);
    std::vector<Json> own;
    for (const host::PluginFile& each : library.plugins())
        own.push_back(description_with_digest(library.load(each.id)));
    // Another copy of the library where plugins are looked for is no matter: this one is asked for.
    host::Catalog others(plugin_folders(line));
    std::vector<std::string> ignored;
    std::vector<Json> all = all_descriptions(others, ignored);
    for (const Json& plugin : own) {
        all.erase(std::remove_if(all.begin(), all.end(), [&](const Json& each) { return each["id"] == plugin["id"]; }),
                  all.end());
        all.push_back(plugin);
    }
    const auto finder = [&](const std::string& id) -> const host::LoadedPlugin& {
        return library.find(id) == nullptr ? others.load(id) : library.load(id);
    };
    Json list = Json::array();
    std::string text;
    for (const Json& plugin : own) {
        list.push_back(whole_json(plugin, all, finder));
        text += (text.empty() ? "" : "\n") + plugin_text(list.back());
    }
    show(list, text, line);
    return static_cast<int>(Exit::done);
}

int inspect_config(const CommandLine& line) {
    if (line.has("dot") && line.has("json")) throw Error(Exit::misuse, "inspect: --dot and --json do not go together");
    host::Catalog catalog(plugin_folders(line));
    const graph::Document document = load_document(line);
    const Json json = graph_json(graph::Graph::build(document, catalog, {}));
    show(json, line.has("dot") ? graph_dot(json) : graph_text(json), line);
    return static_cast<int>(Exit::done);
}

int inspect(const CommandLine& line) {
    const fs::path subject = line.argument(0);
    std::error_code ignored;
    const std::string extension = subject.extension().string();
    if (extension == ".so") return inspect_library(line);
    if (extension == ".yaml" || extension == ".yml" || fs::is_regular_file(subject, ignored))
        return inspect_config(line);
    return inspect_plugin(line);
}

}  // namespace

Command inspect_command() {
    std::vector<Flag> flags{{"json", "", "as JSON, for programs"},
                            {"dot", "", "a config's graph in the language of Graphviz"}};
    for (const Flag& flag : config_flags()) flags.push_back(flag);
    return {
        "inspect",
        "what one plugin does and takes; the graph of a config",
        "With the ID of a plugin: its purpose, equation and source, its slots, ports, inputs and parameters with type, "
        "unit, default, range and choices, the spaces of an instance, and how it is written into a config. With a "
        "library (LIB.so): the same of each plugin in it.\n\n"
        "With a config: its graph. Each node with its parts as a tree, the values that are not the defaults, the "
        "edges, "
        "and what flows through them: kind of message, sensors, components, frames.",
        {{"ID|LIB.so|CONFIG"}, flags, {}},
        {{"pelorus list", "which ids there are"},
         {"pelorus inspect build/motion/drag.so", "what is in a library that was just built"},
         {"pelorus inspect configs/airship.yaml", "the graph of a config"},
         {"pelorus inspect configs/airship.yaml --dot | dot -Tsvg > graph.svg", "the same as a picture"}},
        &inspect};
}

}  // namespace pelorus::cli
