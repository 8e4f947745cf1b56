// The host is graded, too: plugins that write down how they are called (tests/fixtures/spy) run in the command, and what they wrote
// is held against the headers of the ABI.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>
#include <utility>

#include <pelorus/abi/abi.h>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"
#include "../support/spy_log.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

/// Two sources with events at the same times, one of which hears commands by a feedback edge; a tracker that publishes in receive
/// and in finish; a sink. `tracker` stands in the tracker's `with`, `motion` in its motion's.
std::string config(const std::string& tracker = "", const std::string& motion = "") {
    return R"(pelorus: 1
run: {seed: 3}
graph:
  world:
    use: org.example.source.spy
    with: {period: 1 s, events: 8, delay: 0.25 s}
    in: {commands: previous(holder.commands)}
  other: {use: org.example.source.spy, with: {period: 2 s, events: 4, late: 0.5 s}}
  third: {use: org.example.source.spy, with: {period: 1 s, offset: 1 s, delay: 0.5 s, events: 3}}
  holder:
    use: org.example.tracker.spy
    with: {)" +
           tracker +
           R"(}
    in: {scans: [other.scans, world.scans, third.scans]}
    parts:
      motion: {use: org.example.motion.spy, with: {)" +
           motion + R"(}}
      sensor: {use: org.example.sensor.spy}
  files: {use: org.example.sink.spy, in: {scans: [world.scans], tracks: holder.tracks}}
)";
}

const std::vector<std::string> nodes = {"world", "other", "third", "holder", "files"};

struct Spied {
    Ended ended;
    SpyLog log;
};

/// `pelorus COMMAND spied.yaml FLAGS`, with a log of its own.
Spied spy(const TemporaryFolder& folder, const std::string& name, const std::string& text,
          std::vector<std::string> words) {
    words.insert(words.begin() + 1, folder.write("spied.yaml", text));
    words.insert(words.end(), {"--plugins", PELORUS_BUILD_DIR "/fixtures/spy"});
    ProcessOptions options;
    options.environment["PELORUS_SPY_LOG"] = folder / (name + ".jsonl");
    Ended ended = pelorus_command(words, options);
    CAPTURE(ended.err);
    REQUIRE(folder.has(name + ".jsonl"));
    return {std::move(ended), SpyLog(folder / (name + ".jsonl"))};
}

Spied run_spied(const TemporaryFolder& folder, const std::string& name, std::vector<std::string> flags = {},
                const std::string& text = config()) {
    flags.insert(flags.begin(), {"run", "--out", folder / name});
    return spy(folder, name, text, flags);
}

/// What a call was given, without what may differ from run to run.
std::vector<SpyLog::Call> without_circumstances(std::vector<SpyLog::Call> calls) {
    for (SpyLog::Call& call : calls)
        for (const char* member : {"begin", "end", "thread"}) call.erase(member);
    return calls;
}

std::vector<SpyLog::Call> sorted(std::vector<SpyLog::Call> calls) {
    std::sort(calls.begin(), calls.end(), [](const auto& a, const auto& b) { return a.dump() < b.dump(); });
    return calls;
}

}  // namespace

TEST_CASE("pelorus run calls stages and models as the headers promise", "[spy]") {
    const TemporaryFolder folder;
    const std::string guard = GENERATE(as<std::string>{}, "start", "all", "off");
    const std::string threads = GENERATE(as<std::string>{}, "1", "2");
    CAPTURE(guard, threads);
    const auto [ended, log] = run_spied(folder, "run", {"--threads", threads, "--guard", guard});
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    log.check_lifecycle();
    log.check_contexts();
    log.check_threads();
    log.check_order(nodes);
    log.check_finish(nodes);
    CHECK(log.created() ==
          std::vector<std::string>{"world", "other", "third", "holder.motion", "holder.sensor", "holder", "files"});
    CHECK(log.named("emit").size() == 15);
    CHECK(log.of("holder", "receive").size() == 15);
    CHECK(log.of("files", "receive").size() == 8 + 15 + 1);
}

TEST_CASE("ports are asked when all instances are there and before the first event", "[spy]") {
    const TemporaryFolder folder;
    const auto [ended, log] = run_spied(folder, "run");
    REQUIRE(ended.exit == 0);
    for (const auto& call : log.named("port_type")) {
        CHECK(call["begin"] > log.named("create").back()["end"]);
        CHECK(call["end"] < log.named("next").front()["begin"]);
    }
    for (const std::string& node : nodes) CHECK(log.of(node, "port_type").size() >= 1);
}

