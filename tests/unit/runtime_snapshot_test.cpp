#include <catch2/catch.hpp>

#include <random>

#include "host/error.hpp"
#include "report/json_file.hpp"
#include "report/summary.hpp"
#include "runtime/message_block.hpp"
#include "runtime/snapshot.hpp"
#include "runtime_fakes.hpp"

using namespace fakes;
using pelorus::runtime::Outcome;
using pelorus::runtime::RunOptions;
using pelorus::runtime::Runtime;

namespace {

using Bytes = std::vector<unsigned char>;
constexpr PortOf scans{"scans", PLR_MESSAGE_SCAN};
constexpr PortOf commands{"commands", PLR_MESSAGE_VALUES};
constexpr PortOf tables{"tables", PLR_MESSAGE_TABLE};

/// Publishes a scan a second, which arrives 2.5 s later: so there are always some under way.
class Delayed : public Ticker {
public:
    Delayed() : Ticker(second, 8) {}
    plr_status emit(const plr_call& call) override {
        const plr_status status = Ticker::emit(call);
        const Scan scan({static_cast<double>(call.time) / second, 7}, "delayed");
        return status == PLR_OK ? publish(call, 1, scan.message(call.time, call.time + 5 * second / 2)) : status;
    }
};

/// Two sources, one obeying commands over a feedback edge, an analyzer that publishes a table at every scan and one at
/// the end, a sink that keeps count. `fail_load`: the analyzer does not take its state back.
struct World {
    explicit World(bool fail_load = false) {
        class Analyzer : public Recorder {
        public:
            Analyzer(Reaction reaction, bool refuses)
                : Recorder("errors", nullptr, std::move(reaction)), refuses_(refuses) {}
            void load(pelorus::runtime::ByteReader& reader) override {
                if (refuses_) throw std::runtime_error("state of another version");
                Recorder::load(reader);
            }

        private:
            bool refuses_;
        };
        const auto analyze = [this](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
            const double time = static_cast<double>(message.time) / second;
            origins.emplace_back(message.origin ? message.origin : "nobody");
            const Table table("by_time", {0, self.sum, time, -self.sum / 3});
            const Command command(self.sum / 7);
            const plr_status status = self.publish(call, 0, table.message(message.time));
            return status == PLR_OK ? self.publish(call, 1, command.message(message.time)) : status;
        };
        analyzer = std::make_shared<Analyzer>(analyze, fail_load);
        analyzer->at_finish = [](Recorder& self, const plr_call& call) {
            Table table("total", {0, self.sum});
            table.scalar.name = "total";
            return self.publish(call, 0, table.message(call.time));
        };
        graph.add("delayed", "source", delayed, {commands}, {scans, {"late", PLR_MESSAGE_SCAN}});
        graph.add("ticks", "source", std::make_shared<Ticker>(second * 3 / 4, 9, second / 2), {}, {scans});
        graph.add("errors", "analyzer", analyzer, {scans, {"late", PLR_MESSAGE_SCAN}, {"ticks", PLR_MESSAGE_SCAN}},
                  {tables, commands});
        graph.add("file", "sink", file, {tables, commands});
        graph.connect("delayed.scans", "errors.scans");
        graph.connect("delayed.late", "errors.late");
        graph.connect("ticks.scans", "errors.ticks");
        graph.connect("errors.tables", "file.tables");
        graph.connect("errors.commands", "file.commands");
        graph.connect("errors.commands", "delayed.commands", true);
        graph.editable().parameters = "period: 1 s";
    }
    std::string summary(const Runtime& runtime) const {
        return pelorus::report::json_text(pelorus::report::summary({pelorus::report::cell_of_run(runtime.results())}));
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;
    Graph graph;
    std::vector<std::string> origins;  ///< of what the analyzer received
    std::shared_ptr<Delayed> delayed = std::make_shared<Delayed>();
    std::shared_ptr<Recorder> analyzer;
    std::shared_ptr<Recorder> file = std::make_shared<Recorder>("file");
};

/// A snapshot of the world at that time (ns).
Bytes snapshot_at(std::int64_t time) {
    World world;
    Runtime runtime(world.graph.wiring());
    Bytes bytes;
    RunOptions options;
    options.snapshot_at = time;
    options.on_snapshot = [&](const Bytes& taken) { bytes = taken; };
    runtime.run(options);
    return bytes;
}

std::string refusal(const Bytes& bytes, World& world) {
    Runtime runtime(world.graph.wiring());
    try {
        runtime.restore(bytes);
    } catch (const pelorus::Error& error) {
        CHECK(runtime.run({}) == Outcome::completed);  // nothing has been changed
        return error.what();
    }
    return {};
}

std::string refusal(const Bytes& bytes) {
    World world;
    return refusal(bytes, world);
}

/// Puts a fitting checksum behind bytes that were tampered with.
void seal(Bytes& bytes) {
    const std::size_t end = bytes.size() - sizeof(pelorus::runtime::Digest);
    const pelorus::runtime::Digest digest = pelorus::runtime::sha256(bytes.data(), end);
    std::copy(digest.begin(), digest.end(), bytes.begin() + static_cast<std::ptrdiff_t>(end));
}

}  // namespace

TEST_CASE("a run that is resumed from a snapshot of any time ends as if it had not been interrupted",
          "[runtime][snapshot]") {
    World whole;
    Runtime uninterrupted(whole.graph.wiring());
    uninterrupted.run({});
    const std::string expected = whole.summary(uninterrupted);
    REQUIRE_THAT(expected, Catch::Contains("errors.total"));
    REQUIRE(whole.delayed->commands.size() > 5);

    for (std::int64_t time = -second; time <= 11 * second; time += second / 4) {
        CAPTURE(time);
        const Bytes bytes = snapshot_at(time);
        REQUIRE_FALSE(bytes.empty());
        World world;
        Runtime resumed(world.graph.wiring());
        resumed.restore(bytes);
        CHECK(resumed.snapshot() == bytes);
        CHECK(resumed.run({}) == Outcome::completed);
        CHECK(world.summary(resumed) == expected);
        CHECK(world.file->sum == whole.file->sum);
        const auto &all = whole.analyzer->lines, &rest = world.analyzer->lines;
        REQUIRE(rest.size() <= all.size());
        CHECK(std::equal(rest.rbegin(), rest.rend(), all.rbegin()));
        CHECK(std::equal(world.origins.rbegin(), world.origins.rend(), whole.origins.rbegin()));
        const auto &all_commands = whole.delayed->commands, &rest_commands = world.delayed->commands;
        REQUIRE(rest_commands.size() <= all_commands.size());
        CHECK(std::equal(rest_commands.rbegin(), rest_commands.rend(), all_commands.rbegin()));
    }
}

TEST_CASE("a snapshot stands before the first event that arrives after its time", "[runtime][snapshot]") {
    World world;
    Runtime runtime(world.graph.wiring());
    std::size_t lines = 0;
    RunOptions options;
    options.snapshot_at = 2 * second;
    options.on_snapshot = [&](const Bytes&) { lines = world.analyzer->lines.size(); };
    runtime.run(options);
    const auto& all = world.analyzer->lines;
    REQUIRE(lines > 0);
    CHECK(all[lines - 1].find(" 2 2 ") != std::string::npos);
    CHECK(all[lines].find("errors 2 2.75 2.75 ") == std::string::npos);
    CHECK_THAT(all[lines], Catch::StartsWith("errors 1 0 2.5 ") || Catch::StartsWith("errors 0 2.5"));
}

TEST_CASE("a run that is stopped while its snapshot is taken has handled nothing beyond it", "[runtime][snapshot]") {
    World world;
    Runtime runtime(world.graph.wiring());
    std::atomic<bool> stop{false};
    std::size_t lines = 0;
    RunOptions options;
    options.snapshot_at = 2 * second;
    options.stop = &stop;
    options.on_snapshot = [&](const Bytes&) {
        lines = world.analyzer->lines.size();
        stop = true;
    };
    CHECK(runtime.run(options) == Outcome::stopped);
    REQUIRE(world.analyzer->lines.size() == lines + 1);
    CHECK(world.analyzer->lines.back() == "errors finish");
}

TEST_CASE("taking a snapshot changes nothing, and the same run gives the same snapshot", "[runtime][snapshot]") {
    World plain, watched;
    Runtime first(plain.graph.wiring()), second_run(watched.graph.wiring());
    first.run({});
    RunOptions options;
    options.snapshot_at = 3 * second;
    options.on_snapshot = [](const Bytes&) {};
    second_run.run(options);
    CHECK(plain.summary(first) == watched.summary(second_run));
    CHECK(snapshot_at(3 * second) == snapshot_at(3 * second));
}

TEST_CASE("counters, gauges and the refused go on counting after a resume", "[runtime][snapshot]") {
    const auto count = [](Graph& graph) {
        const plr_host* host = graph.host("ticks").host();
        const auto* service = static_cast<const plr_diagnostics*>(host->service(host, PLR_SERVICE_DIAGNOSTICS));
        service->count(service->context, "rows", 3);
        service->gauge(service->context, "load", "1", 0.5);
    };
    World world;
    count(world.graph);
    Runtime runtime(world.graph.wiring());
    const Bytes bytes = runtime.snapshot();
    World again;
    Runtime resumed(again.graph.wiring());
    resumed.restore(bytes);
    count(again.graph);
    CHECK(again.graph.host("ticks").counters().at("rows") == 6);
    CHECK(again.graph.host("ticks").gauges().at("load").value == 0.5);
}

TEST_CASE("a snapshot of another graph is refused by name and nothing is changed", "[runtime][snapshot]") {
    const Bytes bytes = snapshot_at(2 * second);
    World world;
    SECTION("another plugin version") {
        world.graph.editable().nodes[2].version = "1.1.0";
        CHECK(refusal(bytes, world) ==
              "snapshot refused: it was taken from node errors (analyzer.fake 1.0.0), but this graph has errors "
              "(analyzer.fake 1.1.0) in its "
              "place");
    }
    SECTION("other parameters") {
        world.graph.editable().parameters = "period: 2 s";
        CHECK(refusal(bytes, world) ==
              "snapshot refused: it was taken from a graph with the same nodes, but other edges, parameters, parts or "
              "seed");
    }
    SECTION("other parameters, of a config as a graph tells them") {
        const char* const before =
            R"({"seed": 7, "config": {"graph": {"ticks": {"use": "a", "with": {"period": 2.0}}}}})";
        world.graph.editable().parameters = before;
        const Bytes taken = Runtime(world.graph.wiring()).snapshot();
        World again;
        again.graph.editable().parameters =
            R"({"seed": 7, "config": {"graph": {"ticks": {"use": "a", "with": {"period": 1.0}}}}})";
        CHECK(refusal(taken, again) ==
              "snapshot refused: it was taken from another config: ticks.period is 2.0 there, 1.0 here");
    }
    SECTION("other edges") {
        world.graph.editable().edges.pop_back();
        CHECK_THAT(refusal(bytes, world), Catch::Contains("other edges"));
    }
    SECTION("a node more") {
        world.graph.add("map", "sink", std::make_shared<Recorder>("map"), {tables});
        CHECK(refusal(bytes, world) == "snapshot refused: it has no node map, which this graph has");
    }
}

TEST_CASE("a stage that does not take its state is named, and the half restored graph does not run",
          "[runtime][snapshot]") {
    World world(true);
    Runtime runtime(world.graph.wiring());
    CHECK_THROWS_WITH(
        runtime.restore(snapshot_at(2 * second)),
        "snapshot refused: node errors (analyzer.fake), load: state of another version; the graph is half restored and "
        "cannot run");
    CHECK_THROWS_WITH(runtime.run({}), Catch::Contains("half restored"));
}

TEST_CASE("a snapshot can only be restored before the run", "[runtime][snapshot]") {
    World world;
    Runtime runtime(world.graph.wiring());
    const Bytes bytes = runtime.snapshot();
    runtime.run({});
    CHECK_THROWS_WITH(runtime.restore(bytes), "a snapshot can only be restored before the run");
}

TEST_CASE("truncated, damaged and foreign bytes are refused in a clear line", "[runtime][snapshot]") {
    const Bytes good = snapshot_at(4 * second);
    REQUIRE(refusal(good).empty());
    CHECK(refusal({}) == "snapshot refused: it does not begin as a snapshot does");
    CHECK(refusal(Bytes(1000, 0x55)) == "snapshot refused: it does not begin as a snapshot does");
    Bytes bytes = good;
    bytes[8] = 99;
    CHECK(refusal(bytes) == "snapshot refused: it has format 99, expected 2");
    for (const std::size_t size :
         {std::size_t{8}, std::size_t{10}, std::size_t{20}, good.size() / 2, good.size() - 1}) {
        CAPTURE(size);
        CHECK_THAT(refusal(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size))),
                   Catch::StartsWith("snapshot refused: it is truncated") ||
                       Catch::StartsWith("snapshot refused: it is damaged"));
    }
    bytes = good;
    bytes.push_back(0);
    CHECK_THAT(refusal(bytes), Catch::Contains("bytes too many"));
    bytes = good;
    bytes[good.size() / 2] ^= 1u;
    CHECK(refusal(bytes) == "snapshot refused: it is damaged: its checksum does not fit");
}

