/// Markdown pages as the tests of the documentation read them: blocks of code, links, anchors, tables.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace pelorus::test {

/// A block of code.
struct CodeBlock {
    int line = 0;          ///< of its first line in the page, counted from 1 (the fence)
    bool fenced = true;    ///< false: indented by four blanks
    std::string language;  ///< first word of the info string
    /// The other words of the info string: `file=first.yaml` is {"file", "first.yaml"}, `fragment` is {"fragment", ""}.
    std::map<std::string, std::string> marks;
    std::vector<std::string> lines;

    bool has(const std::string& mark) const { return marks.count(mark) != 0; }
    std::string text() const;
};

struct Link {
    int line = 0;
    std::string target;  ///< as written, `config.md#units`
};

/// Rows of trimmed cells; the first row is the header, the row of dashes is left out.
using Table = std::vector<std::vector<std::string>>;

struct MarkdownPage {
    std::vector<CodeBlock> blocks;
    std::vector<Link> links;
    std::set<std::string> anchors;  ///< of its headings, as repository viewers make them
    std::vector<Table> tables;
    std::vector<std::string> directives;  ///< what stands in comments `<!-- test: ... -->`
};

/// Throws std::runtime_error where the file cannot be read.
MarkdownPage read_markdown(const std::filesystem::path& file);
MarkdownPage parse_markdown(const std::string& text);

std::vector<std::string> lines_of(const std::string& text);
std::string trimmed(const std::string& text);

}  // namespace pelorus::test
