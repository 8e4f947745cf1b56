#include <catch2/catch.hpp>

#include <chrono>
#include <stdexcept>

#include "host/error.hpp"
#include "runtime_fakes.hpp"

using namespace fakes;
using pelorus::runtime::Outcome;
using pelorus::runtime::RunOptions;
using pelorus::runtime::Runtime;

namespace {

constexpr PortOf scans{"scans", PLR_MESSAGE_SCAN};
using Lines = std::vector<std::string>;

/// The line that a run ends with, or "".
std::string error_of(Runtime& runtime, const RunOptions& options = {}) {
    try {
        runtime.run(options);
        return {};
    } catch (const pelorus::Error& error) {
        CHECK(error.exit() == pelorus::Exit::run_failed);
        return error.what();
    }
}

/// world -> tracker -> file, the tracker with that reaction.
struct Pipeline {
    explicit Pipeline(Recorder::Reaction reaction, int scan_count = 4)
        : tracker(std::make_shared<Recorder>("tracker", &log, std::move(reaction))) {
        graph.add("world", "source", std::make_shared<Ticker>(second, scan_count), {}, {scans});
        graph.add("tracker", "tracker", tracker, {scans}, {scans, {"commands", PLR_MESSAGE_VALUES}});
        graph.add("file", "sink", file, {scans});
        graph.connect("world.scans", "tracker.scans");
        graph.connect("tracker.scans", "file.scans");
    }
    Graph graph;
    Lines log;
    std::shared_ptr<Recorder> tracker;
    std::shared_ptr<Recorder> file = std::make_shared<Recorder>("file");
};

plr_status pass_on(Recorder& self, const plr_call& call, const plr_message& message) {
    plr_message copy = message;
    copy.arrival = INT64_MIN;
    return self.publish(call, 0, copy);
}

}  // namespace

TEST_CASE("a refused message is counted, what was published for it is dropped, and the run goes on", "[runtime]") {
    Pipeline pipeline([](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
        const plr_status status = pass_on(self, call, message);
        return first_number(message) == 1 ? fail(call, PLR_E_DATA, "no such sensor") : status;
    });
    Runtime runtime(pipeline.graph.wiring());
    CHECK(runtime.run({}) == Outcome::completed);
    CHECK(pipeline.file->lines == Lines{"file 0 0 0 0", "file 0 2 2 2", "file 0 3 3 3", "file finish"});
    CHECK(pipeline.graph.host("tracker").counters() == std::map<std::string, std::int64_t>{{"refused", 1}});
    CHECK(pipeline.graph.host("file").counters().empty());
}

TEST_CASE("any other failure ends the run in one line with node, plugin, call, port, time, place and item",
          "[runtime]") {
    Pipeline pipeline([](Recorder&, const plr_call& call, std::uint32_t, const plr_message& message) {
        return first_number(message) == 2 ? fail(call, PLR_E_NUMERIC, "not positive\ndefinite", "estimator.noise", 3)
                                          : PLR_OK;
    });
    Runtime runtime(pipeline.graph.wiring());
    CHECK(error_of(runtime) ==
          "node tracker (tracker.fake), receive scans at 2 s: estimator.noise: not positive definite (item 3)");
    CHECK(pipeline.log == Lines{"tracker 0 0 0 0", "tracker 0 1 1 1", "tracker 0 2 2 2"});
    CHECK(pipeline.file->finished);
    CHECK_FALSE(pipeline.tracker->finished);
    CHECK(error_of(runtime) == "the graph has already run: build it anew");
}

TEST_CASE("a failure without a message still says something", "[runtime]") {
    Pipeline pipeline([](Recorder&, const plr_call&, std::uint32_t, const plr_message&) { return PLR_E_IO; });
    Runtime runtime(pipeline.graph.wiring());
    CHECK(error_of(runtime) ==
          "node tracker (tracker.fake), receive scans at 0 s: it answered PLR_E_IO and told no reason");
}

