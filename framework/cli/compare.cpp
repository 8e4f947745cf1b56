// `pelorus compare`: two result folders side by side.
#include <fmt/format.h>

#include "campaign/finished_cell.hpp"
#include "campaign/store.hpp"
#include "cli/command.hpp"
#include "cli/output.hpp"
#include "cli/page.hpp"
#include "host/error.hpp"
#include "report/comparison.hpp"
#include "report/json_file.hpp"
#include "report/page.hpp"

namespace pelorus::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The cells of two campaigns, run by run.
report::PairedCells paired_cells(const fs::path& a, const fs::path& b) {
    return [a, b, of_a = finished_cells(a), of_b = finished_cells(b)](std::size_t cell_a, std::size_t cell_b) -> Json {
        if (cell_a >= of_a.size() || cell_b >= of_b.size()) return nullptr;
        return campaign::paired_differences(campaign::Store(b).cell(of_b[cell_b]),
                                            campaign::Store(a).cell(of_a[cell_a]));
    };
}

int compare_folders(const CommandLine& line) {
    const std::vector<std::string> formats = plot_formats(line);
    if (!formats.empty() && !line.has("html"))
        throw Error(Exit::misuse, "--plot: --html FILE is missing: the plots are those of the page");
    const report::Result a = report::read_result(line.argument(0)), b = report::read_result(line.argument(1));
    const Json comparison = report::compare(a, b, paired_cells(a.folder, b.folder));
    if (line.has("html")) {
        const fs::path file = line.value("html");
        if (file.empty()) throw Error(Exit::misuse, "--html: expected a file, got nothing");
        const std::string title = a.title() == b.title() ? a.title() : a.title() + " / " + b.title();
        const Json page{{"kind", "comparison"},
                        {"title", title},
                        {"lead", fmt::format("A: {} · B: {}", a.folder.string(), b.folder.string())},
                        {"version", PELORUS_VERSION},
                        {"notes", Json::array()}};
        report::write_file(file, report::html_page(page_parts(), title, {{"page", page}, {"compare", comparison}}));
        tell("the page: " + file.string());
        for (const std::string& plot : write_plots_of(file, formats)) tell("a plot: " + plot);
    }
    if (line.has("json"))
        print_json(comparison);
    else
        print(report::comparison_table(comparison));
    return static_cast<int>(Exit::done);
}

}  // namespace

Command compare_command() {
    return {"compare",
            "two result folders side by side",
            "Prints for each scalar that both results have its value in A, its value in B, the difference B - A and "
            "the half width of its 95 % "
            "confidence interval, `*` where the difference is larger; and what they have not in common. Cells belong "
            "together that have the same "
            "variant and the same grid point; where each result has one variant alone, these are compared.\n\n"
            "Results of the same seed and the same number of runs share their random numbers: then differences are "
            "taken run by run.",
            {{"A", "B"},
             {{"html", "FILE", "the same as a page, with plots"}, plot_flag(), {"json", "", "the same as JSON"}},
             {}},
            {{"pelorus compare results/before results/after", "what a change has done"},
             {"pelorus compare results/koch results/feldmann --html compare.html", "two variants, as a page"}},
            &compare_folders};
}

}  // namespace pelorus::cli
