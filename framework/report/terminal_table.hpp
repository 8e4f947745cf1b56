/// What the command prints of a result.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/summary.hpp"
#include "report/timing.hpp"

namespace pelorus::report {

/// Scalars, aligned, with five significant digits and units (and, for several runs, the half width of the 95 %
/// confidence interval); then the tables with their numbers of rows. Several cells stand under headings. Ends with a
/// newline unless it is empty.
std::string terminal_table(const std::vector<Cell>& cells);

/// Counters of the nodes that are not zero, one line a node; "" when there are none.
std::string counter_lines(const Timings& timings);

/// The files of a result folder, by name.
std::vector<std::string> file_names(const std::filesystem::path& folder);

/// `DIR: a, b, c`, the files of a result folder by name; "" when there are none.
std::string file_line(const std::filesystem::path& folder);

}  // namespace pelorus::report
