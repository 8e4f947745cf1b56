#include <catch2/catch.hpp>

#include "runtime/event_queue.hpp"
#include "runtime_fakes.hpp"

using namespace fakes;
using pelorus::runtime::Outcome;
using pelorus::runtime::Runtime;

namespace {

constexpr PortOf scans{"scans", PLR_MESSAGE_SCAN};
constexpr PortOf more{"more", PLR_MESSAGE_SCAN};
using Lines = std::vector<std::string>;

/// Passes every scan on, at the event's own arrival and the given stamp.
Recorder::Reaction forward_scan(std::int64_t stamp_shift = 0) {
    return [=](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
        plr_message copy = message;
        copy.arrival = INT64_MIN;
        copy.time += stamp_shift;
        return self.publish(call, 0, copy);
    };
}

}  // namespace

TEST_CASE("the queue orders by arrival, then time, then node, then sequence", "[runtime]") {
    pelorus::runtime::EventQueue queue;
    using Key = pelorus::runtime::EventKey;
    for (const Key key :
         {Key{2, 0, 0, 0}, Key{1, 5, 1, 3}, Key{1, 5, 1, 2}, Key{1, 5, 0, 9}, Key{1, 4, 7, 8}, Key{-1, 9, 9, 9}})
        queue.push({key, 0, {}});
    std::vector<std::uint64_t> order;
    for (const auto& event : queue.sorted()) order.push_back(event.key.sequence);
    CHECK(order == std::vector<std::uint64_t>{9, 8, 9, 2, 3, 0});
    order.clear();
    while (!queue.empty()) order.push_back(queue.pop().key.sequence);
    CHECK(order == std::vector<std::uint64_t>{9, 8, 9, 2, 3, 0});
}

TEST_CASE("sources of several rates are merged by arrival, at equal arrivals in file order", "[runtime]") {
    Graph graph;
    auto sink = std::make_shared<Recorder>("sink");
    graph.add("slow", "source", std::make_shared<Ticker>(2 * second, 3), {}, {scans});
    graph.add("fast", "source", std::make_shared<Ticker>(second, 4), {}, {scans});
    graph.add("sink", "sink", sink, {scans, more});
    graph.connect("fast.scans", "sink.more");
    graph.connect("slow.scans", "sink.scans");
    Runtime runtime(graph.wiring());
    CHECK(runtime.run({}) == Outcome::completed);
    CHECK(sink->lines == Lines{"sink 0 0 0 0", "sink 1 0 0 0", "sink 1 1 1 1", "sink 0 2 2 1", "sink 1 2 2 2",
                               "sink 1 3 3 3", "sink 0 4 4 2", "sink finish"});
}

TEST_CASE("of two sources with equal arrivals the older stamp comes first, whatever the file order", "[runtime]") {
    Graph graph;
    auto sink = std::make_shared<Recorder>("sink");
    graph.add("prompt", "source", std::make_shared<Ticker>(second, 1, 5 * second), {}, {scans});
    graph.add("late", "source", std::make_shared<Ticker>(second, 1, 5 * second, 3 * second), {}, {scans});
    graph.add("sink", "sink", sink, {scans, more});
    graph.connect("prompt.scans", "sink.scans");
    graph.connect("late.scans", "sink.more");
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(sink->lines == Lines{"sink 1 2 5 0", "sink 0 5 5 0", "sink finish"});
}

TEST_CASE("a message reaches its receivers in file order, and what they publish comes after it", "[runtime]") {
    Graph graph;
    Lines log;
    graph.add("world", "source", std::make_shared<Ticker>(second, 2), {}, {scans});
    graph.add("first", "tracker", std::make_shared<Recorder>("first", &log, forward_scan()), {scans}, {scans});
    graph.add("second", "analyzer", std::make_shared<Recorder>("second", &log), {scans, more});
    graph.connect("world.scans", "second.scans");
    graph.connect("first.scans", "second.more");
    graph.connect("world.scans", "first.scans");
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"first 0 0 0 0", "second 0 0 0 0", "second 1 0 0 0", "first 0 1 1 1", "second 0 1 1 1",
                       "second 1 1 1 1", "first finish", "second finish"});
}

