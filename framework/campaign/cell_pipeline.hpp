/// One cell's graph in the hands of one thread: runs it as often as wanted.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "campaign/cells.hpp"
#include "campaign/totals.hpp"
#include "graph/graph.hpp"
#include "runtime/runtime.hpp"

namespace pelorus::campaign {

/// What all pipelines of a process share. Outlives them.
struct PipelineContext {
    const graph::Document& document;
    const graph::PluginFinder& finder;        ///< may be called by several threads
    host::GuardMode guard;                    ///< start: run 0 of each cell alone is guarded
    std::string output_folder;                ///< where run 0 of cell 0 has its sinks write; the others have none
    const std::atomic<bool>* stop = nullptr;  ///< when set, runs end early with Stopped
};

/// The campaign is to end; the run under way has no results.
struct Stopped {};

/// Time spent in a node over all runs so far.
using NodeTimings = std::vector<runtime::NodeTiming>;

class CellPipeline {
public:
    /// Checks and plans the cell's config. Throws ConfigError. Both must outlive this object.
    CellPipeline(const PipelineContext& context, const Cell& cell);
    ~CellPipeline();

    std::size_t cell() const noexcept { return cell_.index; }
    /// Does a run with new instances and adds its results. Throws Error: the run failed; Stopped.
    void run(std::uint64_t number, Totals& totals);
    /// Of all runs since this was asked last.
    NodeTimings take_timings();

private:
    void execute(graph::Graph& graph, const graph::BuildOptions& options, Totals& totals);

    const PipelineContext& context_;
    const Cell& cell_;
    graph::Graph graph_;  // without sinks
    NodeTimings timings_;
};

/// Adds times node by node.
void add_timings(NodeTimings& to, const NodeTimings& from);

}  // namespace pelorus::campaign
