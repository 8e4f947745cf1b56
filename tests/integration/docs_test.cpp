// Every example of the documentation is executed: one test a page, found when the test program starts, so that a new page needs no
// entry here.
#include <catch2/catch.hpp>

#include <iostream>

#include "../fixtures/temporary_folder.hpp"
#include "../support/markdown.hpp"
#include "../support/process.hpp"
#include "docs_fragment.hpp"
#include "docs_page.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

class PageTest : public Catch::ITestInvoker {
public:
    explicit PageTest(std::string page) : page_(std::move(page)) {}

    void invoke() const override {
        const std::vector<std::string> failures = execute_page(page_);
        for (const std::string& failure : failures) std::cerr << failure << "\n";  // Catch2 would break the lines
        CHECK(failures.empty());
    }

private:
    std::string page_;
};

const bool registered = [] {
    for (const std::string& page : documented_pages()) {
        const std::string name = "every example of " + page + " holds";
        // What pages do with the command, the tests of the command do under sanitizers.
        Catch::AutoReg(new PageTest(page), CATCH_INTERNAL_LINEINFO, "",
                       Catch::NameAndTags{name, "[docs][release-only]"});
    }
    return true;
}();

}  // namespace

TEST_CASE("pages are found and registered") {
    REQUIRE(registered);
    CHECK_THAT(documented_pages(), Catch::VectorContains(std::string("README.md")));
    CHECK_THAT(documented_pages(), Catch::VectorContains(std::string("docs/config.md")));
    CHECK_THAT(documented_pages(), Catch::VectorContains(std::string("plugins/motion/singer/README.md")));
}

TEST_CASE("output of a documented command may vary only where the page says so") {
    CHECK(matches({"a", "...", "d"}, {"a", "b", "c", "d"}));
    CHECK(matches({"a", "...", "d"}, {"a", "d"}));
    CHECK_FALSE(matches({"a", "...", "d"}, {"a", "b", "c"}));
    CHECK(matches({"took ... s, ... rows"}, {"took 3 s, 4 rows"}));
    CHECK_FALSE(matches({"took ... s"}, {"took 3 m"}));
    CHECK_FALSE(matches({"a"}, {"a", "b"}));
    CHECK_FALSE(matches({"a", "b"}, {"a"}));
}

TEST_CASE("a page is read as its author sees it") {
    const MarkdownPage page = parse_markdown(
        "# One: `two`, three\n<!-- test: in ~/pelorus -->\n[a](b.md#c) `[no](link)`\n\n    indented\n\n"
        "1. item\n\n       within\n\n| a | b |\n| --- | --- |\n| `x|y` | 1 |\n\n```yaml file=f.yaml broken\nk: "
        "1\n```\n# One: two three\n");
    CHECK(page.anchors == std::set<std::string>{"one-two-three", "one-two-three-1"});
    CHECK(page.directives == std::vector<std::string>{"in ~/pelorus"});
    REQUIRE(page.links.size() == 1);
    CHECK(page.links[0].target == "b.md#c");
    REQUIRE(page.tables.size() == 1);
    CHECK(page.tables[0] == Table{{"a", "b"}, {"`x|y`", "1"}});
    REQUIRE(page.blocks.size() == 2);
    CHECK_FALSE(page.blocks[0].fenced);
    CHECK(page.blocks[0].line == 5);
    CHECK(page.blocks[1].language == "yaml");
    CHECK(page.blocks[1].marks.at("file") == "f.yaml");
    CHECK(page.blocks[1].has("broken"));
    CHECK(page.blocks[1].text() == "k: 1\n");
    CHECK_THROWS_WITH(parse_markdown("```text\n"), Contains("does not end"));
}

TEST_CASE("every block that does not hold is told with its line") {
    const TemporaryFolder folder;
    const std::string page = folder.write("not-holding.md", R"(<!-- test: upside down -->

```yaml
unmarked: 1
```

    indented

```console
$ echo one
two
```

```console
$ false
```

```console exit=2
$ true
```

```yaml file=bad.yaml
pelorus: 1
```

```yaml into=configs/airship.yaml at=/ broken
run: {seed: 8}
```

```text from=LICENSE
This line is not in the licence.
```

```yaml file=bad.yaml borken
pelorus: 1
```

```diff file=bad.yaml
 pelorus: 2
-graph:
```

    pelorus check CONFIG [--sat ADDRESS=VALUE ...] [--seed N] [--variant V ...] [--runs N] [--plugins DIR ...] [--log-level LEVEL] [--json]
)");
    const std::vector<std::string> failures = execute_page(page);
    const std::vector<std::pair<int, std::string>> expected = {
        {1, "unknown directive"}, {3, "nothing tells"}, {7, "indented block"}, {10, "- two"},
        {15, "exits with 1"},     {19, "exits with 0"}, {22, "refuses it"},    {26, "finds it good"},
        {30, "does not have"},    {34, "unknown mark"}, {38, "0 times"},       {43, "knows no --sat"},
        {43, "missing here"}};
    CAPTURE(failures);
    REQUIRE(failures.size() == expected.size());
    for (std::size_t i = 0; i < failures.size(); ++i)
        CHECK_THAT(failures[i], Catch::StartsWith(page + ":" + std::to_string(expected[i].first) + ": ") &&
                                    Contains(expected[i].second));
}

TEST_CASE("the shell of a page keeps its folder and its variables, and files are where it is") {
    const TemporaryFolder folder;
    const std::string page = folder.write("lasting.md", R"(<!-- test: in ~/pelorus -->
```console
$ ls -d sdk
sdk
$ mkdir -p ~/mine; cd ~/mine; export WORD=kept
```

```text file=below/note.txt
first
last
```

```console
$ cat below/note.txt; echo $WORD > \
> word.txt
first
...
$ cat word.txt; pwd
kept
.../mine
```

```text from=below/note.txt
last
```
)");
    CHECK(execute_page(page) == std::vector<std::string>{});
}

TEST_CASE("a fragment replaces what stood under its keys, and nothing else") {
    const std::string config =
        "graph: {t: {use: x, parts: {s: {one: {use: y, parts: {m: {use: z, with: {a: 1}}}}}}}, u: {use: v}}";
    const std::string merged = merge_fragment(config, "t.s.one", "m: {use: w}");
    CHECK_THAT(merged, Contains("m: {use: w}") && Contains("u: {use: v}") && !Contains("a: 1"));
    CHECK_THAT(merge_fragment(config, "", "u: {use: q}"), Contains("u: {use: q}") && Contains("use: z"));
    CHECK_THAT(merge_fragment(config, "", "t: ~"), !Contains("t:") && Contains("use: v"));
    CHECK_THROWS_WITH(merge_fragment(config, "t.nowhere", "m: 1"), Contains("no 'nowhere'"));
}