TEST_CASE("messages name who sent them, the edge they came by, and their number", "[spy]") {
    const TemporaryFolder folder;
    const auto [ended, log] = run_spied(folder, "run");
    REQUIRE(ended.exit == 0);
    const std::map<std::string, int> edges = {{"other", 0}, {"world", 1}, {"third", 2}};  // in file order
    for (const auto& call : log.of("holder", "receive")) CHECK(call["edge"] == edges.at(call["origin"]));
    for (const auto& call : log.of("files", "receive")) {
        CHECK(call["edge"] == 0);
        CHECK(call["origin"] == (call["port"] == 0 ? "world" : "holder"));
    }
    // One scan for two receivers: the same message, in file order.
    std::map<std::uint64_t, std::vector<std::string>> receivers;
    for (const auto& call : log.named("receive"))
        if (call["kind"] == static_cast<int>(PLR_MESSAGE_SCAN) && call["origin"] == "world")
            receivers[call["sequence"]].push_back(call["at"]);
    CHECK(receivers.size() == 8);
    for (const auto& [sequence, who] : receivers) CHECK(who == std::vector<std::string>{"holder", "files"});
}

TEST_CASE("a feedback edge delivers all that was published strictly before, oldest first, just before the next event",
          "[spy]") {
    const TemporaryFolder folder;
    const auto [ended, log] = run_spied(folder, "run");
    REQUIRE(ended.exit == 0);
    std::vector<SpyLog::Call> waiting;  // what the holder received successfully, and so answered with a command
    std::uint64_t last = 0;
    std::size_t delivered = 0;
    std::string before;  // what the source was called for last
    for (const auto& call : log.where(is_run_call)) {
        CAPTURE(call.dump());
        if (call["at"] == "holder" && call["call"] == "receive") waiting.push_back(call);
        if (call["at"] != "world") continue;
        if (call["call"] == "receive") {
            REQUIRE(!waiting.empty());
            CHECK(call["arrival"] == waiting.front()["context"]["time"]);
            CHECK(call["arrival"] < call["context"]["time"]);
            CHECK(call["sequence"] > last);
            last = call["sequence"];
            waiting.erase(waiting.begin());
            ++delivered;
        }
        if (call["call"] == "emit")
            CHECK(before == "next");  // it may have other plans after a command: it is asked again
        before = call["call"];
        const bool some_are_due =
            !waiting.empty() && call["call"] == "emit" && waiting.front()["context"]["time"] < call["context"]["time"];
        CHECK_FALSE(some_are_due);
    }
    CHECK(delivered >= 10);
}

TEST_CASE("parallel_for cuts the same blocks for any number of threads, and all calls are the same", "[spy]") {
    const TemporaryFolder folder;
    const Spied one = run_spied(folder, "one", {"--threads", "1"}), two = run_spied(folder, "two", {"--threads", "2"});
    REQUIRE(one.ended.exit == 0);
    REQUIRE(two.ended.exit == 0);
    const bool same_calls =
        sorted(without_circumstances(one.log.calls())) == sorted(without_circumstances(two.log.calls()));
    const bool same_order =
        without_circumstances(one.log.where(is_run_call)) == without_circumstances(two.log.where(is_run_call));
    CHECK(same_calls);
    CHECK(same_order);
    std::set<std::pair<int, int>> blocks;
    for (const auto& call : two.log.named("body")) blocks.emplace(call["first"], call["last"]);
    CHECK(blocks == std::set<std::pair<int, int>>{{0, 3}, {3, 6}, {6, 8}});
    for (const auto& body : two.log.named("body")) {  // "returns when all are done"
        const auto callers = two.log.where([&](const SpyLog::Call& call) {
            return call["at"] == "holder" && call["call"] == "receive" && call["begin"] < body["begin"] &&
                   call["end"] > body["end"];
        });
        CHECK(callers.size() == 1);
    }
    for (const auto& call :
         two.log.where([](const SpyLog::Call& c) { return !c.contains("first") && !c.contains("items"); }))
        CHECK(call["thread"] == two.log.calls().front()["thread"]);
}

