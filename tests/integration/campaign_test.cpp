// `pelorus run` of a campaign: the same bytes however the work is shared out, stopped, killed and gone on with.
#include <csignal>

#include <chrono>
#include <filesystem>
#include <random>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"
#include "../support/small_campaign.hpp"

using namespace pelorus::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// Of six cells.
const char* const config_text = R"(extend: small.yaml
title: a campaign
graph: {world: {with: {scans: 12}}}
campaign: {runs: 20, sweep: {world.sensors.radar.noise: [5 m, 10 m, 20 m]}}
)";

/// An analyzer that fails in some runs and takes its time.
const char* const unlucky = "extend: c.yaml\ngraph:\n  luck: {use: analyzer.unlucky, in: {truth: world.truth}}\n";

struct Bench {
    TemporaryFolder folder;
    std::string small = folder.write("small.yaml", small_campaign);
    std::string config = folder.write("c.yaml", config_text);
    std::string unlucky_config = folder.write("unlucky.yaml", unlucky);

    std::vector<std::string> words(const std::string& out, const std::vector<std::string>& flags,
                                   const std::string& file = {}) const {
        std::vector<std::string> all{"run",       file.empty() ? config : file, "--out", folder / out,
                                     "--plugins", PELORUS_TEST_PLUGINS};
        all.insert(all.end(), flags.begin(), flags.end());
        return all;
    }
    Ended run(const std::string& out, const std::vector<std::string>& flags = {}, const std::string& file = {}) const {
        return pelorus_command(words(out, flags, file));
    }
    /// Runs that must end well; answers summary.json.
    std::string summary(const std::string& out, const std::vector<std::string>& flags = {},
                        const std::string& file = {}) const {
        const Ended ended = run(out, flags, file);
        CAPTURE(ended.err);
        REQUIRE(ended.exit == 0);
        return folder.read(out + "/summary.json");
    }
    Json json(const std::string& file) const { return Json::parse(folder.read(file)); }
};

std::vector<std::string> with_pause(std::vector<std::string> flags, const std::string& pause) {
    flags.insert(flags.end(), {"--set", "luck.pause=" + pause, "--runs", "6"});
    return flags;
}

}  // namespace

TEST_CASE("a campaign leaves a cell for each variant and grid point") {
    const Bench bench;
    const Ended ended = bench.run("out", {"--threads", "2"});
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    CHECK_THAT(ended.out, Contains("a campaign\n6 cells of 20 runs\n") && Contains("errors.position_rmse [m]\n") &&
                              Contains("world.sensors.radar.noise") && Contains("lively"));
    const Json cells = bench.json("out/summary.json")["cells"];
    REQUIRE(cells.size() == 6);
    CHECK(cells[0]["variant"] == "calm");
    CHECK(cells[5]["variant"] == "lively");
    CHECK(cells[4]["sweep"] == Json{{"world.sensors.radar.noise", 10.0}});
    CHECK(cells[4]["runs"] == 20);
    CHECK(cells[4]["scalars"]["errors.position_rmse"]["ci95"].get<double>() > 0);
    CHECK_FALSE(cells[0].contains("paired"));
    CHECK(cells[4]["paired"]["reference"] == "calm");
    const Json paired = cells[4]["paired"]["scalars"]["errors.position_rmse"];
    CHECK(paired["difference"].get<double>() ==
          Approx(cells[4]["scalars"]["errors.position_rmse"]["value"].get<double>() -
                 cells[1]["scalars"]["errors.position_rmse"]["value"].get<double>()));
    CHECK(paired["ci95"].get<double>() < cells[4]["scalars"]["errors.position_rmse"]["ci95"].get<double>());
    CHECK(bench.folder.has("out/tracks.csv"));
    const Json provenance = bench.json("out/provenance.json");
    CHECK(provenance["completed"] == true);
    CHECK(provenance["runs"] == 20);
    CHECK(provenance["campaign"]["cells"].size() == 6);
    CHECK(bench.json("out/timing.json")["runs"] == 120);
}

TEST_CASE("threads do not change a campaign's bytes") {
    const Bench bench;
    const std::string one = bench.summary("one", {"--threads", "1"});
    CHECK(one == bench.summary("two", {"--threads", "2"}));
    CHECK(one == bench.summary("three", {"--threads", "3", "--guard", "all"}));
    CHECK(bench.folder.read("one/tracks.csv") == bench.folder.read("three/tracks.csv"));
    CHECK(bench.folder.read("one/provenance.json") == bench.folder.read("three/provenance.json"));
}

