/// provenance.json: what a result was made from. No wall-clock time, no place on the machine: the same config, seed,
/// binaries and processor write the same bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "graph/graph.hpp"

namespace pelorus::report {

/// What the graph does not know of the run.
struct RunContext {
    std::string config;  ///< the config file as given on the command line
    std::uint64_t runs = 1;
    bool stopped = false;                            ///< the run was stopped before its sources ended
    nlohmann::ordered_json campaign = nullptr;       ///< its variants and grid points, where it is one
    std::vector<const host::LoadedPlugin*> plugins;  ///< of all cells of a campaign; none: those of the graph
};

/// Host version, compiler, processor features that results depend on, and the mathematical library.
nlohmann::ordered_json build_facts();

/// Id, version and SHA-256 of each.
nlohmann::ordered_json plugins_json(const std::vector<const host::LoadedPlugin*>& plugins);

/// Of a campaign, `graph` is that of its first cell.
nlohmann::ordered_json provenance(const graph::Graph& graph, const RunContext& context);

}  // namespace pelorus::report
