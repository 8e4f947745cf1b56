// Runs of a stage: again, on more threads, in disorder, to the end and too short.
#include <cstring>
#include <optional>
#include <set>

#include "machine/message_fields.hpp"
#include "machine/message_words.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

constexpr unsigned bit(watch::Concern concern) noexcept { return static_cast<unsigned>(concern); }

/// An old message that comes in now.
plr_message arriving(const plr_message& message, std::int64_t arrival) {
    plr_message late = message;
    late.arrival = arrival;
    return late;
}

struct Oddity {
    const char* what;
    FeedOptions options;
};

/// Messages that the host lets pass and that are not what one thinks of first.
std::vector<Oddity> oddities(std::int64_t tick) {
    FeedOptions plain;
    plain.first_tick = tick;
    plain.ticks = 1;
    plain.first_id = 1'000'000;
    std::vector<Oddity> all(7, {"", plain});
    all[0].what = "no entries";
    all[0].options.targets = 0;
    all[1].what = "no covariances";
    all[1].options.has_covariances = false;
    all[2].what = "one covariance for all entries";
    all[2].options.is_covariance_common = true;
    all[3].what = "a time for each measurement";
    all[3].options.is_scan_timed = true;
    all[4].what = "no extents";
    all[4].options.has_extents = false;
    all[5].what = "no lists of measurements";
    all[5].options.has_lists = false;
    all[6].what = "several times in one message";
    all[6].options.ticks = 3;
    all[6].options.ticks_a_message = 3;
    return all;
}

void must_have_in_ports(const Bench& bench) {
    if (bench.description().in_port_count == 0) skip("nothing comes in");
}

/// Blocks in use after each half of a long run, by steps.
std::int64_t growth(StagePlayer& player, const Script& script, std::size_t& steps) {
    play(player, script, 0, script.steps() / 2);
    const std::int64_t before = watch::blocks_in_use();
    play(player, script, script.steps() / 2, script.steps());
    steps = script.steps() - script.steps() / 2;
    return watch::blocks_in_use() - before;
}

}  // namespace

PELORUS_CHECK(stage, "stage-same-bytes-again", 2,
              "Two instances that are given the same in turns publish and write the same, bit for bit: nothing is kept "
              "in static memory, nothing depends on addresses.",
              {"stage-takes-what-it-asks-for"}) {
    const Script script = plain_script(bench);
    StagePlayer one(bench), other(bench);
    for (std::size_t i = 0; i < script.steps(); ++i) {
        play(one, script, i, i + 1);
        play(other, script, i, i + 1);
    }
    one.finish_well();
    other.finish_well();
    const std::string difference = difference_of(trace_of(one), trace_of(other));
    if (!difference.empty()) FAIL("two instances side by side differ: " << difference);
}

PELORUS_CHECK(
    stage, "stage-threads-do-not-matter", 3,
    "Whatever the number of threads that the host has, a stage publishes the same bits; a result that depends "
    "on the machine cannot be repeated.",
    {"stage-same-bytes-again"}) {
    const Script script = plain_script(bench);
    std::optional<Trace> first;
    for (const unsigned threads : {1u, 2u, 4u}) {
        PlayOptions options;
        options.threads = threads;
        StagePlayer player(bench, options);
        if (player.services().asked_for.count(PLR_SERVICE_PARALLEL) == 0 && !first)
            note("the stage does not ask for threads");
        play(player, script);
        player.finish_well();
        const Trace trace = trace_of(player);
        if (!first) {
            first = trace;
            continue;
        }
        const std::string difference = difference_of(*first, trace);
        if (!difference.empty()) FAIL("on 1 and on " << threads << " threads, runs differ: " << difference);
    }
}

PELORUS_CHECK(stage, "stage-reads-no-clock", 3,
              "receive, emit and finish read no clock and no random numbers but the host's (a sink may look at the "
              "clock, a source in next): a recording played back tomorrow gives the same result.",
              {"stage-takes-what-it-asks-for"}) {
    if (!watch::is_available()) skip("this build does not watch the C library");
    const bool is_sink = bench.task().kind == "sink";
    PlayOptions options;
    options.watch = bit(watch::Concern::chance) | (is_sink ? 0 : bit(watch::Concern::clocks));
    const Script script = plain_script(bench);
    StagePlayer player(bench, options);
    play(player, script);
    player.finish_well();
    if (player.offence.function != nullptr)
        FAIL(player.offence_in << " called " << player.offence.function << " (" << player.offence.count
                               << " times in that call) " << player.offence.place);
}

