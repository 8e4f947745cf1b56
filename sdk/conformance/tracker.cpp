// What trackers promise: identities, ends, misses, and covariances that can be believed.
#include <cmath>
#include <map>
#include <set>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "machine/message_fields.hpp"
#include "machine/message_words.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

/// An entry of a tracks message, and the tick in which it was told.
struct Entry {
    std::int64_t tick, time;
    std::uint64_t id;
    std::int32_t status, misses;
    std::vector<std::uint64_t> used;
    bool has_list;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    std::vector<std::string> components;
};

bool is_told(const Entry& entry) { return entry.status == PLR_TRACK_CONFIRMED || entry.status == PLR_TRACK_COASTING; }

std::string name_of(const Entry& entry) {
    return "track " + std::to_string(entry.id) + " at tick " + std::to_string(entry.tick);
}

Eigen::MatrixXd matrix_of(const plr_const_view& view, std::int64_t item) {
    Eigen::MatrixXd matrix(view.rows, view.cols);
    for (std::int64_t c = 0; c < view.cols; ++c)
        for (std::int64_t r = 0; r < view.rows; ++r)
            matrix(r, c) = view.data[item * view.item_stride + c * view.col_stride + r * view.row_stride];
    return matrix;
}

void add_entries(const plr_message& message, std::int64_t tick, std::vector<Entry>& entries) {
    if (message.kind != PLR_MESSAGE_TRACKS) return;
    const plr_tracks& tracks = *message.body.tracks;
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        Entry entry{tick, tracks.times[i], tracks.ids[i], tracks.status[i], tracks.misses[i], {}, false, {}, {}, {}};
        if (tracks.measurement_offsets != nullptr) {
            entry.has_list = true;
            entry.used.assign(tracks.measurements + tracks.measurement_offsets[i],
                              tracks.measurements + tracks.measurement_offsets[i + 1]);
        }
        entry.mean = matrix_of(tracks.mean, i);
        entry.covariance = matrix_of(tracks.covariance, i);
        for (std::uint32_t c = 0; c < tracks.space->size; ++c)
            entry.components.emplace_back(element_of(tracks.space->components, c).name);
        entries.push_back(std::move(entry));
    }
}

/// A tracker that has seen a feed.
struct Tracked {
    Tracked(const Bench& bench, const FeedOptions& options, Sample sample)
        : player(bench), feed(bench, player.instance(), sample, options) {
        for (const Delivery& delivery : feed.deliveries()) {
            const std::size_t before = player.published().size();
            player.deliver(delivery);
            for (std::size_t i = before; i < player.published().size(); ++i)
                add_entries(*player.published()[i].message, delivery.tick, entries);
            if (delivery.message->kind != PLR_MESSAGE_SCAN) continue;
            const plr_scan& scan = *delivery.message->body.scan;
            received.insert(scan.ids, scan.ids + scan.measurements.count);
        }
        const std::size_t before = player.published().size();
        player.finish_well();
        for (std::size_t i = before; i < player.published().size(); ++i)
            add_entries(*player.published()[i].message, options.ticks, entries);
    }
    StagePlayer player;
    Feed feed;
    std::vector<Entry> entries;
    std::set<std::uint64_t> received;
};

/// Targets without clutter; `gone` on, none is there any more.
FeedOptions quiet(int targets, std::int64_t ticks, std::int64_t gone = INT64_MAX) {
    FeedOptions options;
    options.targets = targets;
    options.ticks = ticks;
    options.clutter = 0;
    options.lives = [gone](int, std::int64_t tick) { return tick < gone; };
    return options;
}

/// The position of an entry in the world's axes, those that it has, and its covariance.
void position_of(const Entry& entry, std::vector<int>& axes, Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) {
    std::vector<Eigen::Index> at;
    axes.clear();
    for (std::size_t c = 0; c < entry.components.size(); ++c)
        for (int axis = 0; axis < 3; ++axis)
            if (entry.components[c] == std::string("position.") + "xyz"[axis]) {
                at.push_back(static_cast<Eigen::Index>(c));
                axes.push_back(axis);
            }
    const auto d = static_cast<Eigen::Index>(at.size());
    mean.resize(d);
    covariance.resize(d, d);
    for (Eigen::Index r = 0; r < d; ++r) {
        mean(r) = entry.mean(at[static_cast<std::size_t>(r)]);
        for (Eigen::Index c = 0; c < d; ++c)
            covariance(r, c) = entry.covariance(at[static_cast<std::size_t>(r)], at[static_cast<std::size_t>(c)]);
    }
}

/// The target that an entry is nearest to, and how far it is from it.
int nearest_target(const Feed& feed, const Entry& entry, int targets, double& distance) {
    std::vector<int> axes;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    position_of(entry, axes, mean, covariance);
    int nearest = -1;
    distance = std::numeric_limits<double>::infinity();
    for (int target = 0; target < targets; ++target) {
        const Eigen::Vector3d truth = feed.position(target, entry.time);
        double sum = 0;
        for (std::size_t i = 0; i < axes.size(); ++i)
            sum += std::pow(truth(axes[i]) - mean(static_cast<Eigen::Index>(i)), 2);
        if (std::sqrt(sum) >= distance) continue;
        distance = std::sqrt(sum);
        nearest = target;
    }
    return nearest;
}

/// Whether one entry used measurements of several targets: all of a scan are one extended target to this tracker.
bool takes_all_for_one(const Tracked& tracked) {
    for (const Entry& entry : tracked.entries) {
        std::set<int> targets;
        for (const std::uint64_t id : entry.used)
            if (tracked.feed.target_of(id) >= 0) targets.insert(tracked.feed.target_of(id));
        if (targets.size() > 1) return true;
    }
    return false;
}

/// Whether measurements of the stream tell where a target is, along each of so many axes.
bool locates(const plr_stream& stream, std::size_t axes) {
    if (stream.space == nullptr) return true;  // the feed then measures positions
    std::set<std::string> measured;
    for (std::uint32_t k = 0; k < stream.space->size; ++k)
        measured.insert(element_of(stream.space->components, k).name);
    if (measured.count("range") + measured.count("azimuth") == 2)
        return axes < 3 || measured.count("elevation") + measured.count("zenith") > 0;
    for (std::size_t axis = 0; axis < axes; ++axis)
        if (measured.count(std::string("position.") + "xyz"[axis]) == 0) return false;
    return true;
}

/// How far a track may be from the target that it follows, in m: ten deviations of a range at 10 km and of an angle there, and the
/// errors of a start. Where no sensor tells the whole position (bearings alone), six deviations of the track's own come on top.
double largest_error(const Tracked& tracked, const Entry& entry) {
    constexpr double located = 200;
    std::vector<int> axes;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    position_of(entry, axes, mean, covariance);
    for (const std::uint32_t port : Feed::ports_of(tracked.player.instance(), PLR_MESSAGE_SCAN)) {
        const plr_port_type type = port_type_of(tracked.player.instance(), false, port);
        if (type.stream_count == 0) return located;
        for (std::uint32_t s = 0; s < type.stream_count; ++s)
            if (locates(element_of(type.streams, s), axes.size())) return located;
    }
    return located + 6 * std::sqrt(covariance.trace());
}

std::size_t sensors_of(const Bench& bench) {
    const StagePlayer probe(bench);
    std::size_t sensors = 0;
    for (const std::uint32_t port : Feed::ports_of(probe.instance(), PLR_MESSAGE_SCAN))
        sensors += std::max(port_type_of(probe.instance(), false, port).stream_count, 1u);
    return sensors;
}

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
