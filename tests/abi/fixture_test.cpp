// What is told of a change, tried on headers of a fixture: gauge.h is frozen, dial.h a draft, shared.h belongs to no table.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cctype>
#include <filesystem>
#include <map>
#include <sstream>
#include <utility>

#include "support.hpp"

using namespace pelorus::test;
using Catch::Contains;
using Catch::EndsWith;
namespace fs = std::filesystem;

namespace {

const fs::path fixture = PELORUS_SOURCE_DIR "/tests/abi/fixture";

/// A copy of the fixture, to be changed.
class Fixture {
public:
    Fixture() { fs::copy(fixture, folder_.path() / "abi", fs::copy_options::recursive); }

    Fixture& change(const std::string& header, const std::string& from, const std::string& to) {
        replace_in(folder_ / "abi/" + header, from, to);
        return *this;
    }
    Ended ended(const std::string& command) const { return abi(command, folder_ / "abi", folder_ / "abi/baseline"); }
    /// What is told, without abidiff's report; an exit code that does not go with it fails.
    std::string told(const std::string& command = "check") const {
        const Ended ended = this->ended(command);
        CAPTURE(ended.err);
        CHECK(ended.err.empty());
        CHECK(ended.exit == (command == "check" && !ended.out.empty() ? 1 : 0));
        return lines_of(ended.out);
    }
    static std::string lines_of(const std::string& out) {
        std::istringstream stream(out);
        std::string lines;
        for (std::string line; std::getline(stream, line);)
            if (line.rfind("    ", 0) != 0) lines += line + "\n";
        return lines;
    }
    std::string record(const std::string& id) const { return read_file(folder_ / "abi/baseline/" + id + ".abi"); }
    bool has(const std::string& id) const { return folder_.has("abi/baseline/" + id + ".abi"); }

private:
    TemporaryFolder folder_;
};

const std::string frozen =
    "changed, and it is frozen for ever: a change is pelorus.gauge/2, with structs of its own beside these";
const std::string grew = "grew at its end, which is allowed: record it";
const std::string gauge_frozen = "pelorus.gauge/1: " + frozen + "\n";

struct Change {
    std::string what, from, to;
};

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// Many frozen tables, each changed in one way: gauge.h over and over, under other names. So one comparison serves them all.
class Variants {
public:
    explicit Variants(std::vector<Change> changes) : changes_(std::move(changes)) {
        fs::create_directory(folder_.path() / "abi");
        fs::copy(fixture / "shared.h", folder_.path() / "abi");
        take_back();
        REQUIRE(ended("record").exit == 0);
        for (std::size_t i = 0; i < changes_.size(); ++i) {
            std::string text = read_file(fixture / "gauge.h");
            CAPTURE(changes_[i].what);
            REQUIRE(count(text, changes_[i].from) == 1);
            replace_all(text, changes_[i].from, changes_[i].to);
            write(i, text);
        }
    }

    /// All changes undone.
    void take_back() {
        for (std::size_t i = 0; i < changes_.size(); ++i) write(i, read_file(fixture / "gauge.h"));
    }

    /// What is told of each change, as of gauge.h: "" where nothing is.
    std::map<std::string, std::string> told(const std::string& command) const {
        const Ended all = ended(command);
        CAPTURE(all.err);
        REQUIRE(all.err.empty());
        std::map<std::string, std::string> told;
        for (std::size_t i = 0; i < changes_.size(); ++i) {
            const std::string begin = "pelorus.gauge" + suffix(i) + "/1: ";
            const std::size_t at = all.out.find(begin);
            std::string& line = told[changes_[i].what];
            if (at != std::string::npos)
                line = all.out.substr(at + begin.size(), all.out.find('\n', at) - at - begin.size());
            replace_all(line, "gauge" + suffix(i), "gauge");
        }
        return told;
    }

private:
    static std::string suffix(std::size_t index) { return {'_', static_cast<char>('a' + index), 'x'}; }