TEST_CASE("at one arrival an older stamp overtakes: a smoothed scan comes before the next source's", "[runtime]") {
    Graph graph;
    Lines log;
    graph.add("a", "source", std::make_shared<Ticker>(second, 1), {}, {scans});
    graph.add("b", "source", std::make_shared<Ticker>(second, 1), {}, {scans});
    graph.add("smoother", "tracker", std::make_shared<Recorder>("smoother", &log, forward_scan(-second)), {scans},
              {scans});
    graph.add("sink", "sink", std::make_shared<Recorder>("sink", &log), {scans, more});
    graph.connect("a.scans", "smoother.scans");
    graph.connect("b.scans", "sink.scans");
    graph.connect("smoother.scans", "sink.more");
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"smoother 0 0 0 0", "sink 1 -1 0 0", "sink 0 0 0 0", "smoother finish", "sink finish"});
}

namespace {

/// Publishes three scans in one emission, with arrivals in the future and out of order.
class Burst : public Stage {
public:
    plr_status next(const plr_call&, plr_next& out) override {
        out.what = done_ ? PLR_NEXT_END : PLR_NEXT_DATA;
        out.arrival = out.time = second;
        return PLR_OK;
    }
    plr_status emit(const plr_call& call) override {
        done_ = true;
        for (const int arrival : {3, 1, 2}) {
            const Scan scan({static_cast<double>(arrival)});
            if (publish(call, 0, scan.message(0, arrival * second)) != PLR_OK) return PLR_E_ARGUMENT;
        }
        return PLR_OK;
    }

private:
    bool done_ = false;
};

}  // namespace

TEST_CASE("what a source has emitted is handled before it emits again at the same time", "[runtime]") {
    Graph graph;
    Lines log;
    /// Writes down when it emits.
    class Logged : public Ticker {
    public:
        explicit Logged(Lines& log) : Ticker(0, 2), log_(log) {}
        plr_status emit(const plr_call& call) override {
            log_.push_back("emit");
            return Ticker::emit(call);
        }

    private:
        Lines& log_;
    };
    graph.add("world", "source", std::make_shared<Logged>(log), {}, {scans});
    graph.add("sink", "sink", std::make_shared<Recorder>("sink", &log), {scans});
    graph.connect("world.scans", "sink.scans");
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"emit", "sink 0 0 0 0", "emit", "sink 0 0 0 1", "sink finish"});
}

TEST_CASE("a source may publish ahead of time: messages wait for their arrival", "[runtime]") {
    Graph graph;
    Lines log;
    graph.add("burst", "source", std::make_shared<Burst>(), {}, {scans});
    graph.add("ticks", "source", std::make_shared<Ticker>(second, 3, 1500'000'000), {}, {scans});
    graph.add("sink", "sink", std::make_shared<Recorder>("sink", &log), {scans, more});
    graph.connect("burst.scans", "sink.scans");
    graph.connect("ticks.scans", "sink.more");
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"sink 0 0 1 1", "sink 1 1.5 1.5 0", "sink 0 0 2 2", "sink 1 2.5 2.5 1", "sink 0 0 3 3",
                       "sink 1 3.5 3.5 2", "sink finish"});
}

TEST_CASE("what a stage publishes while it finishes reaches those behind it before they finish", "[runtime]") {
    Graph graph;
    Lines log;
    auto tracker = std::make_shared<Recorder>("tracker", &log);
    tracker->at_finish = [](Recorder& self, const plr_call& call) {
        const Scan scan({42});
        return self.publish(call, 0, scan.message(call.time));
    };
    graph.add("world", "source", std::make_shared<Ticker>(second, 2), {}, {scans});
    graph.add("tracker", "tracker", tracker, {scans}, {scans});
    graph.add("sink", "sink", std::make_shared<Recorder>("sink", &log), {scans});
    graph.connect("world.scans", "tracker.scans");
    graph.connect("tracker.scans", "sink.scans");
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"tracker 0 0 0 0", "tracker 0 1 1 1", "tracker finish", "sink 0 1 1 42", "sink finish"});
}

TEST_CASE("times of nodes and progress are told", "[runtime]") {
    Graph graph;
    graph.add("world", "source", std::make_shared<Ticker>(second, 3), {}, {scans});
    graph.add("sink", "sink", std::make_shared<Recorder>("sink"), {scans});
    graph.connect("world.scans", "sink.scans");
    Runtime runtime(graph.wiring());
    std::vector<std::int64_t> progress;
    pelorus::runtime::RunOptions options;
    options.on_progress = [&](std::int64_t arrival) { progress.push_back(arrival); };
    runtime.run(options);
    CHECK(progress == std::vector<std::int64_t>{0, 0, second, second, 2 * second, 2 * second});
    const auto timing = runtime.timing();
    REQUIRE(timing.size() == 2);
    CHECK(timing[1].node == "sink");
    CHECK(timing[1].calls == 4);  // three scans and finish
    CHECK(timing[1].seconds >= 0);
}
