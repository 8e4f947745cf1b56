#include "campaign/cell_pipeline.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

namespace pelorus::campaign {

namespace {

/// Instances are made and destroyed by one thread at a time in the whole process (ABI threads.h).
std::mutex& one_at_a_time() {
    static std::mutex mutex;
    return mutex;
}

graph::Graph planned(const PipelineContext& context, const Cell& cell, bool sinks) {
    const std::lock_guard<std::mutex> lock(one_at_a_time());
    graph::BuildOptions options;
    options.sinks = sinks;
    return graph::Graph::plan(document_of(context.document, cell), context.finder, options);
}

/// Destroys the graph's instances, whatever has become of the run.
class Clearing {
public:
    explicit Clearing(graph::Graph& graph) : graph_(graph) {}
    Clearing(const Clearing&) = delete;
    Clearing& operator=(const Clearing&) = delete;
    ~Clearing() {
        const std::lock_guard<std::mutex> lock(one_at_a_time());
        graph_.clear();
    }

private:
    graph::Graph& graph_;
};

}  // namespace

CellPipeline::CellPipeline(const PipelineContext& context, const Cell& cell)
    : context_(context), cell_(cell), graph_(planned(context, cell, false)) {}

CellPipeline::~CellPipeline() = default;

void CellPipeline::run(std::uint64_t number, Totals& totals) {
    graph::BuildOptions options;
    options.run = number;
    options.guard = context_.guard;
    if (context_.guard == host::GuardMode::start && number != 0) options.guard = host::GuardMode::off;
    if (cell_.index != 0 || number != 0) return execute(graph_, options, totals);
    options.output_folder = context_.output_folder;
    graph::Graph with_sinks = planned(context_, cell_, true);
    execute(with_sinks, options, totals);
}

void CellPipeline::execute(graph::Graph& graph, const graph::BuildOptions& options, Totals& totals) {
    const Clearing clearing(graph);
    std::unique_ptr<runtime::Runtime> runtime;
    {
        const std::lock_guard<std::mutex> lock(one_at_a_time());
        graph.renew(options);
        runtime = std::make_unique<runtime::Runtime>(runtime::wire(graph, runtime::Snapshots::none));
    }
    runtime::RunOptions how;
    how.stop = context_.stop;
    if (runtime->run(how) == runtime::Outcome::stopped) throw Stopped();
    totals.add(runtime->results(), options.run);
    add_timings(timings_, runtime->timing());
}

NodeTimings CellPipeline::take_timings() { return std::exchange(timings_, {}); }

void add_timings(NodeTimings& to, const NodeTimings& from) {
    for (const runtime::NodeTiming& node : from) {
        const auto same =
            std::find_if(to.begin(), to.end(), [&](const auto& candidate) { return candidate.node == node.node; });
        if (same == to.end()) {
            to.push_back(node);
            continue;
        }
        same->calls += node.calls;
        same->seconds += node.seconds;
        same->longest_seconds = std::max(same->longest_seconds, node.longest_seconds);
    }
}

}  // namespace pelorus::campaign
