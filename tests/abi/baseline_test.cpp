// The ABI as it is, against the ABI as it was recorded. tests/abi/README.md says what to do where these fail.
#include <catch2/catch.hpp>
#include <filesystem>
#include <regex>
#include <set>

#include <pelorus/abi/threads.h>

#include "support.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

const std::string headers = today + "/pelorus/abi";
const std::string baseline = PELORUS_SOURCE_DIR "/tests/abi/baseline";

std::set<std::string> found(const std::string& text, const char* pattern) {
    const std::regex expression(pattern);
    std::set<std::string> names;
    for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at) names.insert((*at)[1]);
    return names;
}

}  // namespace

TEST_CASE("the ABI is the one that was recorded", "[abi]") {
    const std::string compiler = GENERATE(as<std::string>{}, "cc", "clang");
    const Ended checked = abi("check", headers, baseline, compiler);
    CAPTURE(compiler, checked.out, checked.err);
    CHECK(checked.exit == 0);
    CHECK(checked.out.empty());
}

TEST_CASE("the ABI witness has a function for every struct whose layout the headers assert", "[abi]") {
    const TemporaryFolder folder;
    const Ended written = abi("witness", headers, baseline);
    REQUIRE(written.exit == 0);
    const std::string source = folder.write("witness.c", written.out);
    REQUIRE(run({"cc", "-std=c11", "-shared", "-fPIC", "-I", headers, source, "-o", folder / "witness.so"}).exit == 0);
    const std::string symbols = run({"nm", "-D", "--defined-only", folder / "witness.so"}).out;
    const std::set<std::string> asserted = found(read_file(headers + "/layout.h"), R"(PLR_SIZE\((plr_\w+), )");
    CHECK(found(symbols, R"( T witness_(plr_\w+))") == asserted);
    CHECK(asserted.size() > 90);
    CHECK_THAT(symbols, Contains("witness_constants_PLR_OK") && Contains("witness_text_PLR_ENTRY_SYMBOL_is_plr_entry"));
}

TEST_CASE("every id of the headers has a record of its own", "[abi]") {
    std::set<std::string> ids, records;
    for (const auto& entry : std::filesystem::directory_iterator(headers))
        if (entry.path().extension() == ".h")
            for (const std::string& id : found(read_file(entry.path()), "#define PLR_\\w+ \"(pelorus[.].*/\\d+)\""))
                ids.insert(id + ".abi");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(baseline))
        if (entry.is_regular_file()) records.insert(std::filesystem::relative(entry.path(), baseline).string());
    CHECK(records.count("pelorus.abi/" + std::to_string(PLR_ABI_MAJOR) + ".abi") == 1);
    ids.insert("pelorus.abi/" + std::to_string(PLR_ABI_MAJOR) + ".abi");
    CHECK(ids == records);
}
