#include "report/text_table.hpp"

#include <algorithm>

#include "report/text_width.hpp"

namespace pelorus::report {

Words aligned_lines(const std::vector<Words>& rows) {
    std::vector<std::size_t> widths;
    for (const Words& row : rows) {
        widths.resize(std::max(widths.size(), row.size()), 0);
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], text_width(row[i]));
    }
    Words lines;
    for (const Words& row : rows) {
        std::string line = "  " + row[0] + std::string(widths[0] - text_width(row[0]), ' ');
        for (std::size_t i = 1; i < row.size(); ++i)
            line += "  " + std::string(widths[i] - text_width(row[i]), ' ') + row[i];
        line.erase(line.find_last_not_of(' ') + 1);
        lines.push_back(std::move(line));
    }
    return lines;
}

std::string joined(const Words& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + '\n';
    return text;
}

std::size_t width_of(const Words& lines) {
    std::size_t width = 0;
    for (const std::string& line : lines) width = std::max(width, text_width(line));
    return width;
}

void add_once(Words& words, const std::string& word) {
    if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
}

}  // namespace pelorus::report