TEST_CASE("the parts of a campaign merge into the undivided one") {
    const Bench bench;
    const std::string whole = bench.summary("whole");
    for (const std::string part : {"1", "2", "3", "4"}) bench.summary("part" + part, {"--cells", part + "/4"});
    CHECK(bench.json("part1/summary.json")["cells"].size() == 2);
    std::vector<std::string> words{"merge"};
    for (const std::string part : {"3", "1", "2"}) words.push_back(bench.folder / ("part" + part));
    words.insert(words.end(), {"--out", bench.folder / "merged"});
    const Ended refused = pelorus_command(words);
    CHECK(refused.exit == 1);
    CHECK_THAT(refused.err, Contains("1 of 6 cells are in none of the folders: 3"));
    words.insert(words.begin() + 1, bench.folder / "part4");
    REQUIRE(pelorus_command({"report", bench.folder / "part1"}).exit == 0);
    const Ended merged = pelorus_command(words);
    CAPTURE(merged.err);
    REQUIRE(merged.exit == 0);
    CHECK_FALSE(bench.folder.has("merged/report.html"));  // that of a part is not the whole's
    const Json tracker = bench.json("merged/timing.json")["nodes"]["tracker"];
    CHECK(tracker["mean_seconds"].get<double>() ==
          Approx(tracker["seconds"].get<double>() / tracker["calls"].get<double>()));
    CHECK(tracker["max_seconds"].get<double>() >= tracker["mean_seconds"].get<double>());
    CHECK(whole == bench.folder.read("merged/summary.json"));
    for (const char* name : {"provenance.json", "campaign.json", "tracks.csv", "truth.csv"})
        CHECK(bench.folder.read(std::string("whole/") + name) == bench.folder.read(std::string("merged/") + name));
    CHECK(bench.summary("merged", {"--resume", bench.folder / "merged"}) == whole);
}

TEST_CASE("parts of different campaigns are not merged") {
    const Bench bench;
    bench.summary("a", {"--cells", "1/2", "--runs", "2"});
    bench.summary("b", {"--cells", "2/2", "--runs", "3"});
    const Ended ended = pelorus_command({"merge", bench.folder / "a", bench.folder / "b", "--out", bench.folder / "c"});
    CHECK(ended.exit == 2);
    CHECK_THAT(ended.err, Contains("parts of different campaigns: runs is 3 there, 2 here"));
    CHECK(pelorus_command({"merge", bench.folder / "c", "--out", bench.folder / "d"}).exit == 2);
    CHECK_THAT(pelorus_command({"merge", bench.folder / "a", "--out", bench.folder / "a"}).err,
               Contains("is one of the parts"));
}

TEST_CASE("a campaign that is killed again and again loses nothing that it has finished") {
    const Bench bench;
    const std::string expected = bench.summary("whole", with_pause({}, "0 s"), bench.unlucky_config);
    const std::string pause = "0.0005 s";
    const std::string undisturbed = bench.summary("slow", with_pause({}, pause), bench.unlucky_config);
    std::mt19937 random(11);
    std::uint64_t before = 0;
    for (int kill = 0; kill < 6; ++kill) {
        std::vector<std::string> words =
            bench.words("out", with_pause({"--threads", "2"}, pause), bench.unlucky_config);
        words.insert(words.begin(), PELORUS_EXECUTABLE);
        const Process process(words);
        std::this_thread::sleep_for(std::chrono::milliseconds(40 + random() % 160));
        process.send(SIGKILL);
    }
    const Ended ended = bench.run("out", with_pause({}, pause), bench.unlucky_config);
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    CHECK(bench.folder.read("out/summary.json") == undisturbed);
    before = bench.json("out/timing.json")["runs"].get<std::uint64_t>();
    CHECK(before <= 36);
    CHECK(bench.json("slow/summary.json")["cells"][0]["scalars"] == Json::parse(expected)["cells"][0]["scalars"]);
}

TEST_CASE("a block that was cut off by a kill is computed again, and what comes before it is not") {
    const Bench bench;
    const std::string whole = bench.summary("whole");
    REQUIRE(bench.run("out", {"--cells", "1/1"}).exit == 0);
    namespace fs = std::filesystem;
    // As a kill while the first cell's fourth block was written would leave it.
    const Ended stopped = bench.run("cut", {"--runs", "20"});
    REQUIRE(stopped.exit == 0);
    fs::remove(bench.folder / "cut/cells/000002.json");
    bench.folder.write("cut/cells/000002.blocks", "half a record");
    const Ended ended = bench.run("cut", {});
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    CHECK_THAT(ended.err, Contains("going on in") && Contains("100 of 120 runs were done"));
    CHECK(bench.folder.read("cut/summary.json") == whole);
    CHECK(bench.json("cut/timing.json")["runs"] == 20);
}

