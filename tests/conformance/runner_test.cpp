// The runner as its users meet it: `pelorus conform`, its reports, its exit codes; and that no plugin is left out.
#include <catch2/catch.hpp>
#include <fstream>
#include <set>

#include <nlohmann/json.hpp>

#include "fixtures/temporary_folder.hpp"
#include "support/process.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using pelorus::test::count;
using pelorus::test::Ended;
using pelorus::test::pelorus_command;
using pelorus::test::read_file;

const std::string singer = PELORUS_PLUGIN_DIR "/motion/singer.so";
const std::string saboteur = PELORUS_SABOTEURS "/covariances-symmetric-positive.so";

}  // namespace

TEST_CASE("Every plugin that is listed has its conformance test") {
    std::set<std::string> tested;
    std::ifstream file(PELORUS_CONFORMANCE_LIBRARIES);
    for (std::string line; std::getline(file, line);) tested.insert(fs::canonical(line).string());
    const Json plugins = Json::parse(pelorus_command({"list", "--json"}).out);
    REQUIRE(plugins.size() >= 16);
    for (const Json& plugin : plugins) {
        CAPTURE(plugin["id"]);
        CHECK(tested.count(fs::canonical(plugin["library"].get<std::string>()).string()) == 1);
    }
}

TEST_CASE("pelorus conform tells a plugin that is well and exits 0") {
    const Ended ended = pelorus_command({"conform", singer});
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 0);
    CHECK(ended.out.find("pass    batch-equals-singles") != std::string::npos);
    CHECK(ended.out.find("FAIL") == std::string::npos);
}

TEST_CASE("pelorus conform tells what is wrong, why it matters, and how to see it again") {
    const Ended ended = pelorus_command({"conform", saboteur, "--seed", "3"});
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 1);
    CHECK(ended.out.find("FAIL    covariances-symmetric-positive") != std::string::npos);
    CHECK(ended.out.find("A covariance is symmetric") != std::string::npos);
    CHECK(ended.out.find("out[3, 0] of item 0") != std::string::npos);
    CHECK(ended.out.find("--only covariances-symmetric-positive --seed 3") != std::string::npos);
}

TEST_CASE("The reports of pelorus conform agree in all forms") {
    const pelorus::test::TemporaryFolder folder;
    const std::string json_file = folder / "report.json", junit_file = folder / "report.xml";
    const Ended ended = pelorus_command({"conform", saboteur, "--json", json_file, "--junit", junit_file});
    CHECK(ended.exit == 1);
    const Json report = Json::parse(read_file(json_file));
    CHECK(report["well"] == false);
    CHECK(report["counts"]["fail"] == 1);
    const std::string junit = read_file(junit_file);
    CHECK(count(junit, "<failure") == 1);
    CHECK(count(junit, "<testcase") == report["checks"].size());
    CHECK(count(ended.out, "  pass    ") == report["counts"]["pass"]);
}

TEST_CASE("A check by name brings those that it rests on, and no others") {
    const Ended ended = pelorus_command({"conform", singer, "--only", "covariances-symmetric-positive", "--json", "-"});
    std::set<std::string> names;
    const Json report = Json::parse(ended.out);
    for (const Json& check : report["checks"]) names.insert(check["name"].get<std::string>());
    CHECK(names.count("covariances-symmetric-positive") == 1);
    CHECK(names.count("library-loads") == 1);
    CHECK(names.count("instance-is-made") == 1);
    CHECK(names.count("numbers-finite") == 1);
    CHECK(names.count("batch-equals-singles") == 0);
}

TEST_CASE("The lower levels of pelorus conform leave the higher checks out") {
    const Json report = Json::parse(pelorus_command({"conform", singer, "--level", "1", "--json", "-"}).out);
    REQUIRE_FALSE(report["checks"].empty());
    for (const Json& check : report["checks"]) CHECK(check["level"] == 1);
}

TEST_CASE("pelorus conform refuses what cannot be tried with one line and exit code 2") {
    const auto refuses = [](const std::vector<std::string>& words, const std::string& told) {
        std::vector<std::string> all{"conform"};
        all.insert(all.end(), words.begin(), words.end());
        const Ended ended = pelorus_command(all);
        CAPTURE(ended.err);
        CHECK(ended.exit == 2);
        CHECK(count(ended.err, "\n") == 1);
        CHECK(ended.err.find(told) != std::string::npos);
    };
    refuses({"nowhere.so"}, "there is no such file");
    refuses({singer, "--only", "no-such-check"}, "there is no check no-such-check");
    refuses({singer, "--kind", "sensor"}, "none of its plugins is of kind sensor");
    refuses({singer, "--level", "6"}, "--level");
    refuses({}, "LIB.so is missing");
}
