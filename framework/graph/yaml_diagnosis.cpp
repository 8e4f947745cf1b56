#include "graph/yaml_diagnosis.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <sstream>
#include <utility>
#include <vector>

namespace pelorus::graph {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string place(int line, int column) {
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// Walks through the text as YAML's quotes, comments and brackets want it, up to the place where the parser stopped.
class BracketScan {
public:
    BracketScan(const std::string& text, int last_line) : text_(text), last_line_(last_line) {}

    YamlDiagnosis run() {
        // What is open there is followed to its end.
        while (at_ < text_.size() && found_.text.empty() && (!open_.empty() || line_ <= last_line_)) step();
        if (found_.text.empty() && !open_.empty()) unclosed(open_.back());
        return found_;
    }

private:
    struct Bracket {
        char kind;
        int line, column;
        int colons = 0;  ///< in the entry that is being read
        int entry_line = 0;
    };

    int column() const { return static_cast<int>(at_ - line_start_) + 1; }
    char next() const { return at_ + 1 < text_.size() ? text_[at_ + 1] : '\n'; }
    char before() const { return at_ > 0 ? text_[at_ - 1] : '\n'; }
    void report(int line, int column, std::string text) { found_ = {line, column, std::move(text)}; }
    void unclosed(const Bracket& bracket) {
        report(bracket.line, bracket.column, std::string("this '") + bracket.kind + "' is not closed");
    }

    void advance() {
        if (text_[at_++] != '\n') return;
        ++line_;
        line_start_ = at_;
        begins_value_ = true;
    }

    void step() {
        const char c = text_[at_];
        if (c == '#' && is_blank(before())) {
            while (at_ < text_.size() && text_[at_] != '\n') advance();
            return;
        }
        if ((c == '"' || c == '\'') && begins_value_) return quoted(c);
        if ((c == '{' || c == '[') && (begins_value_ || !open_.empty())) {
            open_.push_back({c, line_, column(), 0, line_});
            begins_value_ = true;
            return advance();
        }
        if ((c == '}' || c == ']') && (!open_.empty() || begins_value_ || closed_in_line_ == line_)) return close(c);
        if (c == ',' && !open_.empty()) {
            open_.back().colons = 0;
            begins_value_ = true;
            return advance();
        }
        const bool is_colon = c == ':' && (is_blank(next()) || (!open_.empty() && next() == ','));
        if (is_colon && !open_.empty() && open_.back().kind == '{') second_colon();
        begins_value_ = is_colon || (c == '-' && begins_value_ && is_blank(next())) || (begins_value_ && is_blank(c));
        if (found_.text.empty()) advance();
    }

    /// Two colons in an entry of a map: with a line end between them the map was to end there.
    void second_colon() {
        Bracket& map = open_.back();
        if (++map.colons == 1) {
            map.entry_line = line_;
            return;
        }
        if (map.entry_line != line_) return unclosed(map);
        std::size_t key = at_;
        while (key > line_start_ && !is_blank(text_[key - 1])) --key;
        report(line_, static_cast<int>(key - line_start_) + 1,
               "a comma is missing before '" + text_.substr(key, at_ - key) + "'");
    }

    void close(char c) {
        const char opened = c == '}' ? '{' : '[';
        if (open_.empty()) return report(line_, column(), std::string("this '") + c + "' closes nothing");
        const Bracket top = open_.back();
        if (top.kind != opened)
            return report(line_, column(),
                          std::string("this '") + c + "' cannot close the '" + top.kind + "' in " +
                              place(top.line, top.column) + ", which is still open");
        open_.pop_back();
        closed_in_line_ = line_;
        begins_value_ = false;
        advance();
    }

    void quoted(char quote) {
        const int line = line_, opened = column();
        advance();
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '\\' && quote == '"' && at_ + 1 < text_.size()) {
                advance();
            } else if (c == quote && quote == '\'' && next() == quote) {
                advance();
            } else if (c == quote) {
                break;
            }
            advance();
        }
        if (at_ >= text_.size() || line_ != line)
            return report(line, opened,
                          at_ >= text_.size()
                              ? "this quote is not closed"
                              : "this quote is closed only in " + place(line_, column()) + "; was that meant?");
        advance();
        begins_value_ = false;
    }

