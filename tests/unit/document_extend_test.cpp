#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "graph/document.hpp"

using namespace pelorus;
using namespace pelorus::graph;
namespace fs = std::filesystem;

namespace {

/// A folder of config files that goes away with the test; the working directory is in it meanwhile.
class Folder {
public:
    Folder() : before_(fs::current_path()) {
        std::string pattern = (fs::temp_directory_path() / "pelorus-document-XXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
        fs::current_path(path_);
    }
    ~Folder() {
        fs::current_path(before_);
        fs::remove_all(path_);
    }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name) << text;
    }
    const fs::path& path() const { return path_; }

private:
    fs::path before_, path_;
};

std::string problems(const std::string& file) {
    try {
        Document::load(file);
        return "read";
    } catch (const ConfigError& error) {
        return error.what();
    }
}

}  // namespace

TEST_CASE("A config extends another: maps merge, lists and scalars replace, ~ removes", "[document]") {
    const Folder folder;
    folder.write("base/base.yaml",
                 "pelorus: 1\ntitle: base\ngraph:\n  a: {use: k.a, with: {x: 1, y: [1, 2], z: 3}}\n  b: {use: k.b}\n  "
                 "c: {use: k.c}\n");
    folder.write(
        "top.yaml",
        "extend: base/base.yaml\ntitle: top\ngraph:\n  a:\n    with: {y: [7], z: ~}\n  b: ~\n  d: {use: k.d}\n");
    const Document document = Document::load("top.yaml");
    const Value& root = document.root();
    CHECK(root.find("extend") == nullptr);
    CHECK(root.find("title")->scalar == "top");
    const Value& graph = *root.find("graph");
    CHECK(graph.keys() == std::vector<std::string>{"a", "c", "d"});
    const Value& with = *graph.find("a")->find("with");
    CHECK(with.keys() == std::vector<std::string>{"x", "y"});
    CHECK(with.find("y")->list.size() == 1);
    // Each value keeps its own file, and the folder that its paths are relative to.
    CHECK(with.find("x")->where.text() == "base/base.yaml:4:27");
    CHECK(fs::equivalent(with.find("x")->base, folder.path() / "base"));
    CHECK(with.find("y")->where.text() == "top.yaml:5:15");
    CHECK(fs::equivalent(with.find("y")->base, folder.path()));
}

TEST_CASE("extend: is relative to the file that says it", "[document]") {
    const Folder folder;
    folder.write("one/two/c.yaml", "pelorus: 1\ntitle: c\n");
    folder.write("one/b.yaml", "extend: two/c.yaml\n");
    folder.write("a.yaml", "extend: one/b.yaml\n");
    CHECK(Document::load("a.yaml").root().find("title")->where.text() == "one/two/c.yaml:2:8");
    CHECK(Document::load(folder.path() / "one" / ".." / "a.yaml").root().find("title")->scalar == "c");
}

TEST_CASE("Configs that extend each other in a circle are refused with the chain", "[document]") {
    const Folder folder;
    folder.write("a.yaml", "pelorus: 1\nextend: b.yaml\n");
    folder.write("b.yaml", "extend: sub/../a.yaml\n");
    fs::create_directory("sub");
    CHECK(problems("a.yaml") == "b.yaml:1:9: config files extend each other in a circle: a.yaml -> b.yaml -> a.yaml");
}

TEST_CASE("A config file that cannot be read is named with the reason", "[document]") {
    const Folder folder;
    folder.write("a.yaml", "extend: gone.yaml\n");
    folder.write("list.yaml", "- 1\n");
    folder.write("empty.yaml", "# nothing\n");
    folder.write("odd.yaml", "extend: [a, b]\n");
    fs::create_directory("folder");
    CHECK(problems("gone.yaml") == "gone.yaml: there is no such file");
    CHECK(problems("a.yaml") == "a.yaml:1:9: extend: gone.yaml: there is no such file");
    CHECK(problems("folder") == "folder: is a folder, not a config file");
    CHECK(problems("list.yaml") == "list.yaml:1:1: a config is a map that begins with `pelorus: 1`, got a list");
    CHECK(problems("empty.yaml") == "empty.yaml: the config is empty; it begins with `pelorus: 1`");
    CHECK(problems("odd.yaml") == "odd.yaml:1:9: extend: expected the name of one config file, got a list");
}

TEST_CASE("Override texts are YAML with the working directory as their base", "[document]") {
    const Document document = Document::parse("pelorus: 1", "a.yaml", "/configs",
                                              {{"a.b", "[1 m, 2 m]"}, {"a.c", "~"}, {"a.d", "{use: k.x}"}});
    REQUIRE(document.overrides().size() == 3);
    CHECK(document.overrides()[0].value.list[1].scalar == "2 m");
    CHECK(document.overrides()[0].value.list[1].where.text() == "--set a.b=[1 m, 2 m]");
    CHECK(document.overrides()[0].value.list[1].base == fs::current_path());
    CHECK(document.overrides()[1].value.is_null());
    CHECK(document.overrides()[2].value.find("use")->scalar == "k.x");
}

TEST_CASE("Override texts that are not YAML, or missing, are refused", "[document]") {
    const auto problem = [](const std::string& text) {
        try {
            Document::parse("pelorus: 1", "a.yaml", "/", {{"a.b", text}});
            return std::string("read");
        } catch (const ConfigError& error) {
            return std::string(error.what());
        }
    };
    CHECK(problem("") == "--set a.b=: a value is missing; write ~ to remove what stands there");
    CHECK(problem("[1").find("--set a.b=[1: this is not YAML: ") == 0);
    CHECK(problem("{c: 1, c: 2}") == "--set a.b={c: 1, c: 2}: the key 'c' stands twice");
}

TEST_CASE("A campaign's assignments come before those of the command line", "[document]") {
    Document document = Document::parse("pelorus: 1", "a.yaml", "/", {{"a.b", "1"}});
    Value two;
    two.kind = Value::Kind::scalar;
    two.scalar = "2";
    document.assign({"a.b", {"a.yaml", 3, 1}, two});
    document.assign({"a.c", {"a.yaml", 4, 1}, two});
    REQUIRE(document.overrides().size() == 3);
    CHECK(document.overrides()[0].address == "a.b");
    CHECK(document.overrides()[1].address == "a.c");
    CHECK(document.overrides()[2].value.scalar == "1");
}