    void write(std::size_t index, std::string text) const {
        for (const char* name : {"gauge", "plr_point", "plr_scale"}) replace_all(text, name, name + suffix(index));
        std::string upper = suffix(index);
        std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
        for (const char* name : {"GAUGE", "SCALE"}) replace_all(text, name, name + upper);
        folder_.write("abi/gauge" + suffix(index) + ".h", text);
    }

    Ended ended(const std::string& command) const { return abi(command, folder_ / "abi", folder_ / "baseline"); }

    std::vector<Change> changes_;
    TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("headers that are as recorded pass, comments and new macros included", "[abi]") {
    Fixture fixture;
    CHECK(fixture.told().empty());
    fixture.change("gauge.h", "/* A table that is frozen. */",
                   "/* Frozen; struct plr_other { int x; } of a comment. */");
    fixture.change("shared.h", "#include <stdint.h>", "#include <stdint.h>\n#define PLR_HELPER(x) ((x) + 1)");
    CHECK(fixture.told().empty());
}

TEST_CASE("every change of a frozen table is told", "[abi]") {
    const std::vector<Change> changes = {
        {"a function is appended", "\n} plr_gauge;", "\n  int32_t (*more)(void* self);\n} plr_gauge;"},
        {"a function is taken out", "  int32_t (*move)(void* self, plr_point to, double speed);\n", ""},
        {"a function is inserted", "  int32_t (*read)", "  int32_t (*more)(void* self);\n  int32_t (*read)"},
        {"two functions change places",
         "  int32_t (*read)(const void* self, const plr_gauge_read* args);\n"
         "  int32_t (*move)(void* self, plr_point to, double speed);\n",
         "  int32_t (*move)(void* self, plr_point to, double speed);\n"
         "  int32_t (*read)(const void* self, const plr_gauge_read* args);\n"},
        {"a result is retyped", "int32_t (*read)", "int64_t (*read)"},
        {"an argument is added", "double speed)", "double speed, int32_t how)"},
        {"an argument is retyped", "double speed)", "float speed)"},
        {"an argument by value becomes a pointer", "plr_point to", "const plr_point* to"},
        {"a struct that is passed by value grows", "double x, y;", "double x, y, z;"},
        {"a struct that is passed by value is retyped", "double x, y;", "float x, y;"},
    };
    const Variants variants(changes);
    for (const auto& [what, told] : variants.told("check")) {
        CAPTURE(what);
        CHECK(told == frozen);
    }
}

TEST_CASE("every change of a frozen argument, descriptor or constant is told", "[abi]") {
    const std::vector<Change> changes = {
        {"a member is retyped", "int64_t channels", "double channels"},
        {"a member changes its sign", "int64_t channels", "uint64_t channels"},
        {"a pointer is retyped", "const double* weights", "const float* weights"},
        {"a pointer becomes a pointer to anything", "const plr_about* about", "const void* about"},
        {"a member is renamed", "weights", "factors"},
        {"a member is inserted", "  plr_list out;", "  double more;\n  plr_list out;"},
        {"a member is taken out", "  const double* weights;\n", ""},
        {"the tail grows into padding, which an older struct_size covers", "  plr_scale scale;\n",
         "  plr_scale scale;\n  uint32_t more;\n"},
        {"the tail grows, and a member before it is retyped", "  int64_t channels;\n  plr_scale scale;\n",
         "  uint64_t channels;\n  plr_scale scale;\n  uint32_t gap;\n  double more;\n"},
        {"the tail grows, and members before it change places", "  int64_t channels;\n  plr_scale scale;\n",
         "  plr_scale scale;\n  uint32_t gap;\n  int64_t channels;\n  double more;\n"},
        {"the layout is packed", "} plr_gauge_info;", "} __attribute__((packed)) plr_gauge_info;"},
        {"an enumerator gets another value", "COARSE = 2", "COARSE = 3"},
        {"an enum is resized by a large enumerator", "COARSE = 2", "COARSE = 2, PLR_SCALE_HUGE = 0x100000000"},
        {"a flag gets another value", "SIGNED = 1u << 1", "SIGNED = 1u << 2"},
        {"a flag is taken out", ", PLR_GAUGE_SIGNED = 1u << 1", ""},
    };
    const Variants variants(changes);
    for (const auto& [what, told] : variants.told("check")) {
        CAPTURE(what);
        CHECK(told == frozen);
    }
}

TEST_CASE("growth at the end is told apart from change, and what was recorded stays", "[abi]") {
    const std::vector<Change> changes = {
        {"a member after the last", "\n} plr_gauge_read;", "\n  double more;\n} plr_gauge_read;"},
        {"several", "\n} plr_gauge_read;", "\n  double more;\n  plr_list others;\n} plr_gauge_read;"},
        {"an enumerator", "COARSE = 2", "COARSE = 2, PLR_SCALE_ROUGH = 3"},
        {"a flag", "SIGNED = 1u << 1", "SIGNED = 1u << 1, PLR_GAUGE_SLOW = 1u << 2"},
        {"a struct that nothing else knows", "\n} plr_gauge;",
         "\n} plr_gauge;\ntypedef struct plr_gauge_more {\n  uint32_t struct_size;\n} plr_gauge_more;"},
    };
    Variants variants(changes);
    for (const auto& [what, told] : variants.told("check")) {
        CAPTURE(what);
        CHECK(told == grew);
    }
    for (const auto& [what, told] : variants.told("record")) {
        CAPTURE(what);
        CHECK(told == "recorded");
    }
    CHECK(variants.told("check").at("several").empty());
    variants.take_back();
    for (const auto& [what, told] : variants.told("check")) {
        CAPTURE(what);
        CHECK(told == frozen);
    }
}

TEST_CASE("a frozen table is not recorded anew", "[abi]") {
    Fixture fixture;
    const std::string before = fixture.record("pelorus.gauge/1");
    fixture.change("gauge.h", "int64_t channels", "double channels");
    const Ended recorded = fixture.ended("record");
    CHECK(recorded.exit == 1);
    CHECK(Fixture::lines_of(recorded.out) == gauge_frozen);
    CHECK_THAT(recorded.out, Contains("type of 'int64_t channels' changed"));
    CHECK(fixture.record("pelorus.gauge/1") == before);

    SECTION("nor taken out") {
        fixture.change("gauge.h", "pelorus.gauge/1", "pelorus.gauge/2");
        CHECK(fixture.ended("record").exit == 1);
        CHECK_THAT(fixture.ended("check").out,
                   Contains("pelorus.gauge/1: is frozen for ever, but no header has it any more"));
        CHECK(fixture.has("pelorus.gauge/1"));
    }
    SECTION("nor made a draft again") {
        fixture.change("gauge.h", "pelorus.gauge/1", "pelorus.gauge.draft/2");
        const Ended again = fixture.ended("record");
        CHECK(again.exit == 1);
        CHECK_THAT(again.out, Contains("pelorus.gauge.draft/2: comes after pelorus.gauge/1, which is frozen\n"));
        CHECK(!fixture.has("pelorus.gauge.draft/2"));
    }
}

TEST_CASE("a second version of a frozen table stands beside the first", "[abi]") {
    Fixture fixture;
    fixture.change("gauge.h", "\n} plr_gauge;",
                   "\n} plr_gauge;\n#define PLR_GAUGE_2 \"pelorus.gauge/2\"\ntypedef struct plr_gauge_2 {\n"
                   "  uint32_t struct_size;\n  int32_t (*read)(const void* self);\n} plr_gauge_2;");
    CHECK(fixture.told() == "pelorus.gauge/2: is not recorded: record it\n");
    CHECK(fixture.told("record") == "pelorus.gauge/2: recorded\n");
    CHECK(fixture.told().empty());
}

TEST_CASE("a draft may change when its number is raised, and not otherwise", "[abi]") {
    Fixture fixture;
    fixture.change("dial.h", "double angle", "float angle");
    const Ended refused = fixture.ended("record");
    CHECK(refused.exit == 1);
    CHECK(Fixture::lines_of(refused.out) ==
          "pelorus.dial.draft/2: changed: raise it to pelorus.dial.draft/3, then record it\n");
    fixture.change("dial.h", "draft/2", "draft/3");
    CHECK(fixture.told() ==
          "pelorus.dial.draft/3: is not recorded: record it\n"
          "pelorus.dial.draft/2: is recorded, but no header has it any more: record that\n");
    CHECK(fixture.told("record") == "pelorus.dial.draft/3: recorded\npelorus.dial.draft/2: taken out\n");
    CHECK(!fixture.has("pelorus.dial.draft/2"));
    CHECK(fixture.told().empty());
}

TEST_CASE("the number of a draft does not fall, and a draft that is frozen changes no more", "[abi]") {
    Fixture fixture;
    fixture.change("dial.h", "draft/2", "draft/1");
    CHECK_THAT(fixture.told(), Contains("pelorus.dial.draft/1: comes after pelorus.dial.draft/2, which was there"));
    fixture.change("dial.h", "dial.draft/1", "dial/1");
    CHECK(fixture.told("record") == "pelorus.dial/1: recorded\npelorus.dial.draft/2: taken out\n");
    fixture.change("dial.h", "double angle", "float angle");
    CHECK_THAT(fixture.told(), Contains("pelorus.dial/1: changed, and it is frozen for ever"));
}

TEST_CASE("what tables share is told under every id that it changes", "[abi]") {
    Fixture fixture;
    SECTION("a struct that cannot grow") {
        fixture.change("shared.h", "int64_t count;", "int32_t count;");
        CHECK(fixture.told() == "pelorus.abi/3: changed: raise PLR_ABI_MAJOR to 4, then record it\n" + gauge_frozen);
    }
    SECTION("growth") {
        fixture.change("shared.h", "\n} plr_about;", "\n  const char* more;\n} plr_about;");
        CHECK(fixture.told() ==
              "pelorus.abi/3: grew at its end, which is allowed: record it\npelorus.gauge/1: " + grew + "\n");
    }
    SECTION("a text") {
        fixture.change("shared.h", "\"plr_link\"", "\"plr_other\"");
        CHECK(fixture.told() == "pelorus.abi/3: changed: raise PLR_ABI_MAJOR to 4, then record it\n");
    }
    SECTION("a raised major") {
        fixture.change("shared.h", "PLR_ABI_MAJOR 3", "PLR_ABI_MAJOR 4").change("shared.h", "count;", "number;");
        CHECK_THAT(fixture.told(), Contains("pelorus.abi/4: is not recorded") && EndsWith("record that\n"));
    }
    SECTION("frozen as soon as no table is a draft") {
        fixture.change("dial.h", "dial.draft/2", "dial/1").change("shared.h", "flags;", "marks;");
        CHECK_THAT(fixture.told(), Contains("pelorus.abi/3: changed, and it is frozen for ever"));
    }
}

TEST_CASE("a struct that the comparison cannot see is an error, not a silence", "[abi]") {
    Fixture fixture;
    SECTION("hidden by a macro") {
        fixture.change("gauge.h", "typedef struct plr_point {", "#define STRUCT struct\ntypedef STRUCT plr_point {");
        const Ended checked = fixture.ended("check");
        CHECK(checked.exit == 2);
        CHECK_THAT(checked.err, Contains("without a witness") && Contains("plr_point"));
    }
    SECTION("headers that do not compile") {
        fixture.change("gauge.h", "double x, y;", "double x, , y;");
        const Ended checked = fixture.ended("check");
        CHECK(checked.exit == 2);
        CHECK_THAT(checked.err, Contains("abi.py: cc failed: "));
    }
}
