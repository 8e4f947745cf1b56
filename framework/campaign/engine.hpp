/// Computes the cells of a campaign: shares blocks of runs out among threads and ranks, and puts them together in order.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "campaign/cell_pipeline.hpp"
#include "campaign/cells.hpp"
#include "campaign/ranks.hpp"
#include "campaign/store.hpp"
#include "campaign/workers.hpp"

namespace pelorus::campaign {

/// How far a campaign has come.
struct Advance {
    std::size_t cells = 0, cells_done = 0;
    std::uint64_t runs = 0, runs_done = 0;
    std::uint64_t runs_kept = 0;  ///< of those done: what an earlier process had finished
    std::uint64_t runs_failed = 0;
};

struct EngineOptions {
    unsigned threads = 1;            ///< of each rank
    std::vector<std::size_t> cells;  ///< which cells of the plan, ascending
    std::string identity;            ///< what is computed: ranks that mean something else are refused
    /// Called ten times a second, and at the end, by the thread that called compute().
    std::function<void(const Advance&)> on_progress;
};

struct EngineResult {
    bool completed = false;          ///< all cells are in the store
    std::optional<Failure> failure;  ///< the first one by cell and run, where the plan does not go on
    Advance advance;
    NodeTimings timings;  ///< over all threads and ranks
};

/// Computes what the store does not have, and keeps it there as it comes. Called on rank 0; the other ranks serve(). Ends early when
/// context.stop is set or a run fails that must not. Throws Error: the store cannot be written.
EngineResult compute(const PipelineContext& context, const Plan& plan, const EngineOptions& options, Store& store,
                     Ranks* ranks);

/// What all ranks but the first do: compute blocks for it until it says that all is done.
void serve(const PipelineContext& context, const Plan& plan, const EngineOptions& options, Ranks& ranks);

}  // namespace pelorus::campaign
