// What a campaign keeps on disk: whole records, finished cells, one campaign a folder.
#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

#include "../fixtures/temporary_folder.hpp"
#include "campaign/store.hpp"
#include "host/error.hpp"

using namespace pelorus;
using campaign::Store;
using campaign::Totals;
using Json = nlohmann::ordered_json;

namespace {

Totals totals_of(std::uint64_t run) {
    runtime::Table table;
    table.node = "errors";
    table.scalars = {{"score", "m", PLR_REDUCE_MEAN, static_cast<double>(run), 0, "", 1}};
    runtime::Results results;
    results.tables.push_back(table);
    Totals totals;
    totals.add(results, run);
    return totals;
}

std::vector<std::uint64_t> numbers(const Store& store) {
    std::vector<std::uint64_t> found;
    for (const auto& [block, totals] : store.blocks(3)) {
        CHECK(totals.scalars()[0].values[0] == static_cast<double>(block));
        found.push_back(block);
    }
    return found;
}

/// A folder in which a campaign has begun.
struct Bench {
    test::TemporaryFolder folder;
    Store store{folder.path()};
    std::filesystem::path blocks = folder.path() / "cells/000003.blocks";

    Bench() {
        store.lock();
        store.begin({{"runs", 5}});
    }
};

}  // namespace

TEST_CASE("Blocks are read back in the order in which they were kept", "[campaign]") {
    const Bench bench;
    CHECK(numbers(bench.store).empty());
    for (const std::uint64_t block : {4u, 0u, 2u}) bench.store.append(3, block, totals_of(block));
    CHECK(numbers(bench.store) == std::vector<std::uint64_t>{4, 0, 2});
}

TEST_CASE("A block that was cut off anywhere is left out, and what follows is appended in its place", "[campaign]") {
    const Bench bench;
    bench.store.append(3, 0, totals_of(0));
    const auto one = std::filesystem::file_size(bench.blocks);
    for (std::uintmax_t size = one + 1; size < 2 * one; size += 5) {
        bench.store.append(3, 1, totals_of(1));
        std::filesystem::resize_file(bench.blocks, size);
        CHECK(numbers(bench.store) == std::vector<std::uint64_t>{0});
        CHECK(std::filesystem::file_size(bench.blocks) == one);
    }
    bench.store.append(3, 2, totals_of(2));
    CHECK(numbers(bench.store) == std::vector<std::uint64_t>{0, 2});
}

TEST_CASE("A block with a flipped bit is left out", "[campaign]") {
    const Bench bench;
    bench.store.append(3, 0, totals_of(0));
    const auto one = static_cast<std::streamoff>(std::filesystem::file_size(bench.blocks));
    bench.store.append(3, 1, totals_of(1));
    for (std::streamoff at = one; at < 2 * one; at += 3) {
        bench.store.append(3, 1, totals_of(1));
        std::fstream file(bench.blocks, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(at);
        const char byte = static_cast<char>(file.get() ^ 0x10);
        file.seekp(at);
        file.put(byte);
        file.close();
        CHECK(numbers(bench.store) == std::vector<std::uint64_t>{0});
    }
}

TEST_CASE("A finished cell takes the place of its blocks", "[campaign]") {
    const Bench bench;
    bench.store.append(3, 0, totals_of(0));
    CHECK_FALSE(bench.store.has_cell(3));
    bench.store.finish(3, {{"cell", {{"variant", "calm"}, {"x", 0.1}}}});
    CHECK(bench.store.has_cell(3));
    CHECK(bench.store.cell(3)["cell"]["x"] == 0.1);
    CHECK(bench.store.blocks(3).empty());
}

TEST_CASE("A campaign that begins leaves nothing of the one before", "[campaign]") {
    Bench bench;
    bench.store.append(3, 0, totals_of(0));
    bench.store.finish(2, {{"cell", 1}});
    bench.store.begin({{"runs", 6}});
    CHECK_FALSE(bench.store.has_cell(2));
    CHECK(bench.store.blocks(3).empty());
    CHECK((*bench.store.identity())["runs"] == 6);
    CHECK_FALSE(Store(bench.folder.path() / "cells").identity());
}

TEST_CASE("Two campaigns are never at work in one folder", "[campaign]") {
    const Bench bench;
    Store other(bench.folder.path());
    CHECK_THROWS_WITH(other.lock(), Catch::Contains("another campaign is at work in "));
}

TEST_CASE("A cell that is no JSON is told with its file", "[campaign]") {
    const Bench bench;
    bench.folder.write("cells/000007.json", "{\"cell\": ");
    CHECK_THROWS_WITH(bench.store.cell(7), Catch::Contains("000007.json: it is not JSON"));
}