TEST_CASE("another campaign is not gone on with") {
    const Bench bench;
    bench.summary("out", {"--runs", "2"});
    const Ended refused = bench.run("out", {"--runs", "3", "--resume", bench.folder / "out"});
    CHECK(refused.exit == 2);
    CHECK_THAT(refused.err, Contains("--resume: ") && Contains("holds another campaign: runs is 2 there, 3 here"));
    const Ended seeded = bench.run("out", {"--runs", "2", "--seed", "8", "--resume", bench.folder / "out"});
    CHECK(seeded.exit == 2);
    CHECK_THAT(seeded.err, Contains("seed is 7 there, 8 here"));
    const Ended anew = bench.run("out", {"--runs", "3"});
    CHECK(anew.exit == 0);
    CHECK(bench.json("out/timing.json")["runs"] == 18);
    CHECK_THAT(bench.run("fresh", {"--runs", "2", "--resume", bench.folder / "fresh"}).err,
               Contains("holds no campaign yet: it begins now"));
}

TEST_CASE("a signal ends a campaign in an orderly way, and says how to go on") {
    const Bench bench;
    std::vector<std::string> words = bench.words("out", with_pause({}, "0.02 s"), bench.unlucky_config);
    words.insert(words.begin(), PELORUS_EXECUTABLE);
    Process process(words);
    while (process.running() && !bench.folder.has("out/cells/000000.json"))
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    process.send(SIGINT);
    const Ended ended = process.wait();
    CHECK(ended.exit == 1);
    CHECK_THAT(ended.err, Contains("stopped by SIGINT: ") && Contains("go on: pelorus run ") && Contains("--resume "));
    CHECK(bench.json("out/provenance.json")["completed"] == false);
    CHECK(bench.json("out/summary.json")["cells"].size() < 6);
    const std::string whole = bench.summary("whole", with_pause({}, "0.02 s"), bench.unlucky_config);
    CHECK(bench.summary("out", with_pause({"--resume", bench.folder / "out"}, "0.02 s"), bench.unlucky_config) ==
          whole);
}

