// `pelorus run`: one config, its run or its campaign, one result folder.
#include <cerrno>
#include <charconv>
#include <chrono>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "campaign/prepare.hpp"
#include "campaign/ranks.hpp"
#include "campaign/store.hpp"
#include "cli/campaign.hpp"
#include "cli/command.hpp"
#include "cli/config_flags.hpp"
#include "cli/crash.hpp"
#include "cli/expected.hpp"
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
    std::optional<unsigned> threads;
    host::GuardMode guard = host::GuardMode::start;
    std::optional<std::uint64_t> run;   // that one alone
    std::optional<std::uint64_t> cell;  // whose run
    std::size_t part = 1, parts = 1;    // of the campaign's cells
};

constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();

std::int64_t read_time(const std::string& flag, const std::string& text) {
    try {
        return graph::parse_time(text);
    } catch (const graph::UnitError& problem) {
        throw Error(Exit::misuse, "--" + flag + ": " + problem.what());
    }
}

/// `3/8`: the third of eight parts.
void read_part(const std::string& text, Request& request) {
    const std::size_t slash = text.find('/');
    const auto number = [&](std::size_t from, std::size_t to, std::size_t& into) {
        const auto [end, problem] = std::from_chars(text.data() + from, text.data() + to, into);
        return problem == std::errc() && end == text.data() + to && from < to;
    };
    if (slash == std::string::npos || !number(0, slash, request.part) ||
        !number(slash + 1, text.size(), request.parts) || request.part < 1 || request.part > request.parts)
        throw Error(Exit::misuse,
                    "--cells: expected I/N, the I-th of N parts (3/8 is the third of eight), got '" + text + "'");
}

