/// The addresses that --set can give values.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pelorus::cli {

/// Every parameter in the config's graph, `world.period=`; and `run.seed=`. Throws Error where the config is not good.
std::vector<std::string> config_addresses(const std::string& config, const std::vector<std::filesystem::path>& folders);

}  // namespace pelorus::cli
