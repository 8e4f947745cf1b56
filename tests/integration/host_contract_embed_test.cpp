// As host_contract_test.cpp, where an application holds the host: several pipelines at once, in threads of its own.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <functional>
#include <thread>

#include <pelorus/embed.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/spy_log.hpp"

using namespace pelorus::test;
using pelorus::Pipeline;

namespace {

/// Nodes whose names end with `name`, so that one log tells pipelines apart.
std::string config(const std::string& name) {
    return R"(pelorus: 1
run: {seed: 3}
graph:
  world_)" +
           name + R"(: {use: org.example.source.spy, with: {events: 5}}
  holder_)" +
           name + R"(:
    use: org.example.tracker.spy
    in: {scans: world_)" +
           name + R"(.scans}
    parts:
      motion: {use: org.example.motion.spy}
      sensor: {use: org.example.sensor.spy}
  files_)" +
           name + R"(: {use: org.example.sink.spy, in: {tracks: holder_)" + name + R"(.tracks}}
)";
}

/// Opens a pipeline, plays it, finishes it where told to, and closes it.
bool has_played(const std::string& name, bool finishes) {
    pelorus::PipelineOptions options;
    options.plugin_folders = {PELORUS_BUILD_DIR "/fixtures/spy"};
    auto pipeline = Pipeline::open_text(config(name), name + ".yaml", "/", options);
    return pipeline && pipeline->play() && (!finishes || pipeline->finish());
}

SpyLog log_of(const TemporaryFolder& folder, const std::function<void()>& work) {
    const std::string file = folder / "log.jsonl";
    ::setenv("PELORUS_SPY_LOG", file.c_str(), 1);
    work();
    ::unsetenv("PELORUS_SPY_LOG");
    return SpyLog(file);
}

}  // namespace

TEST_CASE("an application's pipeline calls plugins as the command does", "[spy]") {
    const TemporaryFolder folder;
    bool good = false;
    const SpyLog log = log_of(folder, [&] { good = has_played("a", true); });
    REQUIRE(good);
    log.check_contexts();
    log.check_threads();
    log.check_order({"world_a", "holder_a", "files_a"});
    log.check_finish({"world_a", "holder_a", "files_a"});
    for (const auto& call : log.calls()) CHECK(call["thread"] == log.calls().front()["thread"]);
}

TEST_CASE("a pipeline that is closed without being finished calls no finish, and ends its instances", "[spy]") {
    const TemporaryFolder folder;
    bool good = false;
    const SpyLog log = log_of(folder, [&] { good = has_played("b", false); });
    REQUIRE(good);
    CHECK(log.named("finish").empty());
    CHECK(log.named("destroy").size() == log.named("create").size());
    CHECK(log.named("create").size() == 5);
}

TEST_CASE("pipelines in several threads at once: calls marked main come one at a time", "[spy]") {
    const TemporaryFolder folder;
    std::vector<int> good(4, 0);
    const SpyLog log = log_of(folder, [&] {
        std::vector<std::thread> threads;
        for (std::size_t i = 0; i < good.size(); ++i)
            threads.emplace_back([&good, i] {
                for (int round = 0; round < 3; ++round)
                    good[i] +=
                        has_played(std::string{static_cast<char>('c' + i), static_cast<char>('0' + round)}, true);
            });
        for (std::thread& thread : threads) thread.join();
    });
    CHECK(good == std::vector<int>(4, 3));
    log.check_contexts();
    log.check_threads();
    CHECK(log.named("create").size() == 4 * 3 * 5);
    CHECK(log.named("destroy").size() == 4 * 3 * 5);
    CHECK(log.named("finish").size() == 4 * 3 * 3);
}
