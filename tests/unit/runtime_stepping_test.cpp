// A run bit by bit, with messages from outside.
#include <catch2/catch.hpp>
#include <pelorus/abi/external.h>

#include "host/error.hpp"
#include "runtime_fakes.hpp"

using namespace fakes;
using namespace pelorus::runtime;
using Catch::Contains;

namespace {

constexpr PortOf scans{"scans", PLR_MESSAGE_SCAN};
constexpr PortOf more{"more", PLR_MESSAGE_SCAN};
using Lines = std::vector<std::string>;

template <std::uint32_t late> const void* external(const void*, const char* id) {
    static constexpr plr_external answer{sizeof(plr_external), late};
    return std::string(id) == PLR_EXTERNAL ? &answer : nullptr;
}

plr_status pass_on(Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
    plr_message copy = message;
    copy.arrival = INT64_MIN;
    return self.publish(call, 0, copy);
}

/// world (0, 1, 2, 3 s) -> sink.scans, radar (fed from outside) -> sink.more
struct Fed {
    Graph graph;
    plr_stage table{};
    std::shared_ptr<Recorder> sink = std::make_shared<Recorder>("sink");
    std::unique_ptr<Runtime> runtime;

    explicit Fed(std::uint32_t late = PLR_LATE_REFUSE) {
        graph.add("world", "source", std::make_shared<Ticker>(second, 4), {}, {scans});
        graph.add("radar", "source", std::make_shared<Recorder>("radar", nullptr, pass_on), {scans}, {scans});
        graph.add("sink", "sink", sink, {scans, more});
        graph.connect("world.scans", "sink.scans");
        graph.connect("radar.scans", "sink.more");
        plr_instance& radar = graph.editable().nodes[1].instance;
        table = stage_functions(radar);
        table.head.extension = late == PLR_LATE_DROP   ? external<PLR_LATE_DROP>
                               : late == PLR_LATE_KEEP ? external<PLR_LATE_KEEP>
                                                       : external<PLR_LATE_REFUSE>;
        radar.table = &table.head;
        runtime = std::make_unique<Runtime>(graph.wiring());
    }
    Delivery push(double value, std::int64_t time, std::int64_t arrival = INT64_MIN, const MayGoOn& go = nullptr) {
        const Scan scan({value});
        return runtime->deliver({1, 0}, scan.message(time, arrival), go);
    }
    std::int64_t counter(const std::string& name) {
        const auto all = graph.host("radar").counters();
        const auto found = all.find(name);
        return found == all.end() ? 0 : found->second;
    }
};

template <class Function> std::string refusal(Function function) {
    try {
        function();
    } catch (const BadMessage& problem) {
        return problem.what();
    }
    return "";
}

}  // namespace

TEST_CASE("a message from outside comes after what comes before it, and waits for the next step", "[stepping]") {
    Fed fed;
    CHECK(fed.push(70, 2 * second) == Delivery::delivered);
    CHECK(fed.sink->lines == Lines{"sink 0 0 0 0", "sink 0 1 1 1", "sink 0 2 2 2"});
    CHECK(fed.runtime->waiting() == 1);
    CHECK(fed.runtime->now() == 2 * second);
    CHECK(fed.runtime->advance(2 * second) == Step::done);
    CHECK(fed.sink->lines.back() == "sink 1 2 2 70");
    CHECK(fed.runtime->waiting() == 0);
    CHECK(fed.runtime->play() == Step::done);
    CHECK(fed.sink->lines.back() == "sink 0 3 3 3");
    fed.runtime->finish();
    CHECK(fed.sink->finished);
}

TEST_CASE("messages from outside of one arrival are ordered by their stamps against other sources", "[stepping]") {
    Fed fed;
    fed.push(70, second / 2, second);  // an older stamp: before the world's at 1 s
    CHECK(fed.sink->lines == Lines{"sink 0 0 0 0"});
    fed.push(71, second, second);
    fed.runtime->advance(second);
    CHECK(fed.sink->lines == Lines{"sink 0 0 0 0", "sink 1 0.5 1 70", "sink 0 1 1 1", "sink 1 1 1 71"});
}

TEST_CASE("steps without anything from outside are the run itself", "[stepping]") {
    Fed whole, stepped;
    whole.runtime->run({});
    for (const std::int64_t until : {std::int64_t{0}, second, second, 10 * second}) stepped.runtime->advance(until);
    stepped.runtime->finish();
    CHECK(stepped.sink->lines == whole.sink->lines);
}

TEST_CASE("a stop that is said once, while a live source is waited for, ends the step", "[stepping]") {
    struct Silent : Stage {
        plr_status next(const plr_call&, plr_next& out) override {
            out = {sizeof(plr_next), PLR_NEXT_WAIT, INT64_MAX, 0};
            return PLR_OK;
        }
    };
    Graph graph;
    graph.add("radio", "source", std::make_shared<Silent>(), {}, {scans});
    Runtime runtime(graph.wiring());
    int asked = 0;
    CHECK(runtime.play([&] { return ++asked != 2; }) == Step::halted);
    CHECK(asked == 2);
}

TEST_CASE("times that are farther away than differences of 64 bits reach are refused", "[stepping]") {
    Fed fed;
    CHECK_THAT(refusal([&] { fed.push(70, INT64_MIN); }), Contains("message.time is") && Contains("2^62"));
    CHECK_THAT(refusal([&] { fed.push(70, 0, INT64_MAX); }), Contains("message.arrival is"));
    CHECK(fed.counter("refused") == 2);
}

