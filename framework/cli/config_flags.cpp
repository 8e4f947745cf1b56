#include "cli/config_flags.hpp"

#include <limits>

#include "host/error.hpp"
#include "host/services.hpp"

namespace pelorus::cli {

namespace fs = std::filesystem;

namespace {

graph::Override assignment(const std::string& text) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0)
        throw Error(Exit::misuse, "--set: expected ADDRESS=VALUE (world.sensors.radar.noise=5m), got '" + text + "'");
    return {text.substr(0, sign), text.substr(sign + 1)};
}

}  // namespace

Flag plugins_flag() { return {"plugins", "DIR", "look for plugins in this folder, and those below it, first", true}; }

std::vector<Flag> config_flags() {
    return {{"set", "ADDRESS=VALUE", "give a parameter of the config another value", true},
            {"seed", "N", "seed of all random numbers, instead of the config's run: {seed: N}"},
            plugins_flag(),
            {"log-level", "LEVEL", "trace, debug, info (default), warning or error"}};
}

std::vector<Flag> campaign_flags() {
    return {{"variant", "V", "that variant of the campaign, and no other that is not named as well", true},
            {"runs", "N", "runs of each variant and grid point, instead of the campaign's runs"}};
}

campaign::Selection read_selection(const CommandLine& line) {
    constexpr std::uint64_t most = 1'000'000'000;
    campaign::Selection selection;
    selection.variants = line.values("variant");
    if (!line.has("runs")) return selection;
    selection.runs = line.number("runs", 1, most, 1);
    return selection;
}

std::vector<fs::path> plugin_folders(const CommandLine& line) {
    std::vector<fs::path> folders;
    for (const std::string& folder : line.values("plugins")) {
        std::error_code reason;
        if (!fs::is_directory(folder, reason))
            throw Error(Exit::misuse,
                        "--plugins: " + folder + " is no folder" + (reason ? " (" + reason.message() + ")" : ""));
        folders.emplace_back(folder);
    }
    return host::Catalog::default_folders(folders);
}

graph::Document load_document(const CommandLine& line) {
    host::set_log_level(line.value("log-level", "info"));
    std::vector<graph::Override> overrides;
    for (const std::string& text : line.values("set")) overrides.push_back(assignment(text));
    if (line.has("seed"))
        overrides.push_back(
            {"run.seed", std::to_string(line.number("seed", 0, std::numeric_limits<std::uint64_t>::max()))});
    return graph::Document::load(line.argument(0), overrides);
}

}  // namespace pelorus::cli
