// What trackers promise: identities, ends, misses, and covariances that can be believed.
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "machine/message_fields.hpp"
#include "machine/message_words.hpp"
#include "tracker_bench.hpp"

namespace pelorus::conformance {

namespace {

/// What is said of scans binds those that take some. Who groups the tracks of another tracker has them from there.
void needs_scans(const Bench& bench) {
    if (sensors_of(bench) == 0) skip("it takes no scans: it tells tracks of other trackers");
}

}  // namespace

PELORUS_CHECK(tracker, "tracker-no-data-no-track", 3, "Empty scans give no tracks: a tracker tells what it has seen.",
              {"stage-takes-what-it-asks-for"}) {
    const Tracked tracked(bench, quiet(0, 15), bench.sample());
    if (!tracked.entries.empty()) FAIL("no measurement came in, and there is " << name_of(tracked.entries.front()));
}

PELORUS_CHECK(tracker, "tracker-follows-a-target", 3,
              "One target that is seen in every scan becomes one confirmed track, which stays with it.",
              {"tracker-no-data-no-track"}) {
    needs_scans(bench);
    constexpr std::int64_t ticks = 20;
    const Tracked tracked(bench, quiet(1, ticks), bench.sample());
    std::set<std::uint64_t> late;
    for (const Entry& entry : tracked.entries) {
        if (!is_told(entry) || entry.tick < ticks / 2) continue;
        late.insert(entry.id);
        double distance = 0;
        nearest_target(tracked.feed, entry, 1, distance);
        if (distance > largest_error(tracked, entry))
            FAIL(name_of(entry) << " is " << distance << " m away from the only target");
    }
    if (late.empty()) FAIL("a target that was seen " << ticks << " times has no confirmed track in the second half");
    if (late.size() > 1)
        FAIL("a single target, no clutter: " << late.size() << " confirmed tracks in the second half, expected 1");
}

PELORUS_CHECK(tracker, "tracker-never-swaps-far-targets", 3,
              "Tracks of targets that are kilometres apart never change over to one another.",
              {"tracker-follows-a-target"}) {
    const Tracked tracked(bench, quiet(3, 25), bench.sample());
    if (takes_all_for_one(tracked)) skip("all measurements of a scan are one target to this tracker");
    std::map<std::uint64_t, int> followed;
    for (const Entry& entry : tracked.entries) {
        if (!is_told(entry)) continue;
        double distance = 0;
        int target = nearest_target(tracked.feed, entry, 3, distance);
        for (const std::uint64_t id : entry.used) target = tracked.feed.target_of(id);
        const auto [at, is_new] = followed.emplace(entry.id, target);
        if (!is_new && at->second != target)
            FAIL(name_of(entry) << " follows target " << target << ", before it was target " << at->second);
    }
}

PELORUS_CHECK(tracker, "tracker-tells-the-end", 3,
              "A track that has ended is told once more, as DELETED, and never again: who keeps tracks may let go of "
              "it. How long "
              "one may go on without measurements is the tracker's own affair.",
              {"tracker-follows-a-target"}) {
    constexpr std::int64_t gone = 15;
    std::map<std::uint64_t, std::int64_t> open;  // tracks that are not told as DELETED, and when they were told last
    std::int64_t ticks = 0;
    for (const std::int64_t longer : {std::int64_t{50}, std::int64_t{1000}}) {
        ticks = longer;
        const Tracked tracked(bench, quiet(1, ticks, gone), bench.sample());
        open.clear();
        std::set<std::uint64_t> ended;
        for (const Entry& entry : tracked.entries) {
            if (ended.count(entry.id) != 0)
                FAIL(name_of(entry)
                     << " is told although it had been told as DELETED; its id may not come again, either");
            open[entry.id] = entry.tick;
            if (entry.status != PLR_TRACK_DELETED) continue;
            ended.insert(entry.id);
            open.erase(entry.id);
        }
        if (open.empty()) return;
    }
    for (const auto& [id, last] : open)
        if (last < ticks - 1)
            FAIL("track " << id << " lost its target at tick " << gone << ", was told last at tick " << last
                          << " and has not been told as DELETED by tick " << ticks);
    skip("tracks go on for " + std::to_string(ticks - gone) + " scans after their target has gone, and longer");
}

PELORUS_CHECK(tracker, "tracker-ids-are-never-reused", 3,
              "An id names one track for the whole run, also when the target has gone and another comes; identities "
              "would be mixed up in every result.",
              {"tracker-tells-the-end"}) {
    FeedOptions options = quiet(3, 80);
    options.lives = [](int target, std::int64_t tick) {
        return tick >= 30 * target && tick < 30 * target + 12;  // one after the other, with pauses
    };
    const Tracked tracked(bench, options, bench.sample());
    struct Use {
        int target;
        std::int64_t tick;
        bool has_ended;
    };
    std::map<std::uint64_t, Use> uses;  // the last of each id
    for (const Entry& entry : tracked.entries) {
        double distance = 0;
        int target = nearest_target(tracked.feed, entry, 3, distance);
        for (const std::uint64_t id : entry.used) target = tracked.feed.target_of(id);
        const auto [at, is_new] = uses.emplace(entry.id, Use{target, entry.tick, false});
        Use& before = at->second;
        if (before.has_ended) FAIL(name_of(entry) << " has the id of a track that was told as DELETED");
        // A track that is told in each scan goes on, however long it has seen nothing; one that was not told is another.
        if (!is_new && before.target != target && entry.tick > before.tick + 1)
            FAIL(name_of(entry) << " is of target " << target << ", the same id was told of target " << before.target
                                << " until tick " << before.tick << ", and not in between");
        before = {target, entry.tick, entry.status == PLR_TRACK_DELETED};
    }
}

PELORUS_CHECK(tracker, "tracker-covariances-positive", 3,
              "Published covariances are symmetric and positive; deviations and gates are made of them.",
              {"tracker-no-data-no-track"}) {
    FeedOptions options;
    options.ticks = 20;
    for (const Entry& entry : Tracked(bench, options, bench.sample()).entries) {
        const Eigen::MatrixXd& p = entry.covariance;
        // One rounding of each element is forgiven: a conversion of coordinates may leave it.
        const Eigen::MatrixXd gap = (p - p.transpose()).cwiseAbs();
        for (Eigen::Index c = 0; c < p.cols(); ++c)
            for (Eigen::Index r = c + 1; r < p.rows(); ++r)
                if (!(gap(r, c) <= 1e-12 * std::sqrt(std::abs(p(r, r) * p(c, c)))))
                    FAIL(name_of(entry) << ": element (" << r << ", " << c << ") of the covariance is " << p(r, c)
                                        << ", its mirror image " << p(c, r));
        if (!(p.diagonal().minCoeff() > 0)) FAIL(name_of(entry) << ": a variance is " << p.diagonal().minCoeff());
        const Eigen::VectorXd scale = p.diagonal().cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = scale.asDiagonal() * (0.5 * (p + p.transpose())) * scale.asDiagonal();
        const double least =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
        if (!(least > -1e-9))
            FAIL(name_of(entry) << ": the covariance has a negative direction, least eigenvalue " << least
                                << " (scaled to a unit diagonal)");
    }
}

PELORUS_CHECK(tracker, "tracker-counts-misses", 3,
              "misses is how many scans in a row gave a track no measurement: 0 in an entry that used one, else the "
              "scans since the last that did (or 0 where the tracker does not count them).",
              {"tracker-follows-a-target"}) {
    if (sensors_of(bench) != 1) skip("several sensors: what a miss is depends on them");
    FeedOptions options = quiet(1, 40);
    options.lives = [](int, std::int64_t tick) { return tick < 12 || (tick >= 14 && tick < 20) || tick >= 21; };
    const Tracked tracked(bench, options, bench.sample());
    std::map<std::uint64_t, std::int64_t> last_hit;
    for (const Entry& entry : tracked.entries) {
        if (!entry.has_list) skip("tracks do not tell which measurements they used");
        if (!entry.used.empty()) {
            last_hit[entry.id] = entry.tick;
            if (entry.misses != 0)
                FAIL(name_of(entry) << " used a measurement and has misses " << entry.misses << ", expected 0");
        } else if (last_hit.count(entry.id) != 0) {
            const std::int64_t scans = entry.tick - last_hit[entry.id];
            if (entry.misses != 0 && entry.misses != scans)
                FAIL(name_of(entry) << " has misses " << entry.misses << ", but its last measurement was " << scans
                                    << " scans ago");
        }
    }
}

PELORUS_CHECK(tracker, "tracker-names-real-measurements", 3,
              "The measurements that a track says it used have come in; distances are not negative and weights lie "
              "between 0 and 1.",
              {"tracker-no-data-no-track"}) {
    needs_scans(bench);
    FeedOptions options;
    options.ticks = 20;
    const Tracked tracked(bench, options, bench.sample());
    for (const Entry& entry : tracked.entries)
        for (const std::uint64_t id : entry.used)
            if (tracked.received.count(id) == 0)
                FAIL(name_of(entry) << " says that it used measurement " << id << ", which never came in");
    for (const PublishedMessage& published : tracked.player.published()) {
        if (published.message->kind != PLR_MESSAGE_TRACKS) continue;
        const plr_tracks& tracks = *published.message->body.tracks;
        for (std::int64_t k = 0; k < listed(tracks.measurement_offsets, tracks.count); ++k) {
            if (tracks.measurement_distances != nullptr && !(tracks.measurement_distances[k] >= 0))
                FAIL("a squared distance is " << tracks.measurement_distances[k] << " in "
                                              << brief(*published.message));
            if (tracks.measurement_weights != nullptr &&
                !(tracks.measurement_weights[k] >= 0 && tracks.measurement_weights[k] <= 1 + 1e-9))
                FAIL("a weight is " << tracks.measurement_weights[k] << " in " << brief(*published.message));
        }
    }
}

PELORUS_CHECK(tracker, "tracker-errors-fit-covariances", 4,
              "Errors of confirmed tracks are about as large as their covariances say (normalised error squared, over "
              "many runs); a tracker that trusts itself too much loses targets.",
              {"tracker-follows-a-target"}) {
    constexpr int runs = 40;
    constexpr std::int64_t ticks = 15;
    double sum = 0;
    int dimensions = 0;
    for (int run = 0; run < runs; ++run) {
        const Tracked tracked(bench, quiet(1, ticks), bench.sample(10 + static_cast<std::uint64_t>(run)));
        const Entry* last = nullptr;
        for (const Entry& entry : tracked.entries)
            if (is_told(entry)) last = &entry;
        if (last == nullptr) continue;
        std::vector<int> axes;
        Eigen::VectorXd mean;
        Eigen::MatrixXd covariance;
        position_of(*last, axes, mean, covariance);
        const Eigen::Vector3d truth = tracked.feed.position(0, last->time);
        for (std::size_t i = 0; i < axes.size(); ++i) mean(static_cast<Eigen::Index>(i)) -= truth(axes[i]);
        sum += mean.dot(covariance.ldlt().solve(mean));
        dimensions += static_cast<int>(axes.size());
    }
    if (dimensions == 0) skip("tracks have no positions");
    const double per_dimension = sum / dimensions;
    note("normalised error squared " + std::to_string(per_dimension) + " a dimension over " + std::to_string(runs) +
         " runs");
    // A consistent filter has 1, with a deviation of sqrt(2 / dimensions) = 0.13 to 0.16; noise for manoeuvres that do not come
    // makes it less. 2.5 is nine deviations off.
    if (!(per_dimension < 2.5))
        FAIL("normalised errors squared are " << per_dimension << " a dimension on average over " << runs
                                              << " runs, expected about 1, or less: errors are larger than covariances "
                                                 "say");
}

}  // namespace pelorus::conformance
