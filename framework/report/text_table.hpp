/// Columns of text for a terminal.
#pragma once

#include <string>
#include <vector>

namespace pelorus::report {

using Words = std::vector<std::string>;

constexpr std::size_t widest_line = 118;  ///< characters

/// A line for each row, after two blanks: the first column from the left, all others to the right. Rows may differ in length.
Words aligned_lines(const std::vector<Words>& rows);

/// The lines joined, each with its line end.
std::string joined(const Words& lines);

/// The characters of the longest line.
std::size_t width_of(const Words& lines);

void add_once(Words& words, const std::string& word);

}  // namespace pelorus::report