TEST_CASE("a signal that comes twice at once is one request, and one that comes later ends the process") {
    const Bench bench;
    std::vector<std::string> words = bench.words("out", with_pause({}, "10 s"), bench.unlucky_config);
    words.insert(words.begin(), PELORUS_EXECUTABLE);
    Process process(words);
    while (process.running() && !bench.folder.has("out/truth.csv.part"))
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // it is within a message now
    process.send(SIGINT);
    process.send(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    CHECK(process.running());
    process.send(SIGINT);
    CHECK(process.wait().exit == 128 + SIGINT);
}

TEST_CASE("a failed run is named with the command that repeats it alone") {
    const Bench bench;
    const Ended ended =
        bench.run("out", {"--set", "luck.chance=0.3", "--variant", "lively", "--threads", "1"}, bench.unlucky_config);
    CHECK(ended.exit == 1);
    CHECK_THAT(ended.err, Contains("of cell 0 (variant lively, world.sensors.radar.noise = 5 m), seed 7: node luck "
                                   "(analyzer.unlucky), finish at 11 s: ") &&
                              Contains("out of luck") && Contains("on_failure: continue"));
    const std::size_t place = ended.err.find("alone: pelorus run ");
    REQUIRE(place != std::string::npos);
    const std::size_t begin = place + std::string("alone: pelorus ").size();
    const std::string arguments = ended.err.substr(begin, ended.err.find('\n', begin) - begin);
    CHECK_THAT(arguments, Contains("--set luck.chance=0.3 --variant lively --cell 0 --run "));
    const Ended alone =
        run({"/bin/sh", "-c", "'" PELORUS_EXECUTABLE "' " + arguments + " --out '" + (bench.folder / "alone") + "'"});
    CHECK(alone.exit == 1);
    CHECK_THAT(alone.err, Contains("node luck (analyzer.unlucky), finish at 11 s: "));
}

TEST_CASE("failed runs are counted where the campaign goes on") {
    const Bench bench;
    const std::string config =
        bench.folder.write("on.yaml", "extend: unlucky.yaml\ncampaign: {on_failure: continue}\n");
    const Ended ended = bench.run("out", {"--set", "luck.chance=0.3"}, config);
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    const Json cells = bench.json("out/summary.json")["cells"];
    const auto failed = cells[0]["failed"].get<std::uint64_t>();
    CHECK(failed == cells[0]["failed_runs"].size());
    CHECK(failed == cells[5]["failed"]);  // keys do not depend on the cell
    CHECK(cells[0]["runs"] == 20);
    CHECK_THAT(cells[0]["failure"].get<std::string>(), Contains("out of luck"));
    CHECK_THAT(ended.err, Contains("runs failed and are left out"));
    CHECK_THAT(ended.out, Contains(" failed"));
    CHECK(bench.run("none", {"--set", "luck.chance=1"}, config).exit == 1);
}

TEST_CASE("one run of a campaign is taken out by its number") {
    const Bench bench;
    REQUIRE(bench.run("cell", {"--cell", "4", "--run", "3"}).exit == 0);
    const Json cell = bench.json("cell/summary.json")["cells"][0];
    CHECK(cell["variant"] == "lively");
    CHECK(cell["sweep"] == Json{{"world.sensors.radar.noise", 10.0}});
    CHECK(cell["runs"] == 1);
    CHECK(bench.json("cell/provenance.json")["run"] == 3);
    bench.summary("whole");
    CHECK(bench.json("whole/cells/000004.json")["samples"]["errors.track_count"]["values"][3] ==
          cell["scalars"]["errors.track_count"]["value"]);
    REQUIRE(bench.run("base", {"--run", "0"}).exit == 0);
    CHECK(bench.json("base/summary.json")["cells"][0]["variant"] == "default");
    const std::string first = bench.folder.read("base/summary.json");
    REQUIRE(bench.run("next", {"--run", "1"}).exit == 0);
    CHECK(bench.folder.read("next/summary.json") != first);
    CHECK_THAT(bench.run("x", {"--cell", "6", "--run", "0"}).err, Contains("--cell: there are cells 0 to 5, got 6"));
    CHECK_THAT(bench.run("whole", {"--run", "0"}).err, Contains("holds a campaign; name another folder"));
}

TEST_CASE("every cell of a campaign is checked before anything runs") {
    const Bench bench;
    const std::string wrong = bench.folder.write("wrong.yaml", R"(extend: c.yaml
campaign:
  sweep: {world.sensors.radar.noise: [1 m, 2 s], world.perod: [1 s]}
  variants: {lively: {tracker.estimator.motion.nois: 3}}
)");
    for (const char* command : {"check", "run"}) {
        const Ended ended = pelorus_command({command, wrong});
        CHECK(ended.exit == 2);
        CHECK_THAT(ended.err, Contains(":3:44: world.sensors.radar.noise: expected a value in m, got '2 s'"));
        CHECK_THAT(ended.err,
                   Contains(":3:50: world: source.simulation has no parameter 'perod'; did you mean 'period'?"));
        CHECK_THAT(ended.err, Contains(":4:23: tracker.estimator.motion: motion.constant_velocity has no parameter"));
        CHECK(count(ended.err, "\n") == 3);
    }
    const Ended good = pelorus_command({"check", bench.config, "--variant", "calm"});
    CHECK_THAT(good.out, Contains("good: 4 nodes, 6 edges, 8 plugins, 3 cells of 20 runs"));
    CHECK(pelorus_command({"check", bench.config, "--variant", "clam"}).exit == 2);
}

TEST_CASE("an axis goes when the command line sets its address") {
    const Bench bench;
    bench.summary("out", {"--set", "world.sensors.radar.noise=3m", "--variant", "calm", "--runs", "4"});
    const Json cells = bench.json("out/summary.json")["cells"];
    REQUIRE(cells.size() == 1);
    CHECK(cells[0]["sweep"] == Json::object());
}

TEST_CASE("ranks do not change a campaign's bytes") {
    if (run({"/bin/sh", "-c", "command -v mpirun"}).exit != 0) {
        WARN("skipped: there is no mpirun");
        return;
    }
    const Bench bench;
    const std::string whole = bench.summary("whole");
    std::vector<std::string> words{"mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2", PELORUS_EXECUTABLE};
    for (const std::string& word : bench.words("ranks", {})) words.push_back(word);
    // MPI libraries leave memory behind, which a sanitizer would make a failure of.
    ProcessOptions options;
    options.environment["ASAN_OPTIONS"] = "detect_leaks=0";
    const Ended ended = run(words, options);
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    CHECK(bench.folder.read("ranks/summary.json") == whole);
    CHECK(bench.folder.read("ranks/provenance.json") == bench.folder.read("whole/provenance.json"));
    CHECK(bench.json("ranks/timing.json")["ranks"] == 2);
    words.insert(words.end(), {"--set", "world.period=1 m"});
    const Ended refused = run(words, options);
    CHECK(refused.exit == 2);
    CHECK(count(refused.err, "world.period: expected a value in s") == 1);
}
