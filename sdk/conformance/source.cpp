// What sources promise: what comes next, when, and in which order.
#include <algorithm>
#include <map>
#include <set>

#include "machine/message_fields.hpp"
#include "machine/message_words.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

constexpr std::size_t most_events = 60;

/// An event of a source: as announced, and what was published.
struct SourceEvent {
    plr_next next;
    std::vector<PublishedMessage> published;
};

/// The events of the source, those that come without waiting.
std::vector<SourceEvent> events_of(StagePlayer& player, std::size_t most = most_events) {
    std::vector<SourceEvent> events;
    while (events.size() < most) {
        const plr_next next = player.next();
        if (next.what != PLR_NEXT_DATA) break;
        const std::size_t before = player.published().size();
        const Answer answer = player.emit(next.arrival);
        if (!answer.is_ok()) FAIL("emit answered " << answer.told);
        events.push_back(
            {next, {player.published().begin() + static_cast<std::ptrdiff_t>(before), player.published().end()}});
    }
    if (events.empty()) skip("the source has nothing to tell without waiting");
    return events;
}

std::vector<SourceEvent> events_of(const Bench& bench) {
    StagePlayer player(bench);
    return events_of(player);
}

std::string seconds(std::int64_t time) { return std::to_string(static_cast<double>(time) * 1e-9) + " s"; }

}  // namespace

PELORUS_CHECK(source, "source-announces-what-it-emits", 3,
              "emit publishes the event that next announced: something of its time, and nothing that arrives before "
              "it; events of several sources are put in order by it.",
              {"stage-takes-what-it-asks-for"}) {
    for (const SourceEvent& event : events_of(bench)) {
        bool has_time = event.published.empty();
        for (const PublishedMessage& published : event.published) {
            const plr_message& message = *published.message;
            has_time = has_time || message.time == event.next.time;
            if (message.arrival != INT64_MIN && message.arrival < event.next.arrival)
                FAIL("a " << brief(message) << " arrives at " << seconds(message.arrival) << ", before the event at "
                          << seconds(event.next.arrival) << " in which it was published");
        }
        if (!has_time)
            FAIL("next announced an event of time " << seconds(event.next.time)
                                                    << ", but what was published first is a "
                                                    << brief(*event.published.front().message));
    }
}

PELORUS_CHECK(source, "source-arrivals-ascend", 3,
              "Events of a source do not arrive before one that it has told already; the clock of a run does not go "
              "back.",
              {"stage-takes-what-it-asks-for"}) {
    const std::vector<SourceEvent> events = events_of(bench);
    for (std::size_t i = 1; i < events.size(); ++i)
        if (events[i].next.arrival < events[i - 1].next.arrival)
            FAIL("event " << i << " arrives at " << seconds(events[i].next.arrival) << ", event " << i - 1 << " at "
                          << seconds(events[i - 1].next.arrival));
}

PELORUS_CHECK(source, "source-next-changes-nothing", 3,
              "next only tells: asked again it answers the same, and asked more often it leads to the same events; the "
              "host asks before each event, and again after it has waited.",
              {"stage-same-bytes-again"}) {
    StagePlayer asked_once(bench), asked_often(bench);
    const std::vector<SourceEvent> expected = events_of(asked_once);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        for (int again = 0; again < 3; ++again) {
            const plr_next next = asked_often.next();
            const plr_next& first = expected[i].next;
            if (next.what != first.what || next.arrival != first.arrival || next.time != first.time)
                FAIL("asked " << again + 1 << " times before event " << i << ", next answered what " << next.what
                              << ", arrival " << seconds(next.arrival) << ", time " << seconds(next.time)
                              << "; asked once: " << first.what << ", " << seconds(first.arrival) << ", "
                              << seconds(first.time));
        }
        asked_often.emit(expected[i].next.arrival);
    }
    const std::string difference = difference_of(trace_of(asked_once), trace_of(asked_often));
    if (!difference.empty()) FAIL("asked once and asked often, events differ: " << difference);
}

PELORUS_CHECK(source, "source-end-is-final", 3,
              "A source that has said PLR_NEXT_END says it again whenever it is asked; the host may ask again.",
              {"stage-takes-what-it-asks-for"}) {
    constexpr std::size_t most = 1000;
    PlayOptions options;
    options.keeps_published = false;
    StagePlayer player(bench, options);
    plr_next last = player.next();
    for (std::size_t event = 0; event < most && last.what == PLR_NEXT_DATA; ++event) {
        player.emit(last.arrival);
        last = player.next();
    }
    if (last.what != PLR_NEXT_END) skip("there is no end within 1000 events, or the source waits for more");
    for (int again = 0; again < 3; ++again) {
        const plr_next next = player.next();
        if (next.what != PLR_NEXT_END)
            FAIL("next answered PLR_NEXT_END and, asked again, " << next.what << " at " << seconds(next.arrival));
    }
    player.finish_well();
}

