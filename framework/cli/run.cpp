// `pelorus run`: one config, one run, one result folder.
#include <cerrno>
#include <chrono>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "cli/command.hpp"
#include "cli/config_flags.hpp"
#include "cli/crash.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "cli/progress.hpp"
#include "graph/graph.hpp"
#include "graph/units.hpp"
#include "host/error.hpp"
#include "report/json_file.hpp"
#include "report/result_folder.hpp"
#include "report/terminal_table.hpp"
#include "runtime/runtime.hpp"
#include "runtime/time_text.hpp"

namespace pelorus::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* snapshot_name = "snapshot.plrsnap";

struct Request {
    fs::path out;  // the result folder
    std::optional<fs::path> resume;
    std::optional<std::int64_t> snapshot_at;  // ns
    bool stop_at_snapshot = false;
    unsigned threads = 1;
    host::GuardMode guard = host::GuardMode::start;
};

std::int64_t read_time(const std::string& flag, const std::string& text) {
    try {
        return graph::parse_time(text);
    } catch (const graph::UnitError& problem) {
        throw Error(Exit::misuse, "--" + flag + ": " + problem.what());
    }
}

Request read_request(const CommandLine& line) {
    Request request;
    if (line.has("resume")) request.resume = line.value("resume");
    const fs::path by_name = fs::path("results") / fs::path(line.argument(0)).stem();
    request.out = line.value("out", line.value("resume", by_name.string()));
    if (request.out.empty()) throw Error(Exit::misuse, "--out: expected a folder, got nothing");
    if (line.has("snapshot-at")) request.snapshot_at = read_time("snapshot-at", line.value("snapshot-at"));
    request.stop_at_snapshot = line.has("stop-at-snapshot");
    if (request.stop_at_snapshot && !request.snapshot_at)
        throw Error(Exit::misuse, "--stop-at-snapshot: --snapshot-at TIME is missing");
    request.guard = host::guard_mode(line.value("guard", "start"));
    request.threads = static_cast<unsigned>(line.number("threads", 1, 1024));
    return request;
}

std::vector<unsigned char> read_snapshot(const fs::path& folder) {
    const fs::path file = folder / snapshot_name;
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw Error(Exit::misuse, "--resume: cannot open " + file.string() + ": " +
                                      std::generic_category().message(errno) + "; a run with --snapshot-at writes it");
    std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad()) throw Error(Exit::run_failed, "--resume: cannot read " + file.string());
    return bytes;
}

/// What an earlier run has left here must not be taken for this one's if it comes to a bad end.
void remove_old_results(const fs::path& folder) {
    for (const char* name : {"summary.json", "provenance.json", "timing.json"}) {
        std::error_code reason;
        fs::remove(folder / name, reason);
        if (reason)
            throw Error(Exit::run_failed, "cannot replace " + (folder / name).string() + ": " + reason.message());
    }
}

struct Ending {
    runtime::Outcome outcome = runtime::Outcome::stopped;
    std::string failure;  // or ""
    double seconds = 0;
    std::optional<std::int64_t> reached;  // ns, arrival of the last event
};

Ending run_to_end(runtime::Runtime& runtime, const Request& request, Interrupt& interrupt) {
    Ending ending;
    Progress progress;
    const auto show = progress.callback();
    runtime::RunOptions options;
    options.stop = &interrupt.stop();
    options.on_progress = [&](std::int64_t arrival) {
        ending.reached = arrival;
        if (show) show(arrival);
    };
    options.snapshot_at = request.snapshot_at;
    options.on_snapshot = [&](const std::vector<unsigned char>& bytes) {
        report::write_file(request.out / snapshot_name, std::string(bytes.begin(), bytes.end()));
        if (request.stop_at_snapshot) interrupt.request();
    };
    const auto start = std::chrono::steady_clock::now();
    try {
        ending.outcome = runtime.run(options);
    } catch (const Error& problem) {
        ending.failure = problem.what();
    }
    ending.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return ending;
}

/// Says how the run ended unless it ended well, and answers the exit code.
Exit tell_ending(const Ending& ending, const Request& request, const Interrupt& interrupt) {
    const std::string reached = ending.reached ? runtime::seconds_text(*ending.reached) : "the start";
    const std::string kept = "; results up to there are in " + request.out.string();
    if (!ending.failure.empty()) {
        tell(ending.failure);
        tell("the run failed at " + reached + kept);
        return Exit::run_failed;
    }
    if (const char* signal = interrupt.signal()) {
        if (ending.outcome == runtime::Outcome::completed) return Exit::done;
        tell(fmt::format("stopped by {} at {}{}", signal, reached, kept));
        return Exit::run_failed;
    }
    if (request.stop_at_snapshot && ending.outcome == runtime::Outcome::completed)
        tell(fmt::format("the run ended at {}, before {}; the snapshot is of its end", reached,
                         runtime::seconds_text(*request.snapshot_at)));
    else if (request.stop_at_snapshot)
        tell("stopped at the snapshot" + kept + "; go on with the same CONFIG, --set and --seed, and --resume " +
             request.out.string());
    return Exit::done;
}

