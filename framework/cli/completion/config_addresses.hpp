/// What a config has that flags can name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pelorus::cli {

/// Every parameter in the config's graph, `world.period=`; and `run.seed=`. Throws Error where the config is not good.
std::vector<std::string> config_addresses(const std::string& config, const std::vector<std::filesystem::path>& folders);

/// The variants of the config's campaign. Throws Error where the file cannot be read.
std::vector<std::string> config_variants(const std::string& config);

}  // namespace pelorus::cli