Request read_request(const CommandLine& line) {
    Request request;
    if (line.has("resume")) request.resume = line.value("resume");
    std::string by_name = (fs::path("results") / fs::path(line.argument(0)).stem()).string();
    // A run out of a campaign does not go into the campaign's folder.
    for (const char* flag : {"cell", "run"})
        if (line.has(flag)) by_name += std::string("-") + flag + '-' + line.value(flag);
    request.out = line.value("out", line.value("resume", by_name));
    if (request.out.empty()) throw Error(Exit::misuse, "--out: expected a folder, got nothing");
    if (line.has("snapshot-at")) request.snapshot_at = read_time("snapshot-at", line.value("snapshot-at"));
    request.stop_at_snapshot = line.has("stop-at-snapshot");
    if (request.stop_at_snapshot && !request.snapshot_at)
        throw Error(Exit::misuse, "--stop-at-snapshot: --snapshot-at TIME is missing");
    request.guard = host::guard_mode(line.value("guard", "start"));
    if (line.has("threads")) request.threads = static_cast<unsigned>(line.number("threads", 1, 1024));
    if (line.has("run")) request.run = line.number("run", 0, most);
    if (line.has("cell")) request.cell = line.number("cell", 0, most);
    if (request.cell && !request.run) throw Error(Exit::misuse, "--cell: --run R is missing: which run of the cell?");
    if (line.has("cells")) read_part(line.value("cells"), request);
    if (request.run)
        for (const char* flag : {"cells", "runs"})
            if (line.has(flag)) throw Error(Exit::misuse, std::string("--run: one run alone has no --") + flag);
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

/// The config of one run.
struct OneRun {
    graph::Document document;
    std::optional<campaign::Cell> from;  // whose variant and sweep it has
};

/// Of `--run`: the run of a cell that is named; without one, of the graph as it stands, with the overrides of a variant that is
/// named.
OneRun chosen_run(const graph::Document& document, const campaign::Selection& selection, const Request& request) {
    graph::Problems problems;
    const campaign::Plan plan = campaign::plan_cells(document, selection, problems);
    if (!problems.empty() && selection.variants.empty() && !request.cell) return {document, {}};  // told by the check
    problems.raise();
    if (request.cell) {
        if (*request.cell >= plan.cells.size())
            throw Error(Exit::misuse,
                        fmt::format("--cell: there are cells 0 to {}, got {}", plan.cells.size() - 1, *request.cell));
        const campaign::Cell& cell = plan.cells[static_cast<std::size_t>(*request.cell)];
        return {campaign::document_of(document, cell), cell};
    }
    if (selection.variants.size() > 1)
        throw Error(Exit::misuse, "--run: one run has one variant; --variant is given " +
                                      std::to_string(selection.variants.size()) + " times");
    if (selection.variants.empty()) return {document, {}};
    campaign::Cell cell = plan.cells.front();
    cell.sweep.clear();
    return {campaign::document_of(document, cell), cell};
}

int run_once(const CommandLine& line, const Request& request, OneRun one, const graph::PluginFinder& finder,
             const std::optional<report::Expected>& expected, Interrupt& interrupt) {
    if (campaign::launched_rank() != 0) return static_cast<int>(Exit::done);  // one run is the business of one process
    graph::BuildOptions build;
    build.threads = request.threads.value_or(1);
    build.guard = request.guard;
    build.run = request.run.value_or(0);
    build.output_folder = fs::absolute(request.out).lexically_normal().string();
    graph::Graph graph = graph::Graph::build(one.document, finder, build);
    runtime::Runtime runtime(graph);
    if (request.resume) runtime.restore(read_snapshot(*request.resume));
    report::prepare_folder(request.out);
    if (fs::exists(campaign::campaign_file(request.out)))
        throw Error(Exit::misuse, request.out.string() + " holds a campaign; name another folder with --out");
    report::remove_results(request.out);

    const CrashFolder crash_folder(request.out);
    const Ending ending = run_to_end(runtime, request, interrupt);
    const report::Timings timings = report::timings_of(graph, runtime, ending.seconds);
    report::RunContext context;
    context.config = line.argument(0);
    context.stopped = ending.outcome == runtime::Outcome::stopped;
    report::Cell cell = report::cell_of_run(runtime.results());
    if (one.from) {
        cell.variant = one.from->variant;
        cell.sweep = campaign::sweep_json(*one.from, graph.resolved());
    }
    Exit exit = tell_ending(ending, request, interrupt);
    std::string files;
    try {
        report::write_result_folder(request.out, graph, cell, timings, context, expected ? expected->text : "");
        files = report::file_line(request.out);
    } catch (const Error& problem) {  // the figures are printed all the same
        tell(std::string(problem.what()) + "; the figures are printed, but not all of them are kept");
        exit = Exit::run_failed;
    }
    tell_raw(report::counter_lines(timings));
    nlohmann::ordered_json json = result_json(line, request, ending, cell);
    const std::string beside = tell_beside_expected(expected, json["summary"], &json);
    if (line.has("json"))
        print_json(json);
    else
        print((graph.title().empty() ? "" : graph.title() + "\n") + report::terminal_table({cell}) + beside + files);
    return static_cast<int>(exit);
}

CampaignRequest campaign_request(const CommandLine& line, const Request& request,
                                 std::optional<report::Expected> expected) {
    CampaignRequest made;
    made.expected = std::move(expected);
    made.out = request.out;
    made.resume = request.resume.has_value();
    made.threads = request.threads.value_or(0);
    made.guard = request.guard;
    made.part = request.part;
    made.parts = request.parts;
    if (request.snapshot_at)
        throw Error(Exit::misuse,
                    "--snapshot-at: this is a campaign, which keeps what is finished by itself; a run of it "
                    "alone, with --run R, can be snapshotted");
    if (request.resume && line.has("out") && request.out != *request.resume)
        throw Error(Exit::misuse, "--resume: a campaign goes on in its own folder; leave --out away");
    return made;
}

int run_here(const CommandLine& line) {
    const Request request = read_request(line);
    Interrupt interrupt;  // from here on: a graph may take its time to be made
    host::Catalog catalog(plugin_folders(line));
    const campaign::Selection selection = read_selection(line);
    const graph::Document document = load_document(line);
    const graph::PluginFinder finder = [&catalog](const std::string& id) -> const host::LoadedPlugin& {
        return catalog.load(id);
    };
    std::optional<report::Expected> expected = read_expected_of_config(line);
    if (request.run) return run_once(line, request, chosen_run(document, selection, request), finder, {}, interrupt);
    graph::Problems problems;
    const campaign::Plan plan = campaign::plan_cells(document, selection, problems);
    const bool is_campaign = !problems.empty() || !plan.is_single_run() || line.has("cells");
    if (!is_campaign) {
        const campaign::Cell& cell = plan.cells.front();
        return run_once(line, request, {campaign::document_of(document, cell), cell}, finder, expected, interrupt);
    }
    campaign::Prepared prepared = campaign::prepare(document, selection, finder);
    return run_campaign(line, campaign_request(line, request, std::move(expected)), document, finder, prepared,
                        interrupt);
}

int run(const CommandLine& line) {
    if (campaign::launched_rank() == 0) return run_here(line);
    try {
        return run_here(line);
    } catch (const Error& problem) {
        // Rank 0 meets the same as a rule, tells it, and the launcher ends us. What this machine alone meets is told by us.
        std::this_thread::sleep_for(std::chrono::seconds(2));
        tell(fmt::format("rank {}: {}", campaign::launched_rank(), problem.what()));
        return static_cast<int>(problem.exit());
    }
}

}  // namespace

