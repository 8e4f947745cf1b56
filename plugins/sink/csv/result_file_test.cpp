#include <catch2/catch.hpp>
#include <limits>
#include <pelorus/result_file.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "../../../tests/fixtures/temporary_folder.hpp"

namespace {

/// A file below the result folder of a bench.
struct Opened {
    pelorus::test::Bench bench;
    pelorus::ResultFile file;
    explicit Opened(const pelorus::test::TemporaryFolder& folder, const std::string& name = "out.txt") {
        bench.folder = folder.path().string();
        plr_config config{};
        config.host = bench.host();
        file.setup(pelorus::Setup(config), "file", name);
    }
};

}  // namespace

TEST_CASE("Result files spell numbers and times exactly", "[result_file]") {
    const pelorus::test::TemporaryFolder folder;
    Opened opened(folder);
    const auto line = [&](auto&& write) {
        write();
        opened.file.write("\n");
    };
    line([&] { opened.file.number(0.1); });
    line([&] { opened.file.number(1e300); });
    line([&] { opened.file.number(235070762.0); });
    line([&] { opened.file.seconds(12'109'000'000); });
    line([&] { opened.file.seconds(-1); });
    line([&] { opened.file.seconds(std::numeric_limits<std::int64_t>::min()); });
    line([&] { opened.file.seconds(3'000'000'000); });
    line([&] { opened.file.fixed(-1.0929354321, 7); });
    opened.file.finish();
    CHECK(folder.read("out.txt") ==
          "0.1\n1e+300\n235070762\n12.109\n-0.000000001\n-9223372036.854775808\n3\n-1.0929354\n");
}

TEST_CASE("Result files replace what had their name, and only when they are complete", "[result_file]") {
    const pelorus::test::TemporaryFolder folder;
    folder.write("out.txt", "old");
    folder.write("out.txt.part", "left behind by a process that was killed");
    Opened opened(folder);
    opened.file.write("new");
    CHECK(folder.read("out.txt") == "old");
    opened.file.finish();
    CHECK(folder.read("out.txt") == "new");
    CHECK_FALSE(folder.has("out.txt.part"));
}

TEST_CASE("Result files have one writer", "[result_file]") {
    const pelorus::test::TemporaryFolder folder;
    Opened one(folder), other(folder);
    one.file.write("1");
    CHECK_THROWS_WITH(other.file.write("2"), Catch::Contains("somebody else is writing it"));
    one.file.finish();
    CHECK(folder.read("out.txt") == "1");
}

TEST_CASE("Result files with an absolute name stand where it says", "[result_file]") {
    const pelorus::test::TemporaryFolder folder, other;
    Opened opened(folder, other / "deep/out.txt");
    opened.file.write("x");
    opened.file.finish();
    CHECK(other.read("deep/out.txt") == "x");
}
