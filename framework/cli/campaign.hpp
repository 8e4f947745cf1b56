/// `pelorus run` of a config with a campaign.
#pragma once

#include <filesystem>
#include <optional>

#include "campaign/prepare.hpp"
#include "cli/command_line.hpp"
#include "cli/interrupt.hpp"
#include "host/catalog.hpp"
#include "host/guard/mode.hpp"
#include "report/expected.hpp"

namespace pelorus::cli {

struct CampaignRequest {
    std::filesystem::path out;
    bool resume = false;  ///< --resume: what is in `out` must be this campaign's
    unsigned threads = 0;
    host::GuardMode guard = host::GuardMode::start;
    std::size_t part = 1, parts = 1;           ///< --cells PART/PARTS
    std::optional<report::Expected> expected;  ///< figures that are known of the config
};

/// The cells of a part: every PARTS-th.
std::vector<std::size_t> cells_of_part(std::size_t cells, std::size_t part, std::size_t parts);

/// Computes the campaign and writes the result folder. Answers the exit code. Throws Error.
int run_campaign(const CommandLine& line, const CampaignRequest& request, const graph::Document& document,
                 const graph::PluginFinder& finder, campaign::Prepared& prepared, Interrupt& interrupt);

}  // namespace pelorus::cli
