// `pelorus schema`: what an editor has to know of configs.
#include <filesystem>

#include "cli/command.hpp"
#include "cli/config_flags.hpp"
#include "cli/output.hpp"
#include "cli/plugin_json.hpp"
#include "cli/schema/schema.hpp"
#include "host/error.hpp"
#include "report/json_file.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;

int schema(const CommandLine& line) {
    host::Catalog catalog(plugin_folders(line));
    std::vector<std::string> problems;
    const std::vector<Json> plugins = all_descriptions(catalog, problems);
    for (const std::string& problem : problems) tell(problem);  // the others are of use all the same
    const std::string text = config_schema(plugins).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
    if (line.has("out"))
        report::write_file(line.value("out"), text);
    else
        print(text);
    return static_cast<int>(Exit::done);
}

}  // namespace

Command schema_command() {
    return {
        "schema",
        "JSON Schema of configs, for editors",
        "Prints a JSON Schema (draft-07) of the config with every plugin that is there. An editor with a YAML language "
        "server completes, explains and checks configs by it, once the first line of a config says where it is:\n\n"
        "# yaml-language-server: $schema=FILE\n\n"
        "The schema of the plugins that come with Pelorus is share/pelorus/config.schema.json. Units are not checked "
        "by it, nor what depends on other parts of a config; `pelorus check` checks everything.",
        {{}, {{"out", "FILE", "write it there instead of printing it"}, plugins_flag()}, {}},
        {{"pelorus schema --out pelorus.schema.json", "with the plugins that are found"},
         {"pelorus schema --plugins ./build --out pelorus.schema.json", "and one that was just built"}},
        &schema};
}

}  // namespace pelorus::cli
