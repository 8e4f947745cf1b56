/// What the commands that read a config have in common: which flags they take, and what these mean.
#pragma once

#include <filesystem>
#include <vector>

#include "campaign/cells.hpp"
#include "cli/command_line.hpp"
#include "graph/document.hpp"
#include "host/catalog.hpp"

namespace pelorus::cli {

Flag plugins_flag();
/// --set, --seed, --plugins, --log-level.
std::vector<Flag> config_flags();

/// --variant, --runs.
std::vector<Flag> campaign_flags();

/// What they say. Throws Error (Exit::misuse).
campaign::Selection read_selection(const CommandLine& line);

/// Where `line` lets plugins be looked for. Throws Error (Exit::misuse) for a folder that is not there.
std::vector<std::filesystem::path> plugin_folders(const CommandLine& line);

/// The config that is the first argument, with --set and --seed, at the log level asked for. Throws Error.
graph::Document load_document(const CommandLine& line);

}  // namespace pelorus::cli
