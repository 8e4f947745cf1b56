/// Executes a page of the documentation; docs/writing-docs.md tells the author what each kind of block means.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pelorus::test {

/// Every page with examples, relative to the tree: README.md, docs/*.md, plugins/*/*/README.md.
std::vector<std::string> documented_pages();

/// Does what the page says, block by block, as a reader would whose home folder is fresh and holds this tree as ~/pelorus. Answers
/// one text for each block that does not hold: `PAGE:LINE: what was expected` and the difference.
std::vector<std::string> execute_page(const std::string& page);

/// Whether lines that were printed are those expected: `...` alone stands for any number of lines, within a line for any text.
bool matches(const std::vector<std::string>& expected, const std::vector<std::string>& printed);

}  // namespace pelorus::test
