/// What is done before a campaign's first run: every cell is checked, and what it will compute is written down.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "campaign/cells.hpp"
#include "graph/graph.hpp"
#include "graph/problems.hpp"

namespace pelorus::campaign {

struct Prepared {
    Plan plan;                                       ///< with the sweep of each cell as shown
    nlohmann::ordered_json determinants;             ///< of each cell: what of its config determines its results
    std::optional<graph::Graph> first;               ///< of cell 0, with instances
    std::vector<const host::LoadedPlugin*> plugins;  ///< of all cells, sorted by id
};

/// Plans the cells and checks each of them: wiring, values, instances. Throws ConfigError with all that is wrong with any, each told
/// once. [main]
Prepared prepare(const graph::Document& document, const Selection& selection, const graph::PluginFinder& finder);

/// All that determines the results. Reads the plugins' files, for their SHA-256.
nlohmann::ordered_json identity_of(const Prepared& prepared);

/// The first thing in which two identities differ, in words; "" if they do not.
std::string difference(const nlohmann::ordered_json& there, const nlohmann::ordered_json& here);

/// What provenance.json says of a campaign.
nlohmann::ordered_json campaign_json(const Plan& plan);

}  // namespace pelorus::campaign