/// What `--json` prints of a run that came to an end, good or bad.
nlohmann::ordered_json result_json(const CommandLine& line, const Request& request, const Ending& ending,
                                   const report::Cell& cell) {
    nlohmann::ordered_json json{{"config", line.argument(0)},
                                {"completed", ending.outcome == runtime::Outcome::completed},
                                {"folder", request.out.string()},
                                {"files", report::file_names(request.out)},
                                {"summary", report::summary({cell})}};
    if (!ending.failure.empty()) json["error"] = ending.failure;
    return json;
}

int run(const CommandLine& line) {
    const Request request = read_request(line);
    Interrupt interrupt;  // from here on: a graph may take its time to be made
    host::Catalog catalog(plugin_folders(line));
    const graph::Document document = load_document(line);
    graph::BuildOptions build;
    build.threads = request.threads;
    build.guard = request.guard;
    build.output_folder = fs::absolute(request.out).lexically_normal().string();
    graph::Graph graph = graph::Graph::build(document, catalog, build);
    runtime::Runtime runtime(graph);
    if (request.resume) runtime.restore(read_snapshot(*request.resume));
    report::prepare_folder(request.out);
    remove_old_results(request.out);

    const CrashFolder crash_folder(request.out);
    const Ending ending = run_to_end(runtime, request, interrupt);
    const report::Timings timings = report::timings_of(graph, runtime, ending.seconds);
    report::RunContext context;
    context.config = line.argument(0);
    context.stopped = ending.outcome == runtime::Outcome::stopped;
    Exit exit = tell_ending(ending, request, interrupt);
    std::string files;
    try {
        report::write_result_folder(request.out, graph, runtime.results(), timings, context);
        files = report::file_line(request.out);
    } catch (const Error& problem) {  // the figures are printed all the same
        tell(std::string(problem.what()) + "; the figures are printed, but not all of them are kept");
        exit = Exit::run_failed;
    }
    tell_raw(report::counter_lines(timings));
    const report::Cell cell = report::cell_of_run(runtime.results());
    if (line.has("json"))
        print_json(result_json(line, request, ending, cell));
    else
        print((graph.title().empty() ? "" : graph.title() + "\n") + report::terminal_table({cell}) + files);
    return static_cast<int>(exit);
}

}  // namespace

Command run_command() {
    std::vector<Flag> flags = config_flags();
    flags.insert(flags.begin(), {"out", "DIR", "the result folder, instead of ./results/CONFIG-NAME"});
    flags.push_back({"threads", "N", "threads that plugins share (1 unless given, 0: one a core); same results"});
    flags.push_back(
        {"guard", "MODE",
         "which calls of models are checked against the contract: off, start (default: the first 16 of each "
         "function), all; same results"});
    flags.push_back({"snapshot-at", "TIME", "write the whole run's state at that time (50s) into the result folder"});
    flags.push_back({"stop-at-snapshot", "", "and end the run there"});
    flags.push_back({"resume", "DIR", "go on from the snapshot in DIR, with the same CONFIG and --set"});
    flags.push_back({"json", "", "the figures and the names of the files as JSON"});
    const std::string campaigns = "comes with campaigns, which are not in this version";
    return {"run",
            "run a config, print its figures, write a result folder",
            "Checks CONFIG like `pelorus check`, runs it to its end and writes summary.json, provenance.json and "
            "timing.json, and what the graph's sinks write, into the result folder. Figures go to standard output, "
            "everything else to standard error.\n\n"
            "The same config, seed and binaries give the same summary.json, byte for byte: with any number of threads, "
            "and when a run is ended at a snapshot and resumed. A resumed run writes into the folder that it comes "
            "from, unless --out names another; a snapshot of another config is refused.\n\n"
            "Ctrl-C (SIGINT), SIGTERM or SIGHUP ends a run in an orderly way: results so far are kept, exit code 1. A "
            "second "
            "one ends it at once.",
            {{"CONFIG"}, flags, {{"runs", "N", campaigns}, {"variant", "V", campaigns}}},
            {{"pelorus run configs/airship.yaml", "results in ./results/airship"},
             {"pelorus run c.yaml --set world.sensors.radar.noise=5m --out /tmp/r5", "another value, another folder"},
             {"pelorus run c.yaml --plugins ./build", "with a plugin that was just built"},
             {"pelorus run c.yaml --snapshot-at 50s --stop-at-snapshot", "half of it now ..."},
             {"pelorus run c.yaml --resume results/c", "... and the rest later"}},
            &run};
}

}  // namespace pelorus::cli
