// `pelorus merge`: the parts of a campaign that job arrays have computed become one result folder.
#include <algorithm>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "campaign/cell_pipeline.hpp"
#include "campaign/prepare.hpp"
#include "campaign/store.hpp"
#include "campaign/summary_of_cells.hpp"
#include "cli/command.hpp"
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

Json without_part(Json identity) {
    identity.erase("part");
    return identity;
}

Json read_identity(const fs::path& folder) {
    const std::optional<Json> identity = campaign::Store(folder).identity();
    if (!identity)
        throw Error(Exit::misuse,
                    folder.string() + " holds no campaign; `pelorus run CONFIG --cells I/N` makes a part of one");
    return without_part(*identity);
}

Json read_result(const fs::path& folder, const std::string& name) {
    std::ifstream stream(folder / name, std::ios::binary);
    Json json = stream ? Json::parse(stream, nullptr, false) : Json();
    if (!json.is_object())
        throw Error(Exit::run_failed, "cannot read " + (folder / name).string() + "; let that part come to its end");
    return json;
}

/// Which folder has which cell. Throws Error where one is nowhere.
std::map<std::size_t, fs::path> find_cells(const std::vector<fs::path>& folders, std::size_t count) {
    std::map<std::size_t, fs::path> found;
    std::string missing;
    std::size_t missing_count = 0;
    for (std::size_t cell = 0; cell < count; ++cell) {
        const auto has_it = [cell](const fs::path& folder) { return campaign::Store(folder).has_cell(cell); };
        const auto folder = std::find_if(folders.begin(), folders.end(), has_it);
        if (folder != folders.end()) {
            found.emplace(cell, *folder);
            continue;
        }
        constexpr std::size_t most_told = 10;
        if (++missing_count <= most_told) missing += (missing.empty() ? "" : ", ") + std::to_string(cell);
        if (missing_count == most_told + 1) missing += ", ...";
    }
    if (missing_count > 0)
        throw Error(Exit::run_failed,
                    fmt::format("{} of {} cells are in none of the folders: {}; finish the parts that they "
                                "belong to, and name all parts",
                                missing_count, count, missing));
    return found;
}

/// What sinks have written of the first run, and the figures that were expected.
void copy_sink_files(const fs::path& from, const fs::path& to) {
    for (const std::string& name : report::file_names(from)) {
        const bool is_of_part = from / name == campaign::campaign_file(from) ||
                                (report::is_result(name) && name != report::expected_file_name);
        std::error_code reason;
        if (!is_of_part) fs::copy_file(from / name, to / name, fs::copy_options::overwrite_existing, reason);
        if (reason) throw Error(Exit::run_failed, "cannot write " + (to / name).string() + ": " + reason.message());
    }
}

Json merged_timing(const std::vector<fs::path>& folders) {
    Json sum{{"total_seconds", 0.0}, {"parts", folders.size()}, {"runs", 0}, {"nodes", Json::object()}};
    campaign::NodeTimings timings;
    for (const fs::path& folder : folders) {
        const Json timing = read_result(folder, "timing.json");
        sum["total_seconds"] = sum["total_seconds"].get<double>() + timing.value("total_seconds", 0.0);
        sum["runs"] = sum["runs"].get<std::uint64_t>() + timing.value("runs", std::uint64_t{0});
        const Json nodes = timing.value("nodes", Json::object());
        campaign::NodeTimings of_part;
        for (const auto& [name, node] : nodes.items())
            of_part.push_back({name, node.value("calls", std::uint64_t{0}), node.value("seconds", 0.0),
                               node.value("max_seconds", 0.0)});
        campaign::add_timings(timings, of_part);
    }
    for (const runtime::NodeTiming& node : timings) sum["nodes"][node.node] = report::node_timing(node);
    return sum;
}

std::vector<fs::path> read_folders(const CommandLine& line, const fs::path& out) {
    std::vector<fs::path> folders;
    for (const std::string& folder : line.arguments()) {
        std::error_code ignored;
        if (fs::equivalent(folder, out, ignored))
            throw Error(Exit::misuse, "--out: " + out.string() + " is one of the parts; name another folder");
        folders.emplace_back(folder);
    }
    return folders;
}

int merge(const CommandLine& line) {
    const fs::path out = line.value("out");
    if (out.empty()) throw Error(Exit::misuse, "merge: --out DIR is missing: where shall the result go?");
    const std::vector<fs::path> folders = read_folders(line, out);
    const Json identity = read_identity(folders.front());
    for (const fs::path& folder : folders) {
        const std::string differs = campaign::difference(read_identity(folder), identity);
        if (!differs.empty())
            throw Error(Exit::misuse, fmt::format("{} and {} are parts of different campaigns: {}", folder.string(),
                                                  folders.front().string(), differs));
    }
    const std::map<std::size_t, fs::path> found = find_cells(folders, identity.at("cells").size());
    Json provenance = read_result(folders.front(), "provenance.json");
    provenance["completed"] = true;
    const Json timing = merged_timing(folders);

    campaign::Store store(out);
    store.lock();
    report::remove_results(out);
    store.begin(identity);
    std::vector<std::size_t> cells;
    for (const auto& [cell, folder] : found) {
        store.finish(cell, campaign::Store(folder).cell(cell));
        cells.push_back(cell);
    }
    copy_sink_files(found.at(0), out);
    const Json summary = campaign::summary_of_cells(store, cells, identity.at("reference").get<std::string>());
    report::write_result_folder(out, {summary, provenance, timing});
    const std::string title = provenance.value("title", std::string());
    Json json{{"folder", out.string()}, {"files", report::file_names(out)}, {"summary", summary}};
    const std::string beside =
        tell_beside_expected(report::read_expected(out / report::expected_file_name), summary, &json);
    if (line.has("json"))
        print_json(json);
    else
        print((title.empty() ? "" : title + "\n") + report::campaign_table(summary) + beside + report::file_line(out));
    return static_cast<int>(Exit::done);
}

}  // namespace

Command merge_command() {
    Grammar grammar{{"DIR"}, {{"out", "DIR", "where the whole result goes"}, {"json", "", "the figures as JSON"}}, {}};
    grammar.last_repeats = true;
    return {"merge",
            "join the parts of a campaign",
            "Takes the folders that `pelorus run CONFIG --cells 1/N` to `N/N` have written, and writes the one that an "
            "undivided "
            "campaign would have: summary.json is the same, byte for byte. Parts of different campaigns are refused, "
            "and so "
            "is a set of parts in which a cell is missing.",
            grammar,
            {{"pelorus merge part1 part2 part3 --out results/c", "three parts of a job array"}},
            &merge};
}

}  // namespace pelorus::cli
