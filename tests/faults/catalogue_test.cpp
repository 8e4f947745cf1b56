// Every fault of the catalogue (cases/*.yaml) through the command itself: what it prints, its exit code, what is kept.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <set>

#include <catch2/catch.hpp>

#include "../support/process.hpp"
#include "catalogue.hpp"

using namespace pelorus::test;
namespace fs = std::filesystem;

namespace {

const fs::path cases = fs::path(PELORUS_SOURCE_DIR) / "tests/faults/cases";
const fs::path page = fs::path(PELORUS_SOURCE_DIR) / "docs/errors.md";

/// In the order of the page: that of the file names, which begin with a number.
std::vector<FaultGroup> all_groups() {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(cases)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<FaultGroup> groups;
    for (const fs::path& file : files) groups.push_back(read_group(file));
    return groups;
}

void try_group(const std::string& file) {
    const FaultGroup group = read_group(cases / file);
    REQUIRE(!group.cases.empty());
    for (const FaultCase& fault : group.cases) {
        std::string skipped;
        const std::string wrong = try_case(fault, skipped);
        if (!skipped.empty()) WARN("SKIPPED: " << group.name << ": " << fault.title << ": " << skipped);
        INFO(group.name << ": " << fault.title << "\n  $ " << fault.command << "\n" << wrong);
        CHECK(wrong.empty());
    }
}

}  // namespace

TEST_CASE("faults of the command line") { try_group("1-command-line.yaml"); }
TEST_CASE("faults of files and YAML") { try_group("2-files-and-yaml.yaml"); }
TEST_CASE("faults of keys and values") { try_group("3-keys-and-values.yaml"); }
TEST_CASE("faults of parts and edges") { try_group("4-parts-and-edges.yaml"); }
TEST_CASE("faults of spaces, units and frames") { try_group("5-spaces-and-frames.yaml"); }
TEST_CASE("faults of plugins and libraries") { try_group("6-plugins.yaml"); }
TEST_CASE("faults of recordings") { try_group("7-recordings.yaml"); }
TEST_CASE("faults of a run and its results") { try_group("8-runs.yaml"); }
TEST_CASE("faults of snapshots") { try_group("9-snapshots.yaml"); }
TEST_CASE("faults of campaigns") { try_group("91-campaigns.yaml"); }
TEST_CASE("faults of reports") { try_group("92-reports.yaml"); }

TEST_CASE("every file of the catalogue of faults is tried") { CHECK(all_groups().size() == 11); }

TEST_CASE("faults have a title of their own, a command and a cure") {
    std::set<std::string> titles;
    for (const FaultGroup& group : all_groups())
        for (const FaultCase& fault : group.cases) {
            CAPTURE(group.name, fault.title);
            CHECK(titles.insert(fault.title).second);
            CHECK(!fault.command.empty());
            CHECK(!fault.cure.empty());
        }
}

TEST_CASE("the page of errors is what the catalogue makes of it") {
    INFO("write it anew: fault_tests 'write the page of errors'");
    CHECK(read_file(page) == errors_page(all_groups()));
}

TEST_CASE("write the page of errors", "[.]") {
    std::ofstream(page, std::ios::binary) << errors_page(all_groups());
    CHECK(read_file(page) == errors_page(all_groups()));
}