TEST_CASE("a model has the scratch memory that it asks for, on every thread, or is refused", "[spy]") {
    const TemporaryFolder folder;
    const auto [ended, log] = run_spied(folder, "most", {"--threads", "2"}, config("", "scratch: 16777216"));
    REQUIRE(ended.exit == 0);
    log.check_contexts();
    const Ended refused = pelorus_command({"check", folder.write("more.yaml", config("", "scratch: 16777217")),
                                           "--plugins", PELORUS_BUILD_DIR "/fixtures/spy"});
    CHECK(refused.exit == 2);
    CHECK_THAT(refused.err,
               Contains("more.yaml:") &&
                   Contains("holder.motion: org.example.motion.spy breaks the contract: info: scratch_bytes is "
                            "16777217, expected at most 16777216"));
}

TEST_CASE("pelorus check makes instances, asks their ports, and runs nothing", "[spy]") {
    const TemporaryFolder folder;
    const auto [ended, log] = spy(folder, "check", config(), {"check"});
    CHECK(ended.exit == 0);
    log.check_lifecycle();
    log.check_contexts();
    log.check_threads();
    CHECK(log.where(is_run_call).empty());
    CHECK(log.named("port_type").size() >= nodes.size());
}

TEST_CASE("a stage is saved between calls, loaded before its first one, and goes on as it would have", "[spy]") {
    const TemporaryFolder folder;
    const Spied whole = run_spied(folder, "whole");
    const Spied first = run_spied(folder, "half", {"--snapshot-at", "3s", "--stop-at-snapshot"});
    REQUIRE(first.ended.exit == 0);
    const Spied second = run_spied(folder, "rest", {"--resume", folder / "half"});
    CAPTURE(second.ended.err);
    REQUIRE(second.ended.exit == 0);
    for (const Spied* half : {&first, &second}) {
        half->log.check_lifecycle();
        half->log.check_contexts();
        half->log.check_threads();
    }
    for (const std::string& node : nodes) {
        CAPTURE(node);
        REQUIRE(first.log.of(node, "save").size() == 1);
        const auto save = first.log.of(node, "save").front();
        CHECK(save["answer"] == 0);
        for (const auto& call : first.log.calls())  // no call of any stage is under way
            CHECK((call == save || call["end"] < save["begin"] || call["begin"] > save["end"]));
        REQUIRE(second.log.of(node, "load").size() == 1);
        CHECK(second.log.of(node, "load").front()["bytes"] == 8);
        const auto own =
            second.log.where([&](const SpyLog::Call& call) { return call["at"] == node && is_run_call(call); });
        CHECK(own.front()["call"] == "load");
    }
    CHECK(first.log.named("load").empty());
    // The events of both halves are those of the whole. What ends the first half comes after the snapshot.
    const auto is_event = [](const SpyLog::Call& call) { return call["call"] == "emit" || call["call"] == "receive"; };
    const auto saved = first.log.named("save").front();
    auto events =
        first.log.where([&](const SpyLog::Call& call) { return is_event(call) && call["end"] < saved["begin"]; });
    CHECK(events.size() > 10);
    for (const auto& call : second.log.where(is_event)) events.push_back(call);
    const bool goes_on_as_the_whole = without_circumstances(events) == without_circumstances(whole.log.where(is_event));
    CHECK(goes_on_as_the_whole);
    second.log.check_finish(nodes);
}

TEST_CASE("a message that is refused leaves nothing behind, and the run goes on", "[spy]") {
    const TemporaryFolder folder;
    const auto [ended, log] = run_spied(folder, "run", {}, config("refuse: 5"));
    REQUIRE(ended.exit == 0);
    CHECK_THAT(ended.err, Contains("refused"));
    log.check_lifecycle();
    log.check_contexts();
    log.check_order(nodes);
    log.check_finish(nodes);
    CHECK(log.of("holder", "receive").size() == 15);
    CHECK(log.of("files", "receive").size() == 8 + 14 + 1);  // what it published in that call is dropped
}

TEST_CASE("when a stage fails, sinks are finished once, all are destroyed, and nothing else is called", "[spy]") {
    const TemporaryFolder folder;
    const auto [ended, log] = run_spied(folder, "run", {}, config("fail: 5"));
    CHECK(ended.exit == 1);
    log.check_lifecycle();
    log.check_contexts();
    log.check_threads();
    log.check_finish({"files"});
    const auto failed = log.of("holder", "receive").back();
    CHECK(failed["answer"] == PLR_E_NUMERIC);
    for (const auto& call : log.where(is_run_call))
        CHECK((call["begin"] <= failed["begin"] || call["call"] == "finish"));
}