TEST_CASE("bytes that were changed behind a fitting checksum are never believed beyond their bounds",
          "[runtime][snapshot]") {
    World world;
    const auto wiring = world.graph.wiring();
    pelorus::runtime::MessagePool pool;
    const Bytes good = snapshot_at(4 * second);
    std::mt19937 random(20160112);
    int refused = 0;
    for (int trial = 0; trial < 6000; ++trial) {
        Bytes bytes = good;
        const std::size_t body = bytes.size() - 52;
        for (int change = 0; change < 1 + trial % 3; ++change) {
            const std::size_t place = 20 + random() % body;
            const unsigned char values[] = {0, 1, 0x7f, 0x80, 0xff, static_cast<unsigned char>(random())};
            bytes[place] = values[random() % 6];
        }
        if (trial % 10 == 0) {  // a piece is cut out, and the size says so
            const std::size_t first = 20 + random() % (body / 2), length = 1 + random() % 64;
            bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(first),
                        bytes.begin() + static_cast<std::ptrdiff_t>(first + length));
            const std::uint64_t size = bytes.size() - 52;
            std::memcpy(bytes.data() + 12, &size, sizeof size);
        }
        seal(bytes);
        try {
            (void)pelorus::runtime::from_bytes(bytes, wiring, pool);
        } catch (const pelorus::Error& error) {
            ++refused;
            CHECK_THAT(error.what(), Catch::StartsWith("snapshot refused: "));
        }
    }
    CHECK(refused > 1000);
}