TEST_CASE("finish handles what still waits", "[stepping]") {
    Fed fed;
    fed.push(70, second);
    fed.runtime->finish();
    CHECK(fed.sink->lines == Lines{"sink 0 0 0 0", "sink 0 1 1 1", "sink 1 1 1 70", "sink finish"});
    CHECK_THROWS_WITH(fed.push(71, 2 * second), Contains("has already run"));
    CHECK_THROWS_WITH(fed.runtime->finish(), Contains("has already run"));
}

TEST_CASE("a late message is refused, dropped or kept, and counted", "[stepping]") {
    Fed refuse, drop(PLR_LATE_DROP), keep(PLR_LATE_KEEP);
    for (Fed* fed : {&refuse, &drop, &keep}) fed->runtime->advance(2 * second);
    CHECK_THROWS_AS(refuse.push(70, second), LateMessage);
    CHECK(refusal([&] { refuse.push(70, second); }) ==
          "radar.scans: the message arrives at 1 s, but the graph has come to 2 s");
    CHECK(refuse.counter("late_refused") == 2);
    CHECK(drop.push(70, second) == Delivery::dropped);
    CHECK(drop.counter("late_dropped") == 1);
    CHECK(keep.push(70, second) == Delivery::delivered);
    CHECK(keep.counter("late_kept") == 1);
    for (Fed* fed : {&refuse, &drop, &keep}) fed->runtime->advance(2 * second);
    CHECK(refuse.sink->lines.size() == 3);
    CHECK(drop.sink->lines.size() == 3);
    CHECK(keep.sink->lines.back() == "sink 1 1 2 70");
    CHECK(refuse.push(71, 2 * second) == Delivery::delivered);  // the same arrival is not late
}

TEST_CASE("what does not belong into a port is refused by name, and the graph goes on", "[stepping]") {
    Fed fed;
    const Scan scan({1});
    const Command command(1);
    CHECK_THAT(refusal([&] {
                   fed.runtime->deliver({2, 0}, scan.message(0));
               }),
               Contains("sink.scans: sink.fake takes nothing from outside"));
    CHECK(refusal([&] {
              fed.runtime->deliver({1, 0}, command.message(0));
          }) == "radar.scans: the port takes scan, not values");
    plr_message headless = scan.message(0);
    headless.body.scan = nullptr;
    CHECK(refusal([&] { fed.runtime->deliver({1, 0}, headless); }) == "radar.scans: scan is NULL");
    headless.struct_size = 8;
    CHECK_THAT(refusal([&] { fed.runtime->deliver({1, 0}, headless); }), Contains("message.struct_size is 8"));
    CHECK(fed.counter("refused") == 3);
    CHECK(fed.push(70, second) == Delivery::delivered);
}

TEST_CASE("a step that may not go on halts between two events and loses nothing", "[stepping]") {
    Fed fed;
    int left = 2;
    const auto twice = [&left] { return left-- > 0; };
    CHECK(fed.push(70, 2 * second, INT64_MIN, twice) == Delivery::halted);
    const std::size_t before = fed.sink->lines.size();
    CHECK(before < 3);
    CHECK(fed.push(70, 2 * second) == Delivery::delivered);
    CHECK(fed.runtime->play([] { return false; }) == Step::halted);
    CHECK(fed.runtime->play() == Step::done);
    CHECK(fed.sink->lines == Lines{"sink 0 0 0 0", "sink 0 1 1 1", "sink 0 2 2 2", "sink 1 2 2 70", "sink 0 3 3 3"});
}

TEST_CASE("an observer sees what a port publishes, in order, and changes nothing", "[stepping]") {
    Fed fed, unseen;
    std::vector<double> seen;
    fed.runtime->observe({1, 0}, [&](const MessageRef& message) { seen.push_back(first_number(*message)); });
    for (Fed* each : {&fed, &unseen}) {
        each->push(70, second);
        each->push(71, second);
        each->runtime->finish();
    }
    CHECK(seen == std::vector<double>{70, 71});
    CHECK(fed.sink->lines == unseen.sink->lines);
}

TEST_CASE("a failure in a step ends the run, sinks are finished and what was told stays", "[stepping]") {
    Graph graph;
    auto sink = std::make_shared<Recorder>("sink");
    graph.add("world", "source", std::make_shared<Ticker>(second, 4), {}, {scans});
    graph.add("tracker", "tracker",
              std::make_shared<Recorder>("tracker", nullptr,
                                         [](Recorder&, const plr_call& call, std::uint32_t, const plr_message& m) {
                                             return m.time < 2 * second ? PLR_OK : fail(call, PLR_E_NUMERIC, "no root");
                                         }),
              {scans});
    graph.add("sink", "sink", sink, {scans});
    graph.connect("world.scans", "tracker.scans");
    graph.connect("world.scans", "sink.scans");
    Runtime runtime(graph.wiring());
    CHECK(runtime.advance(second) == Step::done);
    CHECK_THROWS_WITH(runtime.advance(9 * second), Contains("node tracker") && Contains("no root"));
    CHECK(sink->finished);
    CHECK_THROWS_WITH(runtime.play(), Contains("has already run"));
}

TEST_CASE("a snapshot between steps is gone on from, messages under way included", "[stepping]") {
    Fed whole, first, second_half;
    whole.push(70, second);
    whole.push(71, second);
    first.push(70, second);
    first.push(71, second);  // both wait
    const std::vector<unsigned char> bytes = first.runtime->snapshot();
    second_half.runtime->restore(bytes);
    CHECK_THROWS_AS(second_half.push(1, second / 2), LateMessage);
    for (Fed* fed : {&whole, &second_half}) {
        fed->push(72, 2 * second);
        fed->runtime->play();
        fed->runtime->finish();
    }
    CHECK(second_half.sink->sum == whole.sink->sum);
    CHECK(second_half.sink->lines.back() == "sink finish");
}