TEST_CASE("an exception that escapes from a plugin ends the run in an orderly way", "[runtime]") {
    Pipeline pipeline([](Recorder&, const plr_call&, std::uint32_t, const plr_message&) -> plr_status {
        throw std::runtime_error("bad cast");
    });
    Runtime runtime(pipeline.graph.wiring());
    CHECK_THAT(error_of(runtime),
               Catch::StartsWith("node tracker (tracker.fake), receive scans at 0 s: ") && Catch::Contains("bad cast"));
    CHECK(pipeline.file->finished);
}

TEST_CASE("after a failure sinks are finished, and what fails then is told too", "[runtime]") {
    Pipeline pipeline([](Recorder&, const plr_call& call, std::uint32_t, const plr_message&) {
        return fail(call, PLR_E_NUMERIC, "diverged");
    });
    pipeline.file->at_finish = [](Recorder&, const plr_call& call) { return fail(call, PLR_E_IO, "disk full"); };
    Runtime runtime(pipeline.graph.wiring());
    CHECK(error_of(runtime) ==
          "node tracker (tracker.fake), receive scans at 0 s: diverged; then node file (sink.fake), finish at "
          "0 s: disk full");
}

TEST_CASE("a failing finish of one stage leaves the sinks behind it finished", "[runtime]") {
    Pipeline pipeline(nullptr);
    pipeline.tracker->at_finish = [](Recorder&, const plr_call& call) { return fail(call, PLR_E_NUMERIC, "diverged"); };
    Runtime runtime(pipeline.graph.wiring());
    CHECK(error_of(runtime) == "node tracker (tracker.fake), finish at 3 s: diverged");
    CHECK(pipeline.file->finished);
}

TEST_CASE("publishing is refused where the contract says so, and a stage that goes on regardless ends the run",
          "[runtime]") {
    plr_status answer = PLR_OK;
    std::string expected;
    Recorder::Reaction reaction;
    SECTION("on a port that is not there") {
        reaction = [&](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
            answer = self.publisher->publish(self.publisher->context, 7, &message, nullptr);
            (void)call;
            return PLR_OK;
        };
        expected = "publish: there is no out port 7; the plugin has 2";
    }
    SECTION("of another kind than the port's") {
        reaction = [&](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
            return answer = self.publish(call, 1, message);
        };
        expected = "commands: publish: the port carries values, not scan";
    }
    SECTION("with an arrival of its own, by another stage than a source") {
        reaction = [&](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
            plr_message later = message;
            later.arrival += second;
            return answer = self.publish(call, 0, later);
        };
        expected =
            "scans: publish: message.arrival is 1 s, but only a source may set another than that of the "
            "event at hand, "
            "0 s";
    }
    SECTION("with a covariance that is not finite") {
        reaction = [&](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
            Scan scan({1, 2, 3});
            scan.variances[1] = NAN;
            return answer = self.publish(call, 0, scan.message(message.time));
        };
        expected = "scans: publish: scan.covariances[1] has nan at (0, 0), expected finite numbers (item 1)";
    }
    SECTION("and a status that the stage passes over ends the run all the same") {
        reaction = [&](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
            answer = self.publish(call, 1, message);
            return PLR_OK;
        };
        expected = "commands: publish: the port carries values, not scan";
    }
    Pipeline pipeline(reaction);
    Runtime runtime(pipeline.graph.wiring());
    CHECK_THAT(error_of(runtime), Catch::StartsWith("node tracker (tracker.fake), receive scans at 0 s: " + expected));
    CHECK(answer == PLR_E_ARGUMENT);
    CHECK(pipeline.file->lines == Lines{"file finish"});
}