PELORUS_CHECK(stage, "stage-survives-disorder", 3,
              "A message that comes twice, too late or out of turn is taken or refused by PLR_E_DATA, and the run goes "
              "on: networks do that.",
              {"stage-takes-what-it-asks-for"}) {
    must_have_in_ports(bench);
    const Script script = plain_script(bench);
    const std::size_t half = script.deliveries.size() / 2;
    if (half < 2) skip("too few messages");
    StagePlayer player(bench);
    play(player, script, 0, half);
    const std::int64_t now = script.deliveries[half - 1].message->arrival;
    Sample sample = bench.sample(4);
    std::vector<std::size_t> again{half - 1, half - 1, 0};
    for (int k = 0; k < 12; ++k) again.push_back(sample.below(half));
    for (const std::size_t i : again) {
        const plr_message late = arriving(*script.deliveries[i].message, now);
        const Answer answer = player.receive(script.deliveries[i].port, late);
        if (!answer.is_ok() && !answer.is_refusal())
            FAIL("receive answered " << answer.told << " to a " << brief(late) << " that came "
                                     << (i == half - 1 ? "twice" : "late")
                                     << "; expected PLR_OK or PLR_E_DATA, any other answer ends the run");
    }
    play(player, script, half, script.steps());
    player.finish_well();
}

PELORUS_CHECK(stage, "stage-survives-odd-messages", 3,
              "Messages that the host lets pass are taken or refused by PLR_E_DATA: empty ones, without covariances, "
              "extents or lists, with times of their own; and the run goes on.",
              {"stage-takes-what-it-asks-for"}) {
    must_have_in_ports(bench);
    const Script script = plain_script(bench);
    const std::int64_t tick = script.deliveries.empty() ? 0 : script.deliveries[script.deliveries.size() / 2].tick;
    for (const Oddity& oddity : oddities(tick)) {
        StagePlayer player(bench);
        INFO("messages with " << oddity.what);
        std::set<std::uint32_t> ports;
        for (const Delivery& delivery : script.deliveries) {
            ports.insert(delivery.port);
            if (delivery.tick < tick) player.deliver(delivery);
        }
        const Feed odd(bench, player.instance(), bench.sample(5), oddity.options);
        for (const Delivery& delivery : odd.deliveries())
            if (ports.count(delivery.port) != 0) player.deliver(delivery);
        for (const Delivery& delivery : script.deliveries)
            if (delivery.tick >= tick + oddity.options.ticks) player.deliver(delivery);
        player.finish_well();
    }
}

PELORUS_CHECK(
    stage, "stage-refusal-changes-nothing", 3,
    "A message that is refused by PLR_E_DATA leaves the state as it was; the host counts it and goes on as if "
    "it had not come.",
    {"stage-state-resaves", "stage-survives-disorder", "stage-survives-odd-messages"}) {
    must_have_in_ports(bench);
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    if (!player.saves()) skip("the stage keeps no state (save is NULL)");
    std::vector<Delivery> doubtful = script.deliveries;  // late ones
    for (const Oddity& oddity : oddities(30)) {
        const Feed odd(bench, player.instance(), bench.sample(5), oddity.options);
        doubtful.insert(doubtful.end(), odd.deliveries().begin(), odd.deliveries().end());
    }
    play(player, script);
    int refused = 0;
    for (const Delivery& delivery : doubtful) {
        const Bytes before = player.save();
        const plr_message late = arriving(*delivery.message, 40 * feed_period);
        if (!player.receive(delivery.port, late).is_refusal()) continue;
        ++refused;
        const std::string difference = difference_of(before, player.save());
        if (!difference.empty())
            FAIL("a " << brief(late) << " was refused by PLR_E_DATA, but the state has changed: " << difference);
    }
    if (refused == 0) skip("no message was refused");
    note(std::to_string(refused) + " messages were refused");
}

PELORUS_CHECK(
    stage, "stage-ends-at-any-time", 2,
    "A stage can be finished before anything came in, and destroyed without being finished: runs are stopped, "
    "and some are empty.",
    {"stage-takes-what-it-asks-for"}) {
    StagePlayer empty(bench);
    empty.finish_well();
    const Script script = plain_script(bench);
    for (const std::size_t steps : {std::size_t{0}, script.steps() / 2}) {
        StagePlayer player(bench);
        play(player, script, 0, steps);
        player.destroy();
    }
}

