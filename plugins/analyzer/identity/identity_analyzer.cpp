#include "identity_analyzer.hpp"

#include <cmath>
#include <limits>

namespace analyzer_identity {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

double share(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? nothing : static_cast<double>(part) / static_cast<double>(whole);
}
double real(std::uint64_t count) { return static_cast<double>(count); }
double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

}  // namespace

void IdentityAnalyzer::describe(pelorus::Describe<IdentityAnalyzer>& plugin) {
    plugin.title("Identities")
        .purpose(
            "Holds tracks against known identities: which track used whose reports. Tells for each identity how much "
            "of it "
            "was tracked, by how many tracks, how often the track changed and how often tracking broke off; and for "
            "each "
            "track how pure it is. Needs nothing but the ids of measurements in tracks and truth, no distances.")
        .equation(
            "purity = measurements of the main identity / all measurements of the track; switches = tracked reports "
            "whose "
            "track is another than that of the tracked report before; fragments = tracked reports right after "
            "untracked "
            "ones, the first excepted; latency = first tracked report - first report")
        .source(
            "K. Bernardin, R. Stiefelhagen, Evaluating Multiple Object Tracking Performance: The CLEAR MOT Metrics, "
            "EURASIP "
            "J. Image and Video Processing, 2008 (mismatches); Y. Li, C. Huang, R. Nevatia, Learning to Associate: "
            "HybridBoosted Multi-Target Tracker for Crowded Scene, CVPR 2009 (fragments, switches)");
    plugin.parameter("patience", &IdentityAnalyzer::patience_)
        .unit("s")
        .initially("600 s")
        .above(0.0)
        .doc("how long a report waits for a track to take it; longer than any delay of the tracker");
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates that tell which measurements they used");
    plugin.in_port("truth", PLR_MESSAGE_TRUTH, "identities that tell which measurements came from them");
    plugin.out_port("results", PLR_MESSAGE_TABLE, "tables by_identity and by_track and their scalars, at the end");
}

void IdentityAnalyzer::on_truth(const pelorus::Event& event, const plr_truth& message) {
    tally_.judge(event.arrival - std::llround(patience_ * 1e9));
    if (message.measurement_offsets == nullptr) return;
    for (std::int64_t i = 0; i < message.count; ++i)
        for (std::int64_t k = message.measurement_offsets[i]; k < message.measurement_offsets[i + 1]; ++k)
            tally_.report(message.ids[i], message.measurements[k], event.arrival);
}

void IdentityAnalyzer::on_tracks(const pelorus::Event&, const plr_tracks& message) {
    for (std::int64_t i = 0; i < message.count; ++i) {
        if (message.status[i] != PLR_TRACK_CONFIRMED && message.status[i] != PLR_TRACK_COASTING) continue;
        tally_.entry(message.ids[i], message.times[i]);
        if (message.measurement_offsets == nullptr) continue;
        for (std::int64_t k = message.measurement_offsets[i]; k < message.measurement_offsets[i + 1]; ++k)
            if (message.measurement_weights == nullptr || message.measurement_weights[k] > 0.5)
                tally_.use(message.ids[i], message.measurements[k]);
    }
}

void IdentityAnalyzer::finish(const pelorus::Event& event) {
    tally_.judge_all();
    publish_identities(event.time);
    publish_tracks(event.time);
}

void IdentityAnalyzer::publish_identities(std::int64_t time) {
    pelorus::ResultBuilder table("by_identity");
    table.column("identity", "", PLR_REDUCE_KEY);
    for (const char* name : {"reports", "tracked_share", "tracks", "switches", "fragments"})
        table.column(name, "", PLR_REDUCE_MEAN);
    table.column("main_track", "", PLR_REDUCE_FIRST_RUN);
    table.column("main_share", "", PLR_REDUCE_MEAN);
    table.column("main_purity", "", PLR_REDUCE_MEAN);
    table.column("latency", "s", PLR_REDUCE_MEAN);
    double latencies = 0;
    std::uint64_t reports = 0, tracked = 0, switches = 0, fragments = 0, followed = 0;
    for (const auto& [id, identity] : tally_.identities()) {
        const auto main = identity.tracks.main();
        const double latency = identity.first_tracked ? seconds(*identity.first_tracked - identity.first) : nothing;
        table.row({real(id), real(identity.reports), share(identity.tracked, identity.reports),
                   real(identity.tracks.size()), real(identity.switches), real(identity.fragments),
                   main ? real(*main) : nothing, main ? share(identity.tracks.count(*main), identity.reports) : nothing,
                   main ? purity(tally_.tracks().at(*main)) : nothing, latency});
        if (identity.first_tracked) latencies += latency;
        reports += identity.reports;
        tracked += identity.tracked;
        switches += identity.switches;
        fragments += identity.fragments;
        followed += identity.tracked > 0 ? 1 : 0;
    }
    table.scalar("identities", "", PLR_REDUCE_MEAN, real(tally_.identities().size()));
    table.scalar("identities_tracked", "", PLR_REDUCE_MEAN, real(followed));
    table.scalar("reports", "", PLR_REDUCE_MEAN, real(reports));
    table.scalar("tracked_share", "", PLR_REDUCE_MEAN, share(tracked, reports));
    table.scalar("switches", "", PLR_REDUCE_MEAN, real(switches));
    table.scalar("fragments", "", PLR_REDUCE_MEAN, real(fragments));
    table.scalar("latency", "s", PLR_REDUCE_MEAN, followed == 0 ? nothing : latencies / real(followed), 0,
                 real(followed));
    publish(0, table.message(time));
}

void IdentityAnalyzer::publish_tracks(std::int64_t time) {
    pelorus::ResultBuilder table("by_track");
    table.column("track", "", PLR_REDUCE_KEY);
    table.column("start", "s", PLR_REDUCE_FIRST_RUN);
    table.column("end", "s", PLR_REDUCE_FIRST_RUN);
    for (const char* name : {"measurements", "unknown", "identities", "main_identity", "purity"})
        table.column(name, "", PLR_REDUCE_FIRST_RUN);
    double sum = 0, false_time = 0;
    std::uint64_t used = 0, right = 0, false_ones = 0;
    for (const auto& [id, track] : tally_.tracks()) {
        const auto main = track.identities.main();
        table.row({real(id), seconds(track.start), seconds(track.end), real(track.measurements), real(track.unknown),
                   real(track.identities.size()), main ? real(*main) : nothing, purity(track)});
        sum += purity(track);
        used += track.measurements;
        right += main ? track.identities.count(*main) : 0;
        if (main) continue;
        ++false_ones;
        false_time += seconds(track.end - track.start);
    }
    const std::size_t tracks = tally_.tracks().size();
    table.scalar("tracks", "", PLR_REDUCE_MEAN, real(tracks));
    table.scalar("mean_purity", "", PLR_REDUCE_MEAN, tracks == 0 ? nothing : sum / real(tracks));
    table.scalar("purity", "", PLR_REDUCE_MEAN, share(right, used));
    table.scalar("false_tracks", "", PLR_REDUCE_MEAN, real(false_ones));
    table.scalar("false_track_time", "s", PLR_REDUCE_MEAN, false_time);
    publish(0, table.message(time));
}

}  // namespace analyzer_identity
