// The runner as its users meet it: `pelorus conform`, its reports, its exit codes; and that no plugin is left out.
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <set>
#include <thread>

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
const std::string saboteur = PELORUS_SABOTEURS "/covariances-symmetric.so";

}  // namespace

TEST_CASE("Every plugin that is listed has its conformance test") {
    std::set<std::string> tested;
    std::ifstream file(PELORUS_CONFORMANCE_LIBRARIES);
    for (std::string line; std::getline(file, line);) tested.insert(fs::canonical(line).string());
    const Json plugins = Json::parse(pelorus::test::shipped_command({"list", "--json"}).out);
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
    CHECK(ended.out.find("FAIL    covariances-symmetric") != std::string::npos);
    CHECK(ended.out.find("A covariance is symmetric") != std::string::npos);
    CHECK(ended.out.find("out[1, 0] of item 0") != std::string::npos);
    CHECK(ended.out.find("--only covariances-symmetric --seed 3") != std::string::npos);
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
    const Ended ended = pelorus_command({"conform", singer, "--only", "covariances-symmetric", "--json", "-"});
    std::set<std::string> names;
    const Json report = Json::parse(ended.out);
    for (const Json& check : report["checks"]) names.insert(check["name"].get<std::string>());
    CHECK(names.count("covariances-symmetric") == 1);
    CHECK(names.count("library-loads") == 1);
    CHECK(names.count("instance-is-made") == 1);
    CHECK(names.count("numbers-finite") == 1);
    CHECK(names.count("batch-equals-singles") == 0);
}

TEST_CASE("A plugin that nobody told what it needs is skipped, which is no pass") {
    const Ended ended = pelorus_command({"conform", PELORUS_PLUGIN_DIR "/source/csv.so", "--level", "1"});
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 1);
    CHECK(ended.out.find("skipped instance-is-made: parameter ") != std::string::npos);
    CHECK(ended.out.find("--subjects FILE") != std::string::npos);
    CHECK(ended.out.find("FAIL") == std::string::npos);
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

namespace {

/// The report on the zoo's motion, which commits a misdeed in propagate.
Json report_on_misdeed(const std::string& misdeed, const std::vector<std::string>& flags = {}) {
    const pelorus::test::TemporaryFolder folder;
    const std::string subjects = folder.write(
        "subjects.yaml", "misdeed: {use: org.example.motion.zoo, with: {fault: " + misdeed + ", call: propagate}}\n");
    std::vector<std::string> words{
        "conform", PELORUS_TEST_PLUGINS "/zoo_motion.so", "--subjects", subjects, "--only", "calls-come-back",
        "--json=-"};
    words.insert(words.end(), flags.begin(), flags.end());
    const Ended ended = pelorus_command(words);
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 1);
    return Json::parse(ended.out);
}

Json result_of(const Json& report, const std::string& check) {
    for (const Json& result : report["checks"])
        if (result["name"] == check) return result;
    FAIL("the report lacks " << check);
    return {};
}

std::string messages_of(const Json& result) {
    std::string text;
    for (const Json& message : result["messages"]) text += message.get<std::string>() + "\n";
    return text;
}

}  // namespace

TEST_CASE("A misspelt parameter in a file of subjects is told with its place and the word that was meant") {
    const pelorus::test::TemporaryFolder folder;
    const std::string subjects =
        folder.write("subjects.yaml", "one:\n  use: motion.singer\n  with: {maneuver_rat: 0.1 1/s}\n");
    const Ended ended =
        pelorus_command({"conform", singer, "--subjects", subjects, "--only", "instance-is-made", "--json=-"});
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 1);
    const std::string told = messages_of(result_of(Json::parse(ended.out), "instance-is-made"));
    CHECK(told.find("subjects.yaml:3:10: motion.singer has no parameter 'maneuver_rat'; did you mean "
                    "'maneuver_rate'?") != std::string::npos);
}

TEST_CASE("A plugin that crashes in a check is a verdict, with signal, subject and place") {
    for (const auto& [misdeed, words] : std::map<std::string, std::string>{
             {"segfault", "SIGSEGV"}, {"overflow", "SIGSEGV"}, {"abort", "SIGABRT"}, {"terminate", "SIGABRT"}}) {
        CAPTURE(misdeed);
        const Json result = result_of(report_on_misdeed(misdeed), "calls-come-back");
        const std::string told = messages_of(result);
        CAPTURE(told);
        CHECK(result["verdict"] == "crash");
        CHECK(told.find(words) != std::string::npos);
        CHECK(told.find("with {misdeed}") != std::string::npos);
        CHECK(told.find("zoo.hpp:") != std::string::npos);
    }
}

TEST_CASE("A plugin that does not come back hangs, and the other checks go on") {
    const Json report = report_on_misdeed("hangs", {"--time-limit", "1", "--only", "instance-is-made"});
    CHECK(result_of(report, "calls-come-back")["verdict"] == "hang");
    CHECK(messages_of(result_of(report, "calls-come-back")).find("within 1 s") != std::string::npos);
    CHECK(messages_of(result_of(report, "calls-come-back")).find("it was still under way; at zoo::misbehave") !=
          std::string::npos);
    CHECK(result_of(report, "instance-is-made")["verdict"] == "pass");
}

TEST_CASE("An exception that leaves a call is a failure with its words") {
    const Json result = result_of(report_on_misdeed("throws", {"--only", "calls-succeed"}), "calls-succeed");
    CHECK(result["verdict"] == "fail");
    CHECK(messages_of(result).find("propagate was left by a std::exception: boom") != std::string::npos);
}

TEST_CASE("Conformance that is interrupted tells what it found, and is not well") {
    pelorus::test::Process running({PELORUS_CONFORM, singer, "--level=5", "--jobs=1"});
    std::this_thread::sleep_for(std::chrono::seconds(2));  // some checks are done, and many are not
    running.send(SIGINT);
    const Ended ended = running.wait();
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 1);
    CHECK(ended.out.find("pass    library-loads") != std::string::npos);
    CHECK(ended.out.find(": interrupted\n") != std::string::npos);
    CHECK(ended.out.find(", interrupted; levels 1 to 5") != std::string::npos);
}

TEST_CASE("An earlier report tells each check as the run did") {
    const pelorus::test::TemporaryFolder folder;
    const std::string file = folder / "report.json";
    const Ended whole = pelorus_command({"conform", saboteur, "--json", file});
    const Ended again = pelorus_command({"conform", saboteur, "--from", file});
    CHECK(again.exit == whole.exit);
    CHECK(again.out == whole.out);
    const auto one = [&](const std::string& name) {
        return pelorus_command({"conform", saboteur, "--from", file, "--only", name});
    };
    CHECK(one("covariances-symmetric").exit == 1);
    CHECK(one("library-loads").exit == 0);
    const Ended skipped = one("threads-race-free");
    CHECK(skipped.exit == 0);
    CHECK(skipped.out.find("0 passed, 1 skipped") != std::string::npos);
    const Ended unknown = one("no-such-check");
    CHECK(unknown.exit == 2);
    CHECK(unknown.err.find("tells nothing of a check no-such-check") != std::string::npos);
    std::ofstream(file) << "{}";
    CHECK(one("library-loads").exit == 2);
    CHECK(pelorus_command({"conform", saboteur, "--from", folder / "nothing"}).exit == 2);
}
