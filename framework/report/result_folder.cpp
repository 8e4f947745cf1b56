#include "report/result_folder.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "host/error.hpp"
#include "report/expected.hpp"
#include "report/json_file.hpp"

namespace pelorus::report {

namespace {

/// The file that stands where a folder should be made, or "".
std::filesystem::path file_in_the_way(std::filesystem::path folder) {
    std::error_code ignored;
    for (; !folder.empty(); folder = folder.parent_path()) {
        if (std::filesystem::exists(folder, ignored))
            return std::filesystem::is_directory(folder, ignored) ? std::filesystem::path() : folder;
        if (folder == folder.parent_path()) break;
    }
    return {};
}

/// What could not be written is told once all else is.
class Writer {
public:
    explicit Writer(const std::filesystem::path& folder) : folder_(folder) {}
    void write(const std::string& name, const std::string& text) {
        try {
            write_file(folder_ / name, text);
        } catch (const Error& error) {
            failures_ += (failures_.empty() ? "" : "; ") + std::string(error.what());
        }
    }
    void raise() const {
        if (!failures_.empty()) throw Error(Exit::run_failed, failures_);
    }

private:
    const std::filesystem::path& folder_;
    std::string failures_;
};

}  // namespace

void prepare_folder(const std::filesystem::path& folder) {
    std::error_code reason;
    const std::filesystem::path file = file_in_the_way(folder);
    if (!file.empty())
        throw Error(Exit::run_failed, "cannot make the result folder " + folder.string() + ": " + file.string() +
                                          " is a file; move it, or name another folder with --out");
    std::filesystem::create_directories(folder, reason);
    if (reason)
        throw Error(Exit::run_failed, "cannot make the result folder " + folder.string() + ": " + reason.message());
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

namespace {

constexpr const char* results[] = {"summary.json", "provenance.json", "timing.json", expected_file_name,
                                   page_file_name};

}  // namespace

bool is_result(const std::string& name) {
    return std::find(std::begin(results), std::end(results), name) != std::end(results);
}

void remove_results(const std::filesystem::path& folder) {
    for (const char* name : results) {
        std::error_code reason;
        std::filesystem::remove(folder / name, reason);
        if (reason)
            throw Error(Exit::run_failed, "cannot replace " + (folder / name).string() + ": " + reason.message());
    }
}

void write_result_folder(const std::filesystem::path& folder, const ResultFolder& contents) {
    prepare_folder(folder);
    Writer writer(folder);
    if (!contents.expected.empty()) writer.write(expected_file_name, contents.expected);
    writer.write("timing.json", json_text(contents.timing));
    writer.write("provenance.json", json_text(contents.provenance));
    writer.write("summary.json", json_text(contents.summary));  // last: where it is, the others are
    writer.raise();
}

void write_result_folder(const std::filesystem::path& folder, const graph::Graph& graph, const Cell& cell,
                         const Timings& timings, const RunContext& context, const std::string& expected) {
    write_result_folder(folder, {summary({cell}), provenance(graph, context), timing(timings), expected});
}

}  // namespace pelorus::report