    const std::string& text_;
    const int last_line_;
    std::size_t at_ = 0, line_start_ = 0;
    int line_ = 1, closed_in_line_ = 0;
    bool begins_value_ = true;
    std::vector<Bracket> open_;
    YamlDiagnosis found_;
};

/// A line of block style: its indentation, and where its colons are that end a key.
struct Line {
    std::string text;
    int number = 0;
    std::size_t indent = 0;
    std::vector<std::size_t> colons;  ///< outside of quotes and brackets

    bool ends_in_colon() const { return !colons.empty() && colons.back() + 1 == text.size(); }
};

Line read_line(std::string text, int number) {
    Line line;
    line.number = number;
    line.indent = std::min(text.find_first_not_of(' '), text.size());
    char quote = 0;
    int depth = 0;
    std::size_t end = text.size();
    for (std::size_t i = line.indent; i < text.size(); ++i) {
        const char c = text[i];
        if (quote != 0) {
            if (c == quote) quote = 0;
            continue;
        }
        const bool begins = i == line.indent || is_blank(text[i - 1]);
        if ((c == '"' || c == '\'') && begins) quote = c;
        if (c == '{' || c == '[') ++depth;
        if (c == '}' || c == ']') --depth;
        if (c == '#' && begins) {
            end = i;
            break;
        }
        if (c == ':' && depth == 0 && (i + 1 == text.size() || is_blank(text[i + 1]))) line.colons.push_back(i);
    }
    text.resize(end);
    while (!text.empty() && is_blank(text.back())) text.pop_back();
    line.text = std::move(text);
    return line;
}

/// Lines up to the one in which the parser stopped, without those that say nothing.
std::vector<Line> lines_up_to(const std::string& text, int last) {
    std::vector<Line> lines;
    std::istringstream stream(text);
    std::string line;
    for (int number = 1; number <= last && std::getline(stream, line); ++number) {
        Line read = read_line(std::move(line), number);
        if (!read.text.empty()) lines.push_back(std::move(read));
    }
    return lines;
}

YamlDiagnosis at(const Line& line, std::size_t offset, std::string text) {
    return {line.number, static_cast<int>(offset) + 1, std::move(text)};
}

YamlDiagnosis strange_blank(const std::vector<Line>& lines) {
    for (const Line& line : lines) {
        if (line.indent == line.text.size()) continue;
        if (line.text[line.indent] == '\t')
            return at(line, line.indent, "a tab in the indentation; YAML is indented by spaces");
        if (const std::string blank = blank_problem(line.text.substr(line.indent)); !blank.empty())
            return at(line, line.indent, blank);
    }
    return {};
}

YamlDiagnosis strange_begin(const Line& line) {
    for (std::size_t i = line.indent; i < line.text.size(); ++i) {
        const bool begins = i == line.indent || is_blank(line.text[i - 1]) || line.text[i - 1] == '{' ||
                            line.text[i - 1] == '[' || line.text[i - 1] == ',';
        if (begins && std::string("%@`").find(line.text[i]) != std::string::npos)
            return at(line, i, std::string("a value cannot begin with '") + line.text[i] + "'; quote it");
    }
    return {};
}

YamlDiagnosis no_colon(const Line& line) {
    const std::string words = line.text.substr(line.indent);
    if (!line.colons.empty() || words.front() == '-' || words.front() == '{' || words.front() == '[') return {};
    const std::size_t colon = words.find(':');
    if (colon != std::string::npos && colon > 0 && words.find_first_of(" {[\"'") > colon)
        return at(line, line.indent + colon, "a blank is missing after the colon of '" + words.substr(0, colon) + "'");
    return at(line, line.indent, "'" + words + "' is no `key: value`; a colon is missing");
}

