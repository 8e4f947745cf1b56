/// What the commands that write a page have in common.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/command_line.hpp"

namespace pelorus::cli {

Flag plot_flag();

/// What --plot asks for. Throws Error (Exit::misuse) for a format that there is not.
std::vector<std::string> plot_formats(const CommandLine& line);

/// The folder of the page's parts in this installation.
std::filesystem::path page_parts();

/// For each cell of the campaign in a result folder the values of its scalars in the runs, rounded to six digits; null where it holds no
/// campaign. Throws Error: a cell is damaged.
nlohmann::ordered_json samples_of(const std::filesystem::path& folder);

/// The numbers of the finished cells of the campaign in a folder, in the order of its summary.
std::vector<std::size_t> finished_cells(const std::filesystem::path& folder);

/// Writes the plots of the page into `plots` beside it; answers the files.
std::vector<std::string> write_plots_of(const std::filesystem::path& page, const std::vector<std::string>& formats);

/// Writes the plots of the page, and tells the files: lines, or with --json as JSON.
void tell_page(const CommandLine& line, const std::filesystem::path& page, const std::vector<std::string>& formats);

}  // namespace pelorus::cli
