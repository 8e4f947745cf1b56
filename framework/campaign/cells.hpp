/// The cells of a campaign: one for each variant and grid point.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "graph/campaign_block.hpp"
#include "graph/document.hpp"
#include "graph/problems.hpp"

namespace pelorus::campaign {

/// What the command line says of a campaign.
struct Selection {
    std::vector<std::string> variants;  ///< --variant; none: all of them
    std::optional<std::uint64_t> runs;  ///< --runs
};

struct Cell {
    std::size_t index = 0;  ///< from 0, in the order of the summary
    std::string variant;    ///< "default" where the config has none
    /// What the sweep gives this cell, in the order of the file.
    std::vector<graph::Assignment> sweep;
    std::vector<graph::Assignment> overrides;  ///< of the variant
    nlohmann::ordered_json shown_sweep =
        nlohmann::ordered_json::object();  ///< as the summary has it; check_cells() fills it in
};

struct Plan {
    std::uint64_t runs = 1;  ///< of each cell
    bool goes_on = false;    ///< a failed run is counted, and the campaign goes on
    std::string reference;   ///< the variant that others are compared with, or ""
    std::vector<Cell> cells;
    /// One cell, run once: not a campaign.
    bool is_single_run() const { return cells.size() == 1 && runs == 1; }
};

/// Reads `campaign:` and lays the command line over it. Cells come out variants first, then axes in file order, the last one
/// fastest. Whoever overrides an address of an axis (`--set`, for all cells; a variant, for its own), or replaces a part that holds
/// it, removes that axis. What is wrong goes to `problems`; then the plan is of no use.
Plan plan_cells(const graph::Document& document, const Selection& selection, graph::Problems& problems);

/// The config of one cell.
graph::Document document_of(const graph::Document& document, const Cell& cell);

/// What stands at an address of a resolved config (Graph::resolved); null where nothing does.
nlohmann::ordered_json value_at(const nlohmann::ordered_json& resolved, const std::string& address);

/// The sweep's addresses and values, parameters in SI as the resolved config of the cell has them.
nlohmann::ordered_json sweep_json(const Cell& cell, const nlohmann::ordered_json& resolved);

/// `variant koch, world.sensors.radar.noise = 1 m`
std::string cell_text(const Cell& cell);

}  // namespace pelorus::campaign
