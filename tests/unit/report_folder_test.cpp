#include <catch2/catch.hpp>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <sys/resource.h>
#include <unistd.h>

#include "host/error.hpp"
#include "report/json_file.hpp"
#include "report/result_folder.hpp"
#include "report/terminal_table.hpp"

using namespace pelorus;
namespace fs = std::filesystem;

namespace {

struct TemporaryFolder {
    TemporaryFolder() {
        std::string name = (fs::temp_directory_path() / "pelorus-report-XXXXXX").string();
        if (::mkdtemp(name.data())) path = name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() { fs::remove_all(path); }
    fs::path path;
};

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

TEST_CASE("a result folder is made, and what is there is replaced", "[report]") {
    TemporaryFolder temporary;
    const fs::path folder = temporary.path / "results" / "airship";
    report::write_result_folder(folder, {{{"cells", 1}}, {{"seed", 7}}, {{"total_seconds", 0.5}}});
    std::ofstream(folder / "tracks.csv") << "time\n";
    report::write_result_folder(folder, {{{"cells", 2}}, {{"seed", 8}}, {{"total_seconds", 0.25}}});
    CHECK(names_in(folder) == std::vector<std::string>{"provenance.json", "summary.json", "timing.json", "tracks.csv"});
    CHECK(text_of(folder / "summary.json") == "{\"cells\": 2}\n");
    CHECK(text_of(folder / "provenance.json") == "{\"seed\": 8}\n");
    CHECK(text_of(folder / "timing.json") == "{\"total_seconds\": 0.25}\n");
    CHECK(report::file_line(folder) == folder.string() + ": provenance.json, summary.json, timing.json, tracks.csv\n");
}

TEST_CASE("what is in the way of a result is told in one line, and nothing is left behind", "[report]") {
    TemporaryFolder temporary;
    const fs::path blocked = temporary.path / "results";
    SECTION("a file in place of the folder") {
        std::ofstream(blocked) << "mine";
        CHECK_THROWS_WITH(report::prepare_folder(blocked),
                          Catch::StartsWith("cannot make the result folder " + blocked.string() + ": "));
        CHECK(text_of(blocked) == "mine");
    }
    SECTION("a file in place of a folder above it") {
        std::ofstream(blocked) << "mine";
        CHECK_THROWS_WITH(report::prepare_folder(blocked / "airship"), Catch::Contains("results is a file; move it"));
    }
    SECTION("a folder in place of a file") {
        fs::create_directories(blocked / "summary.json");
        CHECK_THROWS_WITH(report::write_result_folder(blocked, {}),
                          "cannot write " + (blocked / "summary.json").string() + ": Is a directory");
        CHECK(names_in(blocked) == std::vector<std::string>{"provenance.json", "summary.json", "timing.json"});
    }
    SECTION("a folder that must not be written in") {
        // The superuser may write anywhere but in the kernel's own file systems.
        const fs::path folder = ::geteuid() == 0 ? fs::path("/proc/self") : blocked;
        fs::create_directories(blocked);
        fs::permissions(blocked, fs::perms::owner_read | fs::perms::owner_exec);
        CHECK_THROWS_WITH(report::prepare_folder(folder),
                          Catch::StartsWith("the result folder " + folder.string() + " cannot be written: "));
        fs::permissions(blocked, fs::perms::owner_all);
    }
}

TEST_CASE("when the disk is full the file stays as it was", "[report]") {
    TemporaryFolder temporary;
    const fs::path file = temporary.path / "summary.json";
    report::write_file(file, "old\n");
    ::rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const ::rlimit little{4096, before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &little) == 0);
    CHECK_THROWS_WITH(report::write_file(file, std::string(100000, 'x')),
                      "cannot write " + file.string() + ": File too large");
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    CHECK(text_of(file) == "old\n");
    CHECK(names_in(temporary.path) == std::vector<std::string>{"summary.json"});
}

TEST_CASE("timing.json tells time and counts of every node", "[report]") {
    report::Timings timings;
    timings.total_seconds = 1.5;
    timings.nodes = {{{"world", 10, 0.25, 0.125}, {}, {}},
                     {{"tracker", 20, 1.25, 0.5}, {{"refused", 2}, {"zero", 0}}, {{"load", {"1", 0.5}}}}};
    CHECK(
        report::timing(timings).dump() ==
        R"({"total_seconds":1.5,"nodes":{"world":{"calls":10,"seconds":0.25,"mean_seconds":0.025,"max_seconds":0.125,"counters":{},"gauges":{}},)"
        R"("tracker":{"calls":20,"seconds":1.25,"mean_seconds":0.0625,"max_seconds":0.5,"counters":{"refused":2,"zero":0},"gauges":{"load":{"value":0.5,"unit":"1"}}}}})");
    CHECK(report::counter_lines(timings) == "tracker counted: refused 2\n");
}

TEST_CASE("provenance names host, compiler and instruction set", "[report]") {
    const nlohmann::ordered_json facts = report::build_facts();
    CHECK_FALSE(facts["pelorus"].get<std::string>().empty());
    CHECK_THAT(facts["compiler"].get<std::string>(), Catch::StartsWith("gcc ") || Catch::StartsWith("clang "));
    CHECK(facts["isa"]["processor"].is_array());
    CHECK(facts["isa"]["compiled"].is_string());
}
