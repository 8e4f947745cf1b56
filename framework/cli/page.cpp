#include "cli/page.hpp"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "campaign/store.hpp"
#include "cli/output.hpp"
#include "cli/project.hpp"
#include "host/error.hpp"
#include "report/browser.hpp"

namespace pelorus::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json rounded(const Json& values) {
    Json list = Json::array();
    for (const Json& value : values)
        list.push_back(value.is_number()
                           ? Json(std::strtod(fmt::format("{:.6g}", value.get<double>()).c_str(), nullptr))
                           : Json(nullptr));
    return list;
}

}  // namespace

Flag plot_flag() {
    return {"plot", "FORMAT", "write each plot as an image, png or svg, into the folder plots beside the page", true};
}

std::vector<std::string> plot_formats(const CommandLine& line) {
    std::vector<std::string> formats = line.values("plot");
    for (const std::string& format : formats)
        if (format != "png" && format != "svg")
            throw Error(Exit::misuse, "--plot: expected png or svg, got '" + format + "'");
    return formats;
}

fs::path page_parts() { return executable_folder().parent_path() / "share" / "pelorus" / "report"; }

std::vector<std::size_t> finished_cells(const fs::path& folder) {
    const campaign::Store store(folder);
    const std::optional<Json> identity = store.identity();
    std::vector<std::size_t> cells;
    if (!identity || !identity->contains("cells")) return cells;
    for (std::size_t cell = 0; cell < identity->at("cells").size(); ++cell)
        if (store.has_cell(cell)) cells.push_back(cell);
    return cells;
}

Json samples_of(const fs::path& folder) {
    const campaign::Store store(folder);
    Json all = nullptr;
    for (const std::size_t cell : finished_cells(folder)) {
        Json of_cell = Json::object();
        const Json kept = store.cell(cell);
        for (const auto& [name, sample] : kept.at("samples").items())
            if (sample.contains("values")) of_cell[name] = rounded(sample.at("values"));
        all.push_back(std::move(of_cell));
    }
    return all;
}

std::vector<std::string> write_plots_of(const fs::path& page, const std::vector<std::string>& formats) {
    const fs::path folder = page.parent_path() / "plots";
    std::vector<std::string> files;
    for (const std::string& format : formats)
        for (const std::string& name : report::write_plots(page, folder, format))
            files.push_back((folder / name).string());
    return files;
}

void tell_page(const CommandLine& line, const fs::path& page, const std::vector<std::string>& formats) {
    std::vector<std::string> files = write_plots_of(page, formats);
    files.insert(files.begin(), page.string());
    if (line.has("json")) return print_json({{"page", page.string()}, {"files", files}});
    std::string text;
    for (const std::string& file : files) text += file + '\n';
    print(text);
}

}  // namespace pelorus::cli
