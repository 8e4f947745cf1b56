#include "markdown.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace pelorus::test {

namespace {

std::size_t indentation(const std::string& line) {
    const std::size_t first = line.find_first_not_of(' ');
    return first == std::string::npos ? line.size() : first;
}

/// "```" or "~~~", three or more, at the beginning of a line; "" if there is none.
std::string fence_of(const std::string& line) {
    const std::size_t begin = indentation(line);
    const char mark = begin < line.size() ? line[begin] : ' ';
    if (mark != '`' && mark != '~') return "";
    std::size_t end = line.find_first_not_of(mark, begin);
    if (end == std::string::npos) end = line.size();
    return end - begin >= 3 ? line.substr(begin, end - begin) : "";
}

void read_info(const std::string& info, CodeBlock& block) {
    std::istringstream words(info);
    words >> block.language;
    for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos)
            block.marks.emplace(word, "");
        else
            block.marks.emplace(word.substr(0, equals), word.substr(equals + 1));
    }
}

/// Code between backticks is text, whatever it looks like.
std::string without_code(const std::string& line) {
    static const std::regex code("`[^`]*`");
    return std::regex_replace(line, code, "`");
}

std::string anchor_of(const std::string& heading) {
    std::string anchor;
    for (const char c : heading) {
        const auto letter = static_cast<unsigned char>(c);
        if (std::isalnum(letter) || c == '_' || c == '-' || letter >= 0x80)
            anchor += static_cast<char>(std::tolower(letter));
        else if (c == ' ')
            anchor += '-';
    }
    return anchor;
}

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::string cell;
    bool code = false;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const char c = line[i];
        if (c == '`') code = !code;
        if (c == '\\' && i + 1 < line.size() && line[i + 1] == '|') {
            cell += line[++i];
        } else if (c == '|' && !code) {
            cells.push_back(trimmed(cell));
            cell.clear();
        } else {
            cell += c;
        }
    }
    return cells;
}

class Reader {
public:
    explicit Reader(const std::string& text) : lines_(lines_of(text)) {}

    MarkdownPage read() {
        while (at_ < lines_.size()) {
            const std::string& line = lines_[at_];
            if (!fence_of(line).empty())
                fenced_block();
            else if (indentation(line) >= 4 && !trimmed(line).empty() && after_blank_ && !in_list_)
                indented_block();
            else
                prose(line);
        }
        return page_;
    }

private:
    int number() const { return static_cast<int>(at_) + 1; }

    void fenced_block() {
        const std::string fence = fence_of(lines_[at_]);
        const std::size_t indent = indentation(lines_[at_]);
        CodeBlock block;
        block.line = number();
        read_info(lines_[at_].substr(indent + fence.size()), block);
        for (++at_; at_ < lines_.size() && trimmed(lines_[at_]) != fence; ++at_)
            block.lines.push_back(lines_[at_].substr(std::min(indent, indentation(lines_[at_]))));
        if (at_ == lines_.size())
            throw std::runtime_error("line " + std::to_string(block.line) + ": a block that does not end");
        ++at_;
        after_blank_ = false;
        page_.blocks.push_back(std::move(block));
    }

    void indented_block() {
        CodeBlock block;
        block.line = number();
        block.fenced = false;
        for (; at_ < lines_.size() && (indentation(lines_[at_]) >= 4 || trimmed(lines_[at_]).empty()); ++at_)
            block.lines.push_back(lines_[at_].substr(std::min<std::size_t>(4, lines_[at_].size())));
        after_blank_ = true;
        page_.blocks.push_back(std::move(block));
    }

    void prose(const std::string& line) {
        static const std::regex item("^ {0,3}([-*]|[0-9]+\\.) .*");
        static const std::regex directive("^<!-- test: (.*) -->$");
        std::smatch match;
        if (std::regex_match(line, item))
            in_list_ = true;
        else if (!trimmed(line).empty() && indentation(line) == 0)
            in_list_ = false;
        if (std::regex_match(line, match, directive)) page_.directives.push_back(match[1]);
        heading(line);
        table_row(line);
        links(line);
        after_blank_ = trimmed(line).empty() || line.front() == '#';
        ++at_;
    }

    void heading(const std::string& line) {
        static const std::regex form("^#{1,6} +(.*)$");
        std::smatch match;
        if (!std::regex_match(line, match, form)) return;
        const std::string anchor = anchor_of(trimmed(match[1]));
        const int before = headings_[anchor]++;
        page_.anchors.insert(before == 0 ? anchor : anchor + "-" + std::to_string(before));
    }

    void table_row(const std::string& line) {
        if (line.empty() || line.front() != '|') {
            in_table_ = false;
            return;
        }
        if (!in_table_) page_.tables.emplace_back();
        in_table_ = true;
        if (line.find_first_not_of("|-: ") != std::string::npos) page_.tables.back().push_back(cells_of(line));
    }

    void links(const std::string& line) {
        static const std::regex form("\\]\\(([^)\\s]+)\\)");
        const std::string text = without_code(line);
        for (std::sregex_iterator link(text.begin(), text.end(), form), end; link != end; ++link)
            page_.links.push_back({number(), (*link)[1]});
    }

    std::vector<std::string> lines_;
    std::size_t at_ = 0;
    bool after_blank_ = true, in_list_ = false, in_table_ = false;
    std::map<std::string, int> headings_;
    MarkdownPage page_;
};

}  // namespace

std::string CodeBlock::text() const {
    std::string text;
    for (const std::string& each : lines) text += each + "\n";
    return text;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::string trimmed(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string::npos) return "";
    return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

MarkdownPage parse_markdown(const std::string& text) { return Reader(text).read(); }

MarkdownPage read_markdown(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw std::runtime_error("no file " + file.string());
    std::ostringstream text;
    text << stream.rdbuf();
    return parse_markdown(text.str());
}

}  // namespace pelorus::test