/// Which line may have ended the level of `lines.back()`: a key that stands beside the one that it was to stand under. "" if none
/// looks like that.
std::string culprit(const std::vector<Line>& lines) {
    const std::size_t level = lines.back().indent;
    std::size_t ender = lines.size() - 1;
    while (ender > 0 && lines[ender].indent >= level) --ender;
    if (ender == 0 || lines[ender].indent >= level) return {};
    const Line& line = lines[ender];
    bool had_level = false;
    for (std::size_t i = ender; i-- > 0;) {
        const Line& beside = lines[i];
        had_level = had_level || beside.indent == level;
        if (beside.indent > line.indent) continue;
        const bool is_empty = i + 1 == ender;
        if (beside.indent < line.indent || !line.ends_in_colon() || !beside.ends_in_colon()) return {};
        if (!is_empty && !had_level) return {};
        const auto named = [](const Line& each) { return "`" + each.text.substr(each.indent) + "`"; };
        return "; line " + std::to_string(line.number) + " " + named(line) + " stands beside " + named(beside) +
               ", line " + std::to_string(beside.number);
    }
    return {};
}

/// The last line against those above it.
YamlDiagnosis indentation(const std::vector<Line>& lines) {
    const Line& line = lines.back();
    if (lines.size() < 2) return {};
    std::vector<std::size_t> levels;
    for (const Line& above : lines) {
        if (&above == &line) break;
        while (!levels.empty() && levels.back() > above.indent) levels.pop_back();
        if (levels.empty() || levels.back() != above.indent) levels.push_back(above.indent);
    }
    const Line& above = lines[lines.size() - 2];
    const std::string by = "indented by " + std::to_string(line.indent) + " spaces";
    if (line.indent > above.indent && !above.ends_in_colon() && !above.colons.empty())
        return at(line, line.indent,
                  by + ", deeper than line " + std::to_string(above.number) +
                      ", which has a value already; does it belong beside it, by " + std::to_string(above.indent) +
                      "?");
    if (line.indent >= above.indent || std::count(levels.begin(), levels.end(), line.indent) > 0) return {};
    std::string known;
    for (const std::size_t level : levels) known += (known.empty() ? "" : ", ") + std::to_string(level);
    return at(line, line.indent, by + ", which is no level of the lines above: " + known + culprit(lines));
}

}  // namespace

std::string blank_problem(const std::string& text) {
    static const std::pair<const char*, const char*> blanks[] = {{"\xC2\xA0", "a no-break space (U+00A0)"},
                                                                 {"\xE2\x80\x82", "an en space (U+2002)"},
                                                                 {"\xE2\x80\x83", "an em space (U+2003)"},
                                                                 {"\xE2\x80\x87", "a figure space (U+2007)"},
                                                                 {"\xE2\x80\x89", "a thin space (U+2009)"},
                                                                 {"\xE2\x80\x8B", "a zero-width space (U+200B)"},
                                                                 {"\xE2\x80\xAF", "a narrow no-break space (U+202F)"},
                                                                 {"\xE3\x80\x80", "an ideographic space (U+3000)"}};
    for (const auto& [blank, name] : blanks)
        if (text.compare(0, std::strlen(blank), blank) == 0)
            return std::string(name) + " in place of a space; YAML is indented by spaces";
    return {};
}

YamlDiagnosis diagnose_yaml(const std::string& text, int line, int column) {
    const std::vector<Line> lines = lines_up_to(text, line);
    if (lines.empty()) return {};
    if (const YamlDiagnosis found = strange_blank(lines); !found.text.empty()) return found;
    if (const YamlDiagnosis found = BracketScan(text, line).run(); !found.text.empty()) return found;
    const Line& last = lines.back();
    if (last.number != line) return {};
    if (const YamlDiagnosis found = strange_begin(last); !found.text.empty()) return found;
    if (last.colons.size() > 1 && static_cast<int>(last.colons[1]) + 1 >= column)
        return at(last, last.colons[1], "a second colon; a text with ': ' in it has to be quoted");
    if (lines.size() > 1)
        if (const YamlDiagnosis found = no_colon(lines[lines.size() - 2]); !found.text.empty()) return found;
    if (const YamlDiagnosis found = no_colon(last); !found.text.empty()) return found;
    return indentation(lines);
}

}  // namespace pelorus::graph