PELORUS_CHECK(stage, "stage-finish-repeats-nothing", 3,
              "finish publishes what is left and nothing a second time; whoever counts messages would count it twice.",
              {"stage-publishes-what-it-declares"}) {
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    play(player, script);
    const std::size_t before = player.published().size();
    player.finish_well();
    for (std::size_t i = before; i < player.published().size(); ++i) {
        const PublishedMessage& late = player.published()[i];
        if (late.message->kind == PLR_MESSAGE_TABLE) continue;  // the same name again replaces
        for (std::size_t k = 0; k < i; ++k)
            if (player.published()[k].port == late.port &&
                difference_of(*player.published()[k].message, *late.message).empty())
                FAIL("finish published a " << brief(*late.message) << " that had been published before");
    }
}

PELORUS_CHECK(
    stage, "stage-survives-lack-of-memory", 4,
    "Where an allocation fails, the call answers PLR_E_MEMORY (a sink: or PLR_E_IO), or what it answers with enough "
    "memory; and finish then answers as it would have, or the like. What other nodes have written is not lost with it.",
    {"stage-ends-at-any-time"}) {
    if (!watch::is_available()) skip("this build does not watch the C library");
    const Script script = plain_script(bench);
    const std::size_t at = script.steps() / 3;
    const bool is_sink = bench.task().kind == "sink";
    /// What the step at hand and then finish answer; nullopt: there is no such step.
    const auto answers = [&](std::int64_t failing) -> std::optional<std::pair<Answer, Answer>> {
        StagePlayer player(bench);
        play(player, script, 0, at);
        Answer answer;
        if (player.is_source()) {
            const plr_next coming = player.next();
            if (coming.what != PLR_NEXT_DATA) return std::nullopt;
            player.failing_allocation = failing;
            answer = player.emit(coming.arrival);
        } else {
            if (at >= script.deliveries.size()) return std::nullopt;
            player.failing_allocation = failing;
            answer = player.receive(script.deliveries[at].port, *script.deliveries[at].message);
        }
        return std::pair(answer, player.finish());
    };
    const auto enough = answers(-1);
    if (!enough) skip("too few messages or events");
    int failed = 0;
    for (std::int64_t n = 0; n < 40; ++n) {
        const auto short_of = answers(n);
        if (!short_of) continue;
        const auto& [answer, finished] = *short_of;
        const auto is_lawful = [&](const Answer& told, const Answer& usual) {
            return told.is_ok() || told.status == usual.status || told.status == PLR_E_MEMORY ||
                   (told.status == PLR_E_IO && is_sink);
        };
        failed += answer.status == PLR_E_MEMORY ? 1 : 0;
        if (!is_lawful(answer, enough->first))
            FAIL("allocation " << n << " failed, and the call answered " << answer.told
                               << "; expected PLR_E_MEMORY, or PLR_OK where it can do without");
        if (!is_lawful(finished, enough->second))
            FAIL("allocation " << n << " failed in a call, and finish answered " << finished.told << " after it");
    }
    note(std::to_string(failed) + " of 40 calls answered PLR_E_MEMORY");
}

PELORUS_CHECK(
    stage, "stage-memory-is-bounded", 5,
    "A stage that runs for months holds no more memory than one that runs for an hour (analyzers and sinks may "
    "keep what their result needs).",
    {"stage-takes-what-it-asks-for"}) {
    bench.once_a_plugin();
    if (!watch::is_available()) skip("this build does not watch the C library");
    FeedOptions long_run;
    long_run.ticks = 1000;
    PlayOptions options;
    options.keeps_published = false;
    Script script = plain_script(bench, long_run);
    StagePlayer player(bench, options);
    if (player.is_source()) script.events = 1000;
    std::size_t steps = 0;
    const std::int64_t grown = growth(player, script, steps);
    if (steps < 100) skip("too few messages");
    note("holds " + std::to_string(grown) + " blocks more after another " + std::to_string(steps) + " steps");
    const bool may_keep = bench.task().kind == "analyzer" || bench.task().kind == "sink";
    // A leak of one block in ten steps; vectors that double, and tracks that come and go, stay far below.
    if (!may_keep && grown > static_cast<std::int64_t>(steps / 10))
        FAIL("after " << steps << " steps more, the stage holds " << grown << " more blocks of memory");
}

}  // namespace pelorus::conformance
