#include <catch2/catch.hpp>

#include <string>

#include "graph/document.hpp"
#include "graph/yaml.hpp"

using namespace pelorus;
using namespace pelorus::graph;

namespace {

Value read(const std::string& text) { return read_yaml(text, {{}, "a.yaml", "/configs"}); }

std::string problems(const std::string& text) {
    try {
        read(text);
        return "read";
    } catch (const ConfigError& error) {
        return error.what();
    }
}

const std::string& at(const Value& value, const std::string& key) { return value.find(key)->scalar; }

}  // namespace

TEST_CASE("Every value and key knows its line and column", "[document]") {
    const Value root = read("a: 1\nb:\n  c: [x, 'y z']\n  d:\n    e: ~\n");
    CHECK(root.find("a")->where.text() == "a.yaml:1:4");
    CHECK(root.entry("b")->where.text() == "a.yaml:2:1");
    const Value& list = *root.find("b")->find("c");
    REQUIRE(list.is_list());
    CHECK(list.where.text() == "a.yaml:3:6");
    CHECK(list.list[1].where.text() == "a.yaml:3:10");
    CHECK(list.list[1].quoted);
    CHECK_FALSE(list.list[0].quoted);
    CHECK(root.find("b")->find("d")->find("e")->is_null());
    CHECK(list.base == "/configs");
}

TEST_CASE("A text that is not in a file is read like one that is", "[document]") {
    const Location where{"", 0, 0};
    for (const std::string text :
         {"truncated", "0.1 m/s2", "-5", "1e-5 1/m", "95 %", "a  b", "a_b-c", "null",  "Null",   "NULL",
          "nULL",      "~",        "",   " ",        "true", "...",  "---",   "--- a", "- a",    "a ",
          " a",        "a/b.yaml", "+3", ".5",       "%a",   "'a'",  "a: b",  "a #b",  "[a, b]", "a\n"}) {
        INFO("'" << text << "'");
        const Value alone = read_yaml(text, {where, {}, "/configs"}), in_file = read(text);
        CHECK(alone.kind == in_file.kind);
        CHECK(alone.scalar == in_file.scalar);
        CHECK(alone.quoted == in_file.quoted);
        CHECK(alone.list.size() == in_file.list.size());
        CHECK(alone.base == in_file.base);
    }
}

TEST_CASE("Anchors are resolved and << is merged, explicit keys first, then the earlier map", "[document]") {
    const Value root = read(
        "x-a: &a {p: 1, q: 2}\n"
        "x-b: &b {q: 3, r: 4}\n"
        "one: {<<: *a, q: 9}\n"
        "two: {<<: [*a, *b], s: 5}\n"
        "three: *a\n"
        "four: {'<<': 1}\n");
    const Value& one = *root.find("one");
    CHECK(at(one, "p") == "1");
    CHECK(at(one, "q") == "9");
    CHECK(one.find("<<") == nullptr);
    const Value& two = *root.find("two");
    CHECK(two.keys() == std::vector<std::string>{"p", "q", "r", "s"});
    CHECK(at(two, "q") == "2");
    CHECK(at(*root.find("three"), "q") == "2");
    CHECK(at(*root.find("four"), "<<") == "1");  // quoted, it is a key like any other
}

TEST_CASE("A merge inside an anchored map reaches those that use the anchor", "[document]") {
    const Value root = read("x-a: &a {p: 1}\nx-b: &b {<<: *a, q: 2}\nc: {<<: *b}\n");
    CHECK(root.find("c")->keys() == std::vector<std::string>{"p", "q"});
}

TEST_CASE("Duplicate keys are refused, all of them", "[document]") {
    CHECK(problems("a: 1\nb: {c: 1, c: 2}\na: 3\n") ==
          "a.yaml:2:11: the key 'c' stands twice, first in line 2\n"
          "a.yaml:3:1: the key 'a' stands twice, first in line 1");
    CHECK(problems("x: &x {p: 1}\na: {<<: *x, <<: *x}\n") == "a.yaml:2:13: the key '<<' stands twice, first in line 2");
}

TEST_CASE("Tags, further documents and keys that are no words are refused", "[document]") {
    CHECK(problems("a: !!int 5\n") == "a.yaml:1:4: the tag 'tag:yaml.org,2002:int' has no meaning in a config");
    CHECK(problems("a: !mine {b: 1}\n") == "a.yaml:1:4: the tag '!mine' has no meaning in a config");
    CHECK(problems("a: 1\n---\nb: 2\n") == "a.yaml:2:1: a second document begins here; a config is one document");
    CHECK(problems("? [1, 2]\n: 3\n") == "a.yaml:1:3: a key must be a word, not a list");
    CHECK(problems("~: 3\n") == "a.yaml:1:1: a key must be a word, not nothing");
    CHECK(problems("a: {<<: 5}\n") == "a.yaml:1:9: '<<' merges a map or a list of maps, got '5'");
}

TEST_CASE("Text that is not YAML is refused at its place", "[document]") {
    CHECK(problems("a: [1, 2\nb: 3\n") == "a.yaml:1:4: this is not YAML: this '[' is not closed");
    CHECK(problems("a: *nowhere\n") == "a.yaml:1:4: this is not YAML: no anchor of this name (&NAME) stands before it");
    CHECK(problems("a: &a [1, *a]\n") == "a.yaml:1:11: an anchor is used inside its own value");
    CHECK(problems("a: \"open\nb: 3\n") == "a.yaml:1:4: this is not YAML: this quote is not closed");
}

TEST_CASE("Deep nesting and multiplying aliases end with an error, not with the memory", "[document]") {
    CHECK(problems("a: " + std::string(300, '[') + std::string(300, ']')).find("levels deep") != std::string::npos);
    std::string laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int i = 1; i < 9; ++i) {
        const std::string before = "*a" + std::to_string(i - 1);
        laughs += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
        for (int k = 0; k < 9; ++k) laughs += before + ", ";
        laughs += before + "]\n";
    }
    CHECK(problems(laughs).find("aliases expand to more than 1000000 values") != std::string::npos);
    std::string chain = "a0: &a0 [x]\n";
    for (int i = 1; i < 300; ++i)
        chain += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [*a" + std::to_string(i - 1) + "]\n";
    CHECK(problems(chain).find("nested more than 200 levels deep") != std::string::npos);
}

TEST_CASE("Bytes that are not UTF-8 are refused, control characters kept out of messages", "[document]") {
    CHECK(read("a: \xC3\xA4\xE2\x82\xAC\xF0\x9D\x84\x9E\n").find("a")->scalar ==
          "\xC3\xA4\xE2\x82\xAC\xF0\x9D\x84\x9E");
    CHECK(problems("a: 1\nb: x\xFFy\n") == "a.yaml:2:5: this is not UTF-8; a config is text, saved as UTF-8");
    for (const char* bytes : {"\x80", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                              "\xF5\x80\x80\x80", "\xE2\x82", "\xC3"})
        CHECK(problems(bytes) == "a.yaml:1:1: this is not UTF-8; a config is text, saved as UTF-8");
    CHECK(problems("a: \"\\\n b: \\q\"\n").find('\n') == std::string::npos);
}
