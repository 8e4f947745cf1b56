#include "report/result_folder.hpp"

#include <system_error>

#include "host/error.hpp"
#include "report/json_file.hpp"

namespace pelorus::report {

void prepare_folder(const std::filesystem::path& folder) {
    std::error_code reason;
    std::filesystem::create_directories(folder, reason);
    if (reason)
        throw Error(Exit::run_failed, "cannot make the result folder " + folder.string() + ": " + reason.message());
    if (!std::filesystem::is_directory(folder, reason))
        throw Error(Exit::run_failed,
                    "cannot make the result folder " + folder.string() + ": a file of that name is in the way");
    const std::filesystem::path trial = folder / ".writable";
    try {
        write_file(trial, "");
    } catch (const Error& error) {
        const std::string text = error.what();  // "cannot write PATH: REASON"; the user never named that path
        const std::size_t colon = text.rfind(": ");
        throw Error(error.exit(), "the result folder " + folder.string() + " cannot be written" +
                                      (colon == std::string::npos ? "" : text.substr(colon)));
    }
    std::filesystem::remove(trial, reason);
}

void write_result_folder(const std::filesystem::path& folder, const ResultFolder& contents) {
    prepare_folder(folder);
    write_file(folder / "timing.json", json_text(contents.timing));
    write_file(folder / "provenance.json", json_text(contents.provenance));
    write_file(folder / "summary.json", json_text(contents.summary));  // last: where it is, the others are
}

void write_result_folder(const std::filesystem::path& folder, const graph::Graph& graph,
                         const runtime::Results& results, const Timings& timings, const RunContext& context) {
    write_result_folder(folder, {summary({cell_of_run(results)}), provenance(graph, context), timing(timings)});
}

}  // namespace pelorus::report