TEST_CASE("a port carries only the streams that it declared", "[runtime]") {
    const plr_space plane = position_space(2), line = position_space(1);
    const char* expected = "";
    plr_stream stream{sizeof(plr_stream), 0, "radar", &line, ""};
    SECTION("as declared") {}
    SECTION("another sensor") {
        stream.sensor = "lidar";
        expected =
            "the scan has sensor \"radar\", frame \"\", space (position.x [m]), but the port declared sensor "
            "\"lidar\", "
            "frame \"\", space (position.x [m])";
    }
    SECTION("another space") {
        stream.space = &plane;
        expected = "but the port declared sensor \"radar\", frame \"\", space (position.x [m], position.y [m])";
    }
    SECTION("another frame") {
        stream.frame = "ship";
        expected = "but the port declared sensor \"radar\", frame \"ship\", space (position.x [m])";
    }
    Pipeline pipeline(nullptr);
    pipeline.graph.editable().nodes[0].out_ports[0].streams = {stream};
    // What the tracker's port passes on is what comes in.
    pipeline.graph.editable().nodes[1].out_ports[0].passes_on = 1;
    pelorus::runtime::resolve_streams(pipeline.graph.editable());
    REQUIRE(pipeline.graph.wiring().nodes[1].out_ports[0].streams.size() == 1);
    CHECK(pipeline.graph.wiring().nodes[1].out_ports[0].streams[0].sensor == std::string(stream.sensor));
    Runtime runtime(pipeline.graph.wiring());
    const std::string line_of_error = error_of(runtime);
    if (*expected)
        CHECK_THAT(line_of_error, Catch::Contains(expected));
    else
        CHECK(line_of_error.empty());
}

namespace {

/// Announces the given arrivals (s); emits an empty event for each.
class Announcer : public Stage {
public:
    explicit Announcer(std::vector<double> arrivals) : arrivals_(std::move(arrivals)) {}
    plr_status next(const plr_call&, plr_next& out) override {
        out.what = done_ < arrivals_.size() ? PLR_NEXT_DATA : PLR_NEXT_END;
        if (done_ < arrivals_.size()) out.arrival = out.time = static_cast<std::int64_t>(arrivals_[done_] * second);
        return PLR_OK;
    }
    plr_status emit(const plr_call&) override {
        ++done_;
        return PLR_OK;
    }

private:
    std::vector<double> arrivals_;
    std::size_t done_ = 0;
};

}  // namespace

TEST_CASE("a source whose arrivals run backwards is named", "[runtime]") {
    Graph graph;
    graph.add("radar", "source", std::make_shared<Announcer>(std::vector<double>{1, 4, 3}));
    Runtime runtime(graph.wiring());
    CHECK(error_of(runtime) ==
          "node radar (source.fake), next at 4 s: announces an event at 3 s, before the one that "
          "it emitted at "
          "4 s");
}

TEST_CASE("a source that answers nonsense about what comes next is named", "[runtime]") {
    class Nonsense : public Stage {
        plr_status next(const plr_call&, plr_next& out) override {
            out.what = 17;
            return PLR_OK;
        }
    };
    Graph graph;
    graph.add("radar", "source", std::make_shared<Nonsense>());
    Runtime runtime(graph.wiring());
    CHECK_THAT(error_of(runtime), Catch::StartsWith("node radar (source.fake), next at 0 s: answered 17, expected"));
}

TEST_CASE("a table that lacks a function which its place needs is refused before the run", "[runtime]") {
    static const plr_stage empty = {
        {sizeof(plr_stage), 0, nullptr, nullptr}, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr};
    Pipeline pipeline(nullptr);
    SECTION("a source without next") {
        pipeline.graph.editable().nodes[0].instance.table = &empty.head;
        CHECK_THROWS_WITH(Runtime(pipeline.graph.wiring()),
                          "node world (source.fake), setting up: a source needs the functions next and emit");
    }
    SECTION("a receiver without receive") {
        pipeline.graph.editable().nodes[1].instance.table = &empty.head;
        CHECK_THROWS_WITH(
            Runtime(pipeline.graph.wiring()),
            "node tracker (tracker.fake), setting up: an edge ends here, but the stage has no function receive");
    }
}

TEST_CASE("a stop lets everything finish and keeps what is there", "[runtime]") {
    std::atomic<bool> stop{false};
    Pipeline pipeline(
        [&](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
            if (first_number(message) == 2) stop = true;
            return pass_on(self, call, message);
        },
        1000);
    Runtime runtime(pipeline.graph.wiring());
    RunOptions options;
    options.stop = &stop;
    CHECK(runtime.run(options) == Outcome::stopped);
    CHECK(pipeline.file->lines == Lines{"file 0 0 0 0", "file 0 1 1 1", "file 0 2 2 2", "file finish"});
    CHECK(pipeline.tracker->finished);
}

