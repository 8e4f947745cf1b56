#include "tracker_bench.hpp"

#include <cmath>

#include "machine/message_fields.hpp"

namespace pelorus::conformance {

namespace {

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

}  // namespace

bool is_told(const Entry& entry) { return entry.status == PLR_TRACK_CONFIRMED || entry.status == PLR_TRACK_COASTING; }

std::string name_of(const Entry& entry) {
    return "track " + std::to_string(entry.id) + " at tick " + std::to_string(entry.tick);
}

Tracked::Tracked(const Bench& bench, const FeedOptions& options, Sample sample)
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

FeedOptions quiet(int targets, std::int64_t ticks, std::int64_t gone) {
    FeedOptions options;
    options.targets = targets;
    options.ticks = ticks;
    options.clutter = 0;
    options.lives = [gone](int, std::int64_t tick) { return tick < gone; };
    return options;
}

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

bool takes_all_for_one(const Tracked& tracked) {
    for (const Entry& entry : tracked.entries) {
        std::set<int> targets;
        for (const std::uint64_t id : entry.used)
            if (tracked.feed.target_of(id) >= 0) targets.insert(tracked.feed.target_of(id));
        if (targets.size() > 1) return true;
    }
    return false;
}

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

}  // namespace pelorus::conformance