Command run_command() {
    std::vector<Flag> flags = config_flags();
    flags.insert(flags.begin(), {"out", "DIR", "the result folder, instead of ./results/CONFIG-NAME"});
    for (const Flag& flag : campaign_flags()) flags.push_back(flag);
    flags.push_back({"cells", "I/N", "the I-th of N parts of the campaign's cells; `pelorus merge` joins them"});
    flags.push_back({"run", "R", "run number R alone: of the graph as it stands, with --variant V of that variant"});
    flags.push_back({"cell", "K", "with --run: of the campaign's cell K"});
    flags.push_back(
        {"threads", "N",
         "of a campaign: runs at a time (one a core unless given); of one run: threads that plugins share (1 "
         "unless given); 0: one a core; same results"});
    flags.push_back(
        {"guard", "MODE",
         "which calls of models are checked against the contract: off, start (default: the first 16 of each "
         "function), all; same results"});
    flags.push_back({"snapshot-at", "TIME", "write the whole run's state at that time (50s) into the result folder"});
    flags.push_back({"stop-at-snapshot", "", "and end the run there"});
    flags.push_back(
        {"resume", "DIR", "go on from the snapshot, or with the campaign, in DIR, with the same CONFIG and --set"});
    flags.push_back({"json", "", "the figures and the names of the files as JSON"});
    return {
        "run",
        "run a config, print its figures, write a result folder",
        "Checks CONFIG like `pelorus check`, runs it to its end and writes summary.json, provenance.json and "
        "timing.json, and what the graph's sinks write, into the result folder. Figures go to standard output, "
        "everything else to standard error.\n\n"
        "The same config, seed and binaries give the same summary.json, byte for byte: with any number of threads, "
        "and when a run is ended at a snapshot and resumed. A resumed run writes into the folder that it comes "
        "from, unless --out names another; a snapshot of another config is refused.\n\n"
        "A config with `campaign:` is run many times: each variant at each point of the sweep. What is finished is "
        "kept; "
        "the same command goes on with it after an interruption, --resume makes sure that it is the same campaign. "
        "Under "
        "an MPI launcher all ranks share the work.\n\n"
        "Ctrl-C (SIGINT), SIGTERM or SIGHUP ends a run in an orderly way: results so far are kept, exit code 1. A "
        "second "
        "one ends it at once.",
        {{"CONFIG"}, flags, {}},
        {{"pelorus run configs/airship.yaml", "results in ./results/airship"},
         {"pelorus run c.yaml --set world.sensors.radar.noise=5m --out /tmp/r5", "another value, another folder"},
         {"pelorus run c.yaml --plugins ./build", "with a plugin that was just built"},
         {"pelorus run c.yaml --variant koch --variant feldmann --runs 50", "two variants of a campaign, 50 runs each"},
         {"pelorus run c.yaml --cell 17 --run 3", "one run of a campaign"},
         {"pelorus run c.yaml --cells 2/8 --out part2", "the second of eight parts, for a job array"},
         {"mpirun -n 16 pelorus run c.yaml", "on many processors"},
         {"pelorus run c.yaml --snapshot-at 50s --stop-at-snapshot", "half of it now ..."},
         {"pelorus run c.yaml --resume results/c", "... and the rest later"}},
        &run};
}

}  // namespace pelorus::cli
