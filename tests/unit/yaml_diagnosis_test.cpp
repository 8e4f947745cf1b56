// Words and places for text that is not YAML.
#include <catch2/catch.hpp>

#include "graph/yaml_diagnosis.hpp"

namespace {

using pelorus::graph::diagnose_yaml;

/// `LINE:COLUMN text`, for a parser that stopped at the beginning of that line.
std::string told(const std::string& text, int stopped_at) {
    const auto found = diagnose_yaml(text, stopped_at, 1);
    return found.text.empty() ? "" : std::to_string(found.line) + ":" + std::to_string(found.column) + " " + found.text;
}

}  // namespace

TEST_CASE("What is wrong with a text that is not YAML is told where it is to be mended", "[document]") {
    CHECK(told("a:\n\tb: 1\n", 2) == "2:1 a tab in the indentation; YAML is indented by spaces");
    CHECK(told("a:\n \xC2\xA0 b: 1\n", 2) ==
          "2:2 a no-break space (U+00A0) in place of a space; YAML is indented by spaces");
    CHECK(told("a:\n\xE3\x80\x80"
               "b: 1\n",
               2) == "2:1 an ideographic space (U+3000) in place of a space; YAML is indented by spaces");
    CHECK(told("a: {b: 1\nc: 2\n", 2) == "1:4 this '{' is not closed");
    CHECK(told("a: [1, 2}\n", 1) == "1:9 this '}' cannot close the '[' in line 1, column 4, which is still open");
    CHECK(told("a: {b: 1}}\n", 1) == "1:10 this '}' closes nothing");
    CHECK(told("a: {b: 1 c: 2}\n", 1) == "1:10 a comma is missing before 'c'");
    CHECK(told("a: 'b\nc: 2\n", 2) == "1:4 this quote is not closed");
    CHECK(told("a: b: c\n", 1) == "1:5 a second colon; a text with ': ' in it has to be quoted");
    CHECK(told("a:\n  b:c\n  d: 1\n", 3) == "2:4 a blank is missing after the colon of 'b'");
    CHECK(told("a\nb: 1\n", 2) == "1:1 'a' is no `key: value`; a colon is missing");
    CHECK(told("a: %5\n", 1) == "1:4 a value cannot begin with '%'; quote it");
    CHECK(told("a:\n    b: 1\n  c: 2\n", 3) == "3:3 indented by 2 spaces, which is no level of the lines above: 0, 4");
}

TEST_CASE("The line that ended a level is told where it is a key beside the one that it belongs to", "[document]") {
    const std::string by_two = "indented by 2 spaces, which is no level of the lines above: 0, 4";
    const std::string empty = "graph:\nradar:\n    use: x\n  tracker: y\n";
    CHECK(told(empty, 4) == "4:3 " + by_two + "; line 2 `radar:` stands beside `graph:`, line 1");
    const std::string filled = "graph:\n  world: {}\nradar:\n    use: x\n  tracker: y\n";
    CHECK(told(filled, 5) == "5:3 " + by_two + "; line 3 `radar:` stands beside `graph:`, line 1");
    CHECK(told("graph:\n    world: {}\nradar:\n    use: x\n  tracker: y\n", 5) == "5:3 " + by_two);
    CHECK(told("title: t\ngraph:\n    use: x\n  tracker: y\n", 4) == "4:3 " + by_two);
}

TEST_CASE("Quotes, brackets and comments that are in order are not blamed for what is wrong elsewhere", "[document]") {
    const std::string before = "a: {b: [1, 'it''s }'], c: \"]\\\"\"}  # {\nt: it's a [plain] text\n";
    CHECK(told(before + "d: e: f\n", 3) == "3:5 a second colon; a text with ': ' in it has to be quoted");
    CHECK(told(before + "d:e\nf: {\n  g: 1}\n", 4) == "3:2 a blank is missing after the colon of 'd'");
    CHECK(told("a: {b:\n  1}\n", 1).empty());
}