PELORUS_CHECK(source, "source-measurement-ids-unique", 3,
              "No two measurements of a source have the same id, over all sensors and scans: truth and tracks name "
              "measurements by it.",
              {"stage-takes-what-it-asks-for"}) {
    std::map<std::uint64_t, std::string> seen;
    for (const SourceEvent& event : events_of(bench))
        for (const PublishedMessage& published : event.published) {
            if (published.message->kind != PLR_MESSAGE_SCAN) continue;
            const plr_scan& scan = *published.message->body.scan;
            for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
                const auto [at, is_new] = seen.emplace(scan.ids[i], brief(*published.message));
                if (!is_new)
                    FAIL("measurement " << scan.ids[i] << " of a " << brief(*published.message)
                                        << " has the id of one of a " << at->second);
            }
        }
}

PELORUS_CHECK(source, "source-truth-before-scans", 3,
              "The truth of a time is published before the scans of that time; analyzers pair them as they come.",
              {"stage-takes-what-it-asks-for"}) {
    std::map<std::int64_t, std::string> scans;
    bool has_truth = false;
    for (const SourceEvent& event : events_of(bench))
        for (const PublishedMessage& published : event.published) {
            const plr_message& message = *published.message;
            if (message.kind == PLR_MESSAGE_SCAN) scans.emplace(message.time, brief(message));
            if (message.kind != PLR_MESSAGE_TRUTH) continue;
            has_truth = true;
            const auto earlier = scans.find(message.time);
            if (earlier != scans.end()) FAIL("a " << brief(message) << " was published after a " << earlier->second);
        }
    if (!has_truth) skip("the source tells no truth");
}

PELORUS_CHECK(source, "source-truth-names-real-measurements", 3,
              "Each measurement that the truth claims for an object is in a scan, at once or later, and belongs to one "
              "object; scores of association rest on it.",
              {"source-measurement-ids-unique"}) {
    std::set<std::uint64_t> measured;
    std::map<std::uint64_t, std::string> claimed;
    const auto add_measured = [&](const PublishedMessage& published) {
        if (published.message->kind != PLR_MESSAGE_SCAN) return;
        const plr_scan& scan = *published.message->body.scan;
        measured.insert(scan.ids, scan.ids + scan.measurements.count);
    };
    StagePlayer player(bench);
    for (const SourceEvent& event : events_of(player))
        for (const PublishedMessage& published : event.published) {
            const plr_message& message = *published.message;
            add_measured(published);
            if (message.kind != PLR_MESSAGE_TRUTH || message.body.truth->measurement_offsets == nullptr) continue;
            const plr_truth& truth = *message.body.truth;
            for (std::int64_t i = 0; i < truth.count; ++i)
                for (std::int64_t k = truth.measurement_offsets[i]; k < truth.measurement_offsets[i + 1]; ++k)
                    if (!claimed.emplace(truth.measurements[k], brief(message)).second)
                        FAIL("measurement " << truth.measurements[k] << " is claimed twice, the second time by object "
                                            << truth.ids[i] << " in a " << brief(message));
        }
    if (claimed.empty()) skip("the truth claims no measurements");
    // Scans may arrive later than the truth of their time (on their way through a network): read on for them.
    constexpr std::size_t most_later = 1000;
    const auto missing = [&] {
        return std::find_if(claimed.begin(), claimed.end(),
                            [&](const auto& claim) { return measured.count(claim.first) == 0; });
    };
    for (std::size_t event = 0; event < most_later && missing() != claimed.end(); ++event) {
        const std::size_t before = player.published().size();
        const plr_next next = player.next();
        if (next.what != PLR_NEXT_DATA || !player.emit(next.arrival).is_ok()) break;
        std::for_each(player.published().begin() + static_cast<std::ptrdiff_t>(before), player.published().end(),
                      add_measured);
    }
    if (const auto claim = missing(); claim != claimed.end())
        FAIL("measurement " << claim->first << ", claimed in a " << claim->second << ", is in no scan");
}

PELORUS_CHECK(source, "source-key-decides-the-noise", 3,
              "A source that draws random numbers draws others for another key: the runs of a campaign are different "
              "runs.",
              {"stage-same-bytes-again"}) {
    StagePlayer one(bench);
    if (one.services().asked_for.count(PLR_SERVICE_RANDOM) == 0) skip("the source draws no random numbers");
    PlayOptions options;
    options.key = plr_key{{77, 88}};
    StagePlayer other(bench, options);
    events_of(one);
    events_of(other);
    if (difference_of(trace_of(one), trace_of(other)).empty())
        FAIL("with two different keys (plr_config.key) the source publishes the very same messages");
}

}  // namespace pelorus::conformance
