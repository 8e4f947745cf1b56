/// The folder that a run leaves behind.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "graph/graph.hpp"
#include "report/provenance.hpp"
#include "report/summary.hpp"
#include "report/timing.hpp"

namespace pelorus::report {

struct ResultFolder {
    nlohmann::ordered_json summary, provenance, timing;
    std::string expected = {};  ///< text of expected.yaml; "": there is none
};

/// Makes the folder (and those above it) if it is not there, and makes sure that files can be written in it: so before
/// a run, not after an hour. Throws Error (Exit::run_failed) with the path and the reason.
void prepare_folder(const std::filesystem::path& folder);

constexpr const char* page_file_name = "report.html";  ///< where `pelorus report` writes unless told otherwise

/// Whether a file of that name is written by Pelorus itself, about one result: JSON files, expected.yaml, the page.
bool is_result(const std::string& name);

/// Takes away what is_result of an earlier run: it must not be taken for this one's. Throws Error.
void remove_results(const std::filesystem::path& folder);

/// Writes summary.json, provenance.json, timing.json and expected.yaml, each whole or not at all, over what is there. Throws Error.
void write_result_folder(const std::filesystem::path& folder, const ResultFolder& contents);

/// The same for one run of a graph.
void write_result_folder(const std::filesystem::path& folder, const graph::Graph& graph, const Cell& cell,
                         const Timings& timings, const RunContext& context, const std::string& expected = {});

}  // namespace pelorus::report
