#include <catch2/catch.hpp>

#include "runtime_fakes.hpp"

using namespace fakes;
using pelorus::runtime::Runtime;

namespace {

constexpr PortOf scans{"scans", PLR_MESSAGE_SCAN};
constexpr PortOf commands{"commands", PLR_MESSAGE_VALUES};
using Lines = std::vector<std::string>;

/// Answers every scan with `count` commands: 10 x (the scan's number + 1) + 0, 1, ...
Recorder::Reaction command_back(int count = 1) {
    return [=](Recorder& self, const plr_call& call, std::uint32_t, const plr_message& message) {
        for (int i = 0; i < count; ++i) {
            const Command command(10 * (first_number(message) + 1) + i);
            if (self.publish(call, 0, command.message(message.time)) != PLR_OK)
                return static_cast<plr_status>(PLR_E_ARGUMENT);
        }
        return static_cast<plr_status>(PLR_OK);
    };
}

}  // namespace

TEST_CASE("a loop source -> tracker -> scheduler -> source closes with the delay of one step", "[runtime]") {
    Graph graph;
    Lines log;
    auto world = std::make_shared<Ticker>(second, 4);
    graph.add("world", "source", world, {commands}, {scans});
    graph.add("scheduler", "scheduler", std::make_shared<Recorder>("scheduler", &log, command_back()), {scans},
              {commands});
    graph.connect("world.scans", "scheduler.scans");
    graph.connect("scheduler.commands", "world.commands", true);
    Runtime runtime(graph.wiring());
    runtime.run({});
    // The scan at k is made with the command that answered the scan at k - 1: 0, then 10 (0 + 1), 10 (10 + 1), ...
    CHECK(log == Lines{"scheduler 0 0 0 0", "scheduler 0 1 1 10", "scheduler 0 2 2 110", "scheduler 0 3 3 1110",
                       "scheduler finish"});
    CHECK(world->commands == Lines{"10 of 0 at 1", "110 of 1 at 2", "1110 of 2 at 3"});
}

TEST_CASE("feedback that a node had no event for is delivered with its next one, oldest first, once", "[runtime]") {
    Graph graph;
    auto slow = std::make_shared<Ticker>(3 * second, 3, second);
    graph.add("fast", "source", std::make_shared<Ticker>(second, 4), {}, {scans});
    graph.add("slow", "source", slow, {commands}, {scans});
    graph.add("scheduler", "scheduler", std::make_shared<Recorder>("scheduler", nullptr, command_back(2)), {scans},
              {commands});
    graph.connect("fast.scans", "scheduler.scans");
    graph.connect("scheduler.commands", "slow.commands", true);
    Runtime runtime(graph.wiring());
    runtime.run({});
    // Commands at 0, 1, 2, 3 s, two each. The slow source acts at 1, 4 and 7 s; at 7 s there is nothing new.
    CHECK(slow->commands == Lines{"10 of 0 at 1", "11 of 0 at 1", "20 of 1 at 4", "21 of 1 at 4", "30 of 2 at 4",
                                  "31 of 2 at 4", "40 of 3 at 4", "41 of 3 at 4"});
}

TEST_CASE("several feedback edges of a node are merged in the order of events", "[runtime]") {
    Graph graph;
    Lines log;
    constexpr PortOf both{"both", PLR_MESSAGE_VALUES};
    std::vector<std::pair<std::string, unsigned>> origins;
    const auto note = [&](Recorder&, const plr_call&, std::uint32_t port, const plr_message& message) {
        if (port == 1) origins.emplace_back(message.origin, message.edge);
        return static_cast<plr_status>(PLR_OK);
    };
    graph.add("world", "source", std::make_shared<Ticker>(second, 2), {}, {scans});
    graph.add("late", "source", std::make_shared<Ticker>(second, 1, 5 * second), {}, {scans});
    graph.add("receiver", "tracker", std::make_shared<Recorder>("receiver", &log, note), {scans, both});
    graph.add("b", "scheduler", std::make_shared<Recorder>("b", nullptr, command_back()), {scans}, {commands});
    graph.add("a", "scheduler", std::make_shared<Recorder>("a", nullptr, command_back()), {scans}, {commands});
    graph.connect("late.scans", "receiver.scans");
    graph.connect("a.commands", "receiver.both", true);
    graph.connect("b.commands", "receiver.both", true);
    graph.connect("world.scans", "a.scans");
    graph.connect("world.scans", "b.scans");
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"receiver 1 0 0 10", "receiver 1 0 0 10", "receiver 1 1 1 20", "receiver 1 1 1 20",
                       "receiver 0 5 5 0", "receiver finish"});
    // b stands first in the file; the edge from a is the first that ends at the port.
    CHECK(origins == std::vector<std::pair<std::string, unsigned>>{{"b", 1}, {"a", 0}, {"b", 1}, {"a", 0}});
}

TEST_CASE("a receiver gets the feedback of earlier arrivals before the message, never that of the same arrival",
          "[runtime]") {
    Graph graph;
    Lines log;
    const auto calibrate = [](Recorder& self, const plr_call& call, std::uint32_t port, const plr_message& message) {
        if (port != 0) return static_cast<plr_status>(PLR_OK);
        const Scan scan({first_number(message)});
        return self.publish(call, 0, scan.message(message.time));
    };
    graph.add("world", "source", std::make_shared<Ticker>(second, 3), {}, {scans});
    graph.add("registration", "registration", std::make_shared<Recorder>("registration", &log, calibrate),
              {scans, commands}, {scans});
    graph.add("estimator", "analyzer", std::make_shared<Recorder>("estimator", &log, command_back()), {scans},
              {commands});
    graph.connect("world.scans", "registration.scans");
    graph.connect("registration.scans", "estimator.scans");
    graph.connect("estimator.commands", "registration.commands", true);
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"registration 0 0 0 0", "estimator 0 0 0 0",                           //
                       "registration 1 0 0 10", "registration 0 1 1 1", "estimator 0 1 1 1",  //
                       "registration 1 1 1 20", "registration 0 2 2 2", "estimator 0 2 2 2",  //
                       "registration finish", "estimator finish"});
}

TEST_CASE("a source that changes its plans upon a feedback message is asked anew", "[runtime]") {
    /// Puts its second scan off by what is commanded.
    class Postponed : public Ticker {
    public:
        Postponed() : Ticker(second, 2) {}
        plr_status next(const plr_call& call, plr_next& out) override {
            const plr_status status = Ticker::next(call, out);
            if (!commands.empty()) out.arrival += 5 * second;
            return status;
        }
    };
    Graph graph;
    Lines log;
    graph.add("world", "source", std::make_shared<Postponed>(), {commands}, {scans});
    graph.add("scheduler", "scheduler", std::make_shared<Recorder>("scheduler", &log, command_back()), {scans},
              {commands});
    graph.connect("world.scans", "scheduler.scans");
    graph.connect("scheduler.commands", "world.commands", true);
    Runtime runtime(graph.wiring());
    runtime.run({});
    CHECK(log == Lines{"scheduler 0 0 0 0", "scheduler 0 6 6 10", "scheduler finish"});
}
