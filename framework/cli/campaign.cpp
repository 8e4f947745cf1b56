#include "cli/campaign.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "campaign/engine.hpp"
#include "campaign/ranks.hpp"
#include "campaign/summary_of_cells.hpp"
#include "cli/campaign_progress.hpp"
#include "cli/crash.hpp"
#include "cli/expected.hpp"
#include "cli/output.hpp"
#include "report/campaign_table.hpp"
#include "report/json_file.hpp"
#include "report/result_folder.hpp"
#include "report/terminal_table.hpp"
#include "report/timing.hpp"

namespace pelorus::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// As a shell reads it back.
std::string quoted(const std::string& word) {
    const bool is_plain = !word.empty() && word.find_first_not_of(
                                               "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                               "0123456789_-+=./,:@%") == std::string::npos;
    if (is_plain) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

/// The command line that names the same campaign.
std::string same_campaign(const CommandLine& line) {
    std::string text = "pelorus run " + quoted(line.argument(0));
    for (const char* flag : {"plugins", "set", "variant", "seed"})
        for (const std::string& value : line.values(flag)) text += fmt::format(" --{} {}", flag, quoted(value));
    return text;
}

unsigned thread_count(const CampaignRequest& request, const campaign::Ranks* ranks) {
    if (request.threads != 0) return request.threads;
    // Who starts ranks says by their number how many cores there are to take.
    return ranks != nullptr ? 1 : std::max(1u, std::thread::hardware_concurrency());
}

Json timing_json(const campaign::EngineResult& result, double seconds, unsigned threads, int ranks) {
    Json json{{"total_seconds", seconds},
              {"threads", threads},
              {"ranks", ranks},
              {"runs", result.advance.runs_done - result.advance.runs_kept},
              {"nodes", Json::object()}};
    for (const runtime::NodeTiming& node : result.timings) json["nodes"][node.node] = report::node_timing(node);
    return json;
}

/// What the store has, made sure that it is this campaign's.
void take_up(campaign::Store& store, const CampaignRequest& request, const Json& identity) {
    const std::optional<Json> there = store.identity();
    const std::string differs = there ? campaign::difference(*there, identity) : std::string();
    if (there && request.resume && !differs.empty())
        throw Error(Exit::misuse,
                    fmt::format("--resume: {} holds another campaign: {}", request.out.string(), differs));
    if (there && differs.empty()) return;
    if (request.resume && !there) tell(request.out.string() + " holds no campaign yet: it begins now");
    store.begin(identity);
}

void tell_failure(const CommandLine& line, const campaign::Plan& plan, std::size_t cell, std::uint64_t run,
                  std::uint64_t seed, const std::string& message) {
    tell(fmt::format("run {} of cell {} ({}), seed {}: {}", run, cell, campaign::cell_text(plan.cells[cell]), seed,
                     message));
    tell(fmt::format("alone: {} --cell {} --run {}", same_campaign(line), cell, run));
}

/// Failures that were gone on from. Answers whether a cell has no run that went well.
bool tell_failed_runs(const CommandLine& line, const campaign::Prepared& prepared, const Json& summary,
                      const std::vector<std::size_t>& cells) {
    constexpr int most = 10;
    int told = 0;
    bool is_any_empty = false;
    std::size_t entry = 0;
    for (const std::size_t cell : cells) {
        const Json& json = summary["cells"][entry++];
        const auto failed = json.value("failed", std::uint64_t{0});
        if (failed == 0) continue;
        is_any_empty = is_any_empty || failed == json.at("runs").get<std::uint64_t>();
        if (++told > most) continue;
        tell_failure(line, prepared.plan, cell, json.at("failed_runs")[0].get<std::uint64_t>(), prepared.first->seed(),
                     json.at("failure").get<std::string>() +
                         (failed > 1 ? fmt::format(" (and {} more of this cell)", failed - 1) : ""));
    }
    if (told > most) tell(fmt::format("{} more cells have failed runs; summary.json names them", told - most));
    return is_any_empty;
}

/// A campaign on its way from the store to the result folder.
class Campaign {
public:
    Campaign(const CommandLine& line, const CampaignRequest& request, const graph::Document& document,
             const graph::PluginFinder& finder, campaign::Prepared& prepared, Interrupt& interrupt)
        : line_(line),
          request_(request),
          prepared_(prepared),
          identity_(campaign::identity_of(prepared)),
          interrupt_(interrupt),
          context_{document, finder, request.guard, fs::absolute(request.out).lexically_normal().string(),
                   &interrupt.stop()} {
        options_.cells = cells_of_part(prepared.plan.cells.size(), request.part, request.parts);
        options_.identity = identity_.dump(-1, ' ', false, Json::error_handler_t::replace);
    }

    int run() {
        std::unique_ptr<campaign::Ranks> ranks;
        if (campaign::is_started_by_mpi()) ranks = campaign::open_ranks();
        options_.threads = thread_count(request_, ranks.get());
        if (ranks != nullptr && ranks->rank() != 0) {
            campaign::serve(context_, prepared_.plan, options_, *ranks);
            return static_cast<int>(Exit::done);
        }
        campaign::Store store(request_.out);
        store.lock();
        take_up(store, request_, identity());
        report::remove_results(request_.out);
        const CrashFolder crash_folder(request_.out);
        const auto start = std::chrono::steady_clock::now();
        campaign::EngineResult result = compute(store, ranks.get());
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return finish(store, result,
                      timing_json(result, seconds, options_.threads, ranks == nullptr ? 1 : ranks->size()));
    }

private:
    Json identity() const {
        Json identity = identity_;
        if (request_.parts > 1) identity["part"] = fmt::format("{}/{}", request_.part, request_.parts);
        return identity;
    }

    campaign::EngineResult compute(campaign::Store& store, campaign::Ranks* ranks) {
        CampaignProgress progress;
        bool is_first = true;
        options_.on_progress = [&](const campaign::Advance& advance) {
            if (is_first && advance.runs_kept > 0)
                tell(fmt::format("going on in {}: {} of {} runs were done", request_.out.string(), advance.runs_kept,
                                 advance.runs));
            is_first = false;
            progress.show(advance);
        };
        try {
            return campaign::compute(context_, prepared_.plan, options_, store, ranks);
        } catch (const Error& problem) {  // told at once: MPI ends the process when other ranks are left behind
            if (ranks != nullptr) tell(problem.what());
            throw;
        }
    }

    report::RunContext run_context(bool completed) const {
        report::RunContext context;
        context.config = line_.argument(0);
        context.runs = prepared_.plan.runs;
        context.stopped = !completed;
        context.plugins = prepared_.plugins;
        context.campaign = campaign::campaign_json(prepared_.plan);
        return context;
    }

    Exit tell_ending(const campaign::EngineResult& result, const Json& summary) const {
        const campaign::Advance& advance = result.advance;
        const std::string kept = fmt::format("{} of {} runs are done and kept in {}", advance.runs_done, advance.runs,
                                             request_.out.string());
        if (result.failure) {
            const campaign::Failure& failure = *result.failure;
            tell_failure(line_, prepared_.plan, failure.cell, failure.run, prepared_.first->seed(), failure.message);
            tell("the campaign ends there; `on_failure: continue` counts failed runs instead. " + kept);
            return Exit::run_failed;
        }
        if (!result.completed) {
            const char* signal = interrupt_.signal();
            tell(fmt::format("stopped{}: {}; go on: {}{}{} --resume {}",
                             signal != nullptr ? std::string(" by ") + signal : "", kept, same_campaign(line_),
                             line_.has("runs") ? " --runs " + line_.value("runs") : "",
                             request_.parts > 1 ? fmt::format(" --cells {}/{}", request_.part, request_.parts) : "",
                             quoted(request_.out.string())));
            return Exit::run_failed;
        }
        if (advance.runs_failed == 0) return Exit::done;
        const bool is_any_empty = tell_failed_runs(line_, prepared_, summary, options_.cells);
        tell(fmt::format("{} of {} runs failed and are left out", advance.runs_failed, advance.runs));
        if (is_any_empty) tell("all runs of a cell failed: it has no result");
        return is_any_empty ? Exit::run_failed : Exit::done;
    }

    int finish(const campaign::Store& store, const campaign::EngineResult& result, const Json& timing) {
        const Json summary = campaign::summary_of_cells(store, options_.cells, prepared_.plan.reference);
        Exit exit = tell_ending(result, summary);
        std::string files;
        try {
            report::write_result_folder(
                request_.out, {summary, report::provenance(*prepared_.first, run_context(result.completed)), timing,
                               request_.expected ? request_.expected->text : ""});
            files = report::file_line(request_.out);
        } catch (const Error& problem) {  // the figures are printed all the same
            tell(std::string(problem.what()) + "; the figures are printed, but not all of them are kept");
            exit = Exit::run_failed;
        }
        Json json{{"config", line_.argument(0)},
                  {"completed", result.completed},
                  {"folder", request_.out.string()},
                  {"files", report::file_names(request_.out)},
                  {"summary", summary}};
        const std::string beside = tell_beside_expected(request_.expected, summary, &json);
        if (line_.has("json"))
            print_json(json);
        else
            print((prepared_.first->title().empty() ? "" : prepared_.first->title() + "\n") +
                  report::campaign_table(summary) + beside + files);
        return static_cast<int>(exit);
    }

    const CommandLine& line_;
    const CampaignRequest& request_;
    campaign::Prepared& prepared_;
    const Json identity_;  // of the whole campaign
    Interrupt& interrupt_;
    campaign::PipelineContext context_;
    campaign::EngineOptions options_;
};

}  // namespace

std::vector<std::size_t> cells_of_part(std::size_t cells, std::size_t part, std::size_t parts) {
    std::vector<std::size_t> chosen;
    for (std::size_t cell = part - 1; cell < cells; cell += parts) chosen.push_back(cell);
    return chosen;
}

int run_campaign(const CommandLine& line, const CampaignRequest& request, const graph::Document& document,
                 const graph::PluginFinder& finder, campaign::Prepared& prepared, Interrupt& interrupt) {
    return Campaign(line, request, document, finder, prepared, interrupt).run();
}

}  // namespace pelorus::cli