namespace {

std::int64_t wall_clock() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

/// Has a scan every 30 ms of wall-clock time, `count` times; arrival is when it came.
class Live : public Stage {
public:
    explicit Live(int count) : count_(count), due_(wall_clock() + period) {}
    static constexpr std::int64_t period = 30'000'000;
    plr_status next(const plr_call&, plr_next& out) override {
        const std::int64_t now = wall_clock();
        out.what = count_ == 0 ? PLR_NEXT_END : now < due_ ? PLR_NEXT_WAIT : PLR_NEXT_DATA;
        out.arrival = out.time = due_;
        return PLR_OK;
    }
    plr_status emit(const plr_call& call) override {
        --count_;
        due_ += period;
        const Scan scan({1});
        return publish(call, 0, scan.message(call.time));
    }

private:
    int count_;
    std::int64_t due_;
};

}  // namespace

TEST_CASE("a live source is waited for, while a recorded one from the past goes ahead", "[runtime]") {
    Graph graph;
    Lines log;
    auto live = std::make_shared<Recorder>("live", &log), recorded = std::make_shared<Recorder>("recorded", &log);
    const std::int64_t start = wall_clock();
    graph.add("socket", "source", std::make_shared<Live>(2), {}, {scans});
    graph.add("tape", "source", std::make_shared<Ticker>(second, 3), {}, {scans});
    graph.add("live", "sink", live, {scans});
    graph.add("recorded", "sink", recorded, {scans});
    graph.connect("socket.scans", "live.scans");
    graph.connect("tape.scans", "recorded.scans");
    Runtime runtime(graph.wiring());
    CHECK(runtime.run({}) == Outcome::completed);
    CHECK(wall_clock() - start >= 2 * Live::period);
    REQUIRE(log.size() == 7);
    CHECK(log[2] == "recorded 0 2 2 2");
    CHECK(log[3].substr(0, 5) == "live ");
    CHECK(live->sum == 2);
}

TEST_CASE("what a live source stamped before another one's event was handled comes late, not never", "[runtime]") {
    /// Nothing at first; then, when the other source's event has been handled, a packet that had come before it.
    class Socket : public Announcer {
    public:
        explicit Socket(const Lines& log) : Announcer({1, 2}), log_(log) {}
        plr_status next(const plr_call& call, plr_next& out) override {
            const plr_status status = Announcer::next(call, out);
            if (log_.empty()) out.what = PLR_NEXT_WAIT, out.arrival = 10 * second;
            return status;
        }
        plr_status emit(const plr_call& call) override {
            Announcer::emit(call);
            const Scan scan({7});
            return publish(call, 0, scan.message(second));
        }

    private:
        const Lines& log_;
    };
    Graph graph;
    Lines log;
    graph.add("tape", "source", std::make_shared<Ticker>(second, 1, 5 * second), {}, {scans});
    graph.add("socket", "source", std::make_shared<Socket>(log), {}, {scans});
    graph.add("sink", "sink", std::make_shared<Recorder>("sink", &log), {scans, {"live", PLR_MESSAGE_SCAN}});
    graph.connect("tape.scans", "sink.scans");
    graph.connect("socket.scans", "sink.live");
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"sink 0 5 5 0", "sink 1 1 5 7", "sink 1 1 5 7", "sink finish"});
}

TEST_CASE("a stop interrupts the wait for a live source", "[runtime]") {
    class Silent : public Stage {
    public:
        explicit Silent(std::atomic<bool>& stop) : stop_(stop) {}
        plr_status next(const plr_call&, plr_next& out) override {
            out.what = PLR_NEXT_WAIT;
            out.arrival = wall_clock() + 3600 * second;
            stop_ = true;  // as a signal would, while the run sleeps
            return PLR_OK;
        }

    private:
        std::atomic<bool>& stop_;
    };
    std::atomic<bool> stop{false};
    Graph graph;
    graph.add("socket", "source", std::make_shared<Silent>(stop), {}, {scans});
    Runtime runtime(graph.wiring());
    RunOptions options;
    options.stop = &stop;
    const std::int64_t start = wall_clock();
    CHECK(runtime.run(options) == Outcome::stopped);
    CHECK(wall_clock() - start < 10 * second);
}
