/// timing.json: where the time went, and what the stages counted. The only file of a result folder that is different
/// every time.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/services.hpp"
#include "runtime/runtime.hpp"

namespace pelorus::report {

/// A node's time and its diagnostics (ABI diagnostics.h; the runtime adds `refused`).
struct NodeReport {
    runtime::NodeTiming timing;
    std::map<std::string, std::int64_t> counters;
    std::map<std::string, host::InstanceHost::Gauge> gauges;
};

struct Timings {
    double total_seconds = 0;       ///< wall time of the run
    std::vector<NodeReport> nodes;  ///< in file order
};

/// Of a run that took so long.
Timings timings_of(const graph::Graph& graph, const runtime::Runtime& runtime, double total_seconds);

/// `calls`, and the wall time in all of them, on average and in the longest one: `seconds`, `mean_seconds`, `max_seconds`.
nlohmann::ordered_json node_timing(const runtime::NodeTiming& timing);

nlohmann::ordered_json timing(const Timings& timings);

}  // namespace pelorus::report
