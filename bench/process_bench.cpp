// What takes a process of its own: loading plugins, checking configs, campaigns.
#include <sys/resource.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "../tests/fixtures/temporary_folder.hpp"
#include "../tests/support/process.hpp"

namespace pelorus::bench {

namespace {

using test::Ended;

/// Seconds of processor time, user and system, of the processes that have ended so far.
double processor_seconds() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Catalog and loading within a fresh process; the time of the process as a whole is told beside it.
void load_fifty(benchmark::State& state) {
    double found = 0.0, whole = 0.0;
    const double before = processor_seconds();
    for (auto _ : state) {
        const auto start = std::chrono::steady_clock::now();
        const Ended ended = test::run({PELORUS_BENCH_DIR "/load_all", PELORUS_BENCH_DIR "/loaded"});
        whole += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        int plugins = 0;
        double find = 0.0, load = 0.0;
        std::istringstream(ended.out) >> plugins >> find >> load;
        if (ended.exit != 0 || plugins != 50) return state.SkipWithError("the fifty plugins were not loaded");
        found += find * 1e-9;
        state.SetIterationTime((find + load) * 1e-9);
    }
    using benchmark::Counter;
    state.counters["find_s"] = Counter(found, Counter::kAvgIterations);
    state.counters["process_s"] = Counter(whole, Counter::kAvgIterations);
    state.counters["process_cpu_s"] = Counter(processor_seconds() - before, Counter::kAvgIterations);
}

void check(benchmark::State& state, const std::string& config, std::vector<std::string> flags = {}) {
    std::vector<std::string> words{"check", config};
    words.insert(words.end(), flags.begin(), flags.end());
    const double before = processor_seconds();
    for (auto _ : state) {
        const auto start = std::chrono::steady_clock::now();
        const Ended ended = test::pelorus_command(words);
        state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        if (ended.exit != 0) return state.SkipWithError(("pelorus check fails: " + ended.err).c_str());
    }
    state.counters["process_cpu_s"] =
        benchmark::Counter(processor_seconds() - before, benchmark::Counter::kAvgIterations);
}

/// The airship's campaign, two of its variants, 16 runs of each of their 18 cells; the whole process.
void campaign(benchmark::State& state, const std::string& threads) {
    const test::TemporaryFolder folder;
    int number = 0;
    for (auto _ : state) {
        const auto start = std::chrono::steady_clock::now();
        const Ended ended = test::pelorus_command({"run", PELORUS_SOURCE_DIR "/configs/airship.yaml", "--variant",
                                                   "published", "--variant", "best", "--runs", "16", "--set", "files=~",
                                                   "--threads", threads, "--out", folder / std::to_string(number++)});
        state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        if (ended.exit != 0) return state.SkipWithError(("the campaign fails: " + ended.err).c_str());
    }
}

/// A config of fifty nodes: a simulation, 24 trackers with a filter of their own each, 24 analyzers, a sink.
std::string fifty_nodes() {
    constexpr int trackers = 24;
    std::string text = R"(pelorus: 1
title: fifty nodes
graph:
  world:
    use: source.simulation
    with: {scans: 60, period: 2 s}
    parts:
      targets: {aircraft: {use: trajectory.legs, with: {start: [-5 km, 2 km, 1 km], speed: 120 m/s, heading: -20 deg}}}
      sensors: {radar: {use: sensor.spherical, with: {noise: [20 m, 1 mrad, 1 mrad], detection_probability: 95 %}}}
)";
    for (int i = 0; i < trackers; ++i) {
        const std::string name = "tracker" + std::to_string(i);
        text += "  " + name + R"(:
    use: tracker.point_target
    in: {scans: world.scans}
    with: {maximum_speed: 300 m/s, publish: all}
    parts:
      estimator:
        use: estimator.kalman
        parts:
          motion: {use: motion.singer, with: {maneuver_rate: 0.1 1/s, acceleration: )" +
                std::to_string(i + 1) + R"( m/s2}}
          sensors: {radar: {like: world.sensors.radar}}
  errors)" + std::to_string(i) +
                ": {use: analyzer.tracking_error, in: {tracks: " + name + ".tracks, truth: world.truth}}\n";
    }
    text += "  files: {use: sink.csv, in: {tracks: tracker0.tracks, truth: world.truth}}\n";
    const std::string file = PELORUS_BENCH_DIR "/fifty_nodes.yaml";
    std::ofstream(file) << text;
    return file;
}

template <class Function> void add(const char* name, const Function& function) {
    benchmark::RegisterBenchmark(name, function)->UseManualTime()->Unit(benchmark::kMillisecond);
}

[[maybe_unused]] const bool registered = [] {
    add("load/50_plugins", load_fifty);
    add("check/airship", [](benchmark::State& state) {
        check(state, PELORUS_SOURCE_DIR "/configs/airship.yaml",
              {"--variant", "published", "--set", "world.sensors.radar.noise=1m", "--set",
               "world.targets.airship.points_per_scan=16"});
    });
    add("check/airship_campaign",
        [](benchmark::State& state) { check(state, PELORUS_SOURCE_DIR "/configs/airship.yaml"); });
    add("check/50_nodes", [](benchmark::State& state) { check(state, fifty_nodes()); });
    add("campaign/1_thread", [](benchmark::State& state) { campaign(state, "1"); });
    add("campaign/2_threads", [](benchmark::State& state) { campaign(state, "2"); });
    return true;
}();

}  // namespace

}  // namespace pelorus::bench
