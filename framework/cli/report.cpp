// `pelorus report`: a result folder as one HTML file, and its plots as images.
#include <fmt/format.h>

#include "cli/command.hpp"
#include "cli/output.hpp"
#include "cli/page.hpp"
#include "host/error.hpp"
#include "report/json_file.hpp"
#include "report/page.hpp"
#include "report/result_folder.hpp"

namespace pelorus::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

int report_folder(const CommandLine& line) {
    const std::vector<std::string> formats = plot_formats(line);
    const report::Result result = report::read_result(line.argument(0));
    const fs::path file = line.value("out", (result.folder / report::page_file_name).string());
    if (file.empty()) throw Error(Exit::misuse, "--out: expected a file, got nothing");
    report::write_file(file, report::html_page(page_parts(), result.title(),
                                               report::report_blocks(result, samples_of(result.folder))));
    tell_page(line, file, formats);
    return static_cast<int>(Exit::done);
}

}  // namespace

Command report_command() {
    return {"report",
            "show a result folder as one HTML page",
            "Writes what is in the result folder DIR as one HTML file: figures beside what is expected of them, all "
            "variants at all grid points, "
            "errors over time, the scene with truth, tracks, measurements and extents, distributions, provenance. The "
            "file loads nothing: it opens "
            "offline, and can be sent to others as it is.\n\n"
            "--plot writes each plot of the page as an image as well. Chromium draws them, which must be installed for "
            "that.",
            {{"DIR"},
             {{"out", "FILE", "the page, instead of DIR/report.html"},
              plot_flag(),
              {"json", "", "the names of the files as JSON"}},
             {}},
            {{"pelorus report results/airship", "writes results/airship/report.html"},
             {"pelorus report results/airship --plot svg --plot png",
              "and its plots for a paper, in results/airship/plots"}},
            &report_folder};
}

}  // namespace pelorus::cli
