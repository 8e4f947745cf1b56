// Whole graphs in this process: empty ones, which cost what the runtime costs, and the recordings.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "graph/graph.hpp"
#include "host/catalog.hpp"
#include "host/log.hpp"
#include "runtime/runtime.hpp"

namespace pelorus::bench {

namespace {

constexpr int scans = 20000;

host::Catalog& catalog() {
    static host::Catalog all({PELORUS_PLUGIN_DIR, PELORUS_BENCH_DIR "/plugins"});
    return all;
}

struct Ran {
    double seconds = 0.0;
    std::uint64_t events = 0;  // emissions and messages, as runtime.hpp counts them
    std::uint64_t scans = 0;   // calls of the stage that takes them
};

/// Builds a graph and runs it; only the run is timed.
Ran run(const graph::Document& document, const std::string& receiver) {
    graph::BuildOptions build;
    build.output_folder = PELORUS_BENCH_DIR "/results";
    std::filesystem::create_directories(build.output_folder);
    graph::Graph graph = graph::Graph::build(document, catalog(), build);
    runtime::Runtime runtime(graph);
    Ran ran;
    runtime::RunOptions options;
    options.on_progress = [&ran](std::int64_t) { ++ran.events; };
    const auto start = std::chrono::steady_clock::now();
    runtime.run(options);
    ran.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const runtime::NodeTiming& node : runtime.timing())
        if (node.node == receiver) ran.scans = node.calls - 1;  // the last one is finish
    return ran;
}

void measure(benchmark::State& state, const graph::Document& document, const std::string& receiver) {
    Ran all;
    for (auto _ : state) {
        const Ran ran = run(document, receiver);
        state.SetIterationTime(ran.seconds);
        all.events += ran.events;
        all.scans += ran.scans;
    }
    state.counters["events_per_second"] =
        benchmark::Counter(static_cast<double>(all.events), benchmark::Counter::kIsRate);
    state.counters["scans_per_second"] =
        benchmark::Counter(static_cast<double>(all.scans), benchmark::Counter::kIsRate);
}

struct Empty {
    int measurements = 0, receivers = 1;
    bool feedback = false;
};

/// A source that costs nothing, and receivers that do nothing.
graph::Document empty_graph(const Empty& shape) {
    std::string text =
        "pelorus: 1\ngraph:\n  source:\n    use: source.bench_ticks\n    with: {scans: " + std::to_string(scans) +
        ", measurements: " + std::to_string(shape.measurements) + "}\n";
    if (shape.feedback)
        text +=
            "    in: {commands: previous(sink0.commands)}\n"
            "  sink0: {use: scheduler.bench_echo, in: {scans: source.scans}}\n";
    for (int i = shape.feedback ? 1 : 0; i < shape.receivers; ++i)
        text += "  sink" + std::to_string(i) + ": {use: sink.bench_nothing, in: {scans: source.scans}}\n";
    return graph::Document::parse(text, "empty graph", PELORUS_BENCH_DIR);
}

void add_empty(const char* name, const Empty& shape) {
    benchmark::RegisterBenchmark(name,
                                 [shape](benchmark::State& state) { measure(state, empty_graph(shape), "sink0"); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

void add_recording(const char* name, const std::string& config, const std::vector<std::string>& without) {
    benchmark::RegisterBenchmark(
        name,
        [=](benchmark::State& state) {
            std::vector<graph::Override> overrides;
            for (const std::string& node : without) overrides.push_back({node, "~"});
            host::set_log_level("error");  // what is wrong with a recording is known
            measure(state, graph::Document::load(PELORUS_SOURCE_DIR "/configs/" + config, overrides), "tracker");
        })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

[[maybe_unused]] const bool registered = [] {
    add_empty("empty_graph/empty_scans", {0, 1, false});
    add_empty("empty_graph/one_measurement", {1, 1, false});
    add_empty("empty_graph/hundred_measurements", {100, 1, false});
    add_empty("empty_graph/four_receivers", {1, 4, false});
    add_empty("empty_graph/feedback", {1, 1, true});
    add_recording("pipeline/recorded_radar", "recorded_radar.yaml", {});
    add_recording("pipeline/recorded_radar_without_sinks", "recorded_radar.yaml", {"files"});
    if (std::getenv("PELORUS_DATA") != nullptr) {
        add_recording("pipeline/ais_harbour", "ais_harbour.yaml", {});
        add_recording("pipeline/ais_harbour_without_sinks", "ais_harbour.yaml", {"files", "map"});
    }
    return true;
}();

}  // namespace

}  // namespace pelorus::bench
