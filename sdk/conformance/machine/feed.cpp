#include "feed.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <pelorus/messages.hpp>

#include "message_fields.hpp"

namespace pelorus::conformance {

namespace {

bool is(const char* text, const char* word) noexcept { return std::strcmp(text, word) == 0; }

int axis_of(const char* name) noexcept {
    const std::size_t length = std::strlen(name);
    return length < 2 || name[length - 2] != '.' ? -1 : name[length - 1] - 'x';
}

pelorus::Space space_or(const plr_stream* stream, const pelorus::Space& otherwise) {
    return stream == nullptr || stream->space == nullptr ? otherwise : pelorus::Space(*stream->space);
}
std::string frame_of(const plr_stream* stream) {
    return stream == nullptr || stream->frame == nullptr ? "" : stream->frame;
}
const plr_stream* first_stream(const plr_port_type& type) noexcept {
    return type.stream_count == 0 ? nullptr : &element_of(type.streams, 0);
}

const Eigen::Vector3d half_axes(10.0, 4.0, 3.0);  // m, of a target

Eigen::MatrixXd extent_of(std::int64_t axes) { return half_axes.head(axes).cwiseAbs2().asDiagonal(); }

}  // namespace

double deviation_of(const plr_component& c) noexcept {
    if (is(c.unit, "m")) return 5.0;
    if (is(c.unit, "rad")) return 1e-3;
    if (is(c.unit, "m/s")) return 1.0;
    return 0.01 * scale_of(c);
}

plr_port_type port_type_of(const Instance& instance, bool is_output, std::uint32_t port) {
    plr_port_type type{sizeof(plr_port_type), 0, nullptr, 0, 0};
    const auto& table = instance.table<plr_stage>();
    if (table.port_type == nullptr) return type;
    plr_error error = empty_error();
    const plr_status status = table.port_type(instance.self(), is_output ? 1 : 0, port, &type, &error);
    if (status != PLR_OK)
        FAIL("port_type answered " << told(status, error) << " for " << (is_output ? "out" : "in") << " port " << port);
    return type;
}

Feed::Feed(const Bench& bench, const Instance& instance, Sample sample, FeedOptions options)
    : bench_(bench), instance_(instance), sample_(sample), options_(std::move(options)), next_id_(options_.first_id) {
    if (options_.points == 0) {
        options_.points = 1;
        const plr_description& description = instance.description();
        for (std::uint32_t slot = 0; slot < description.slot_count; ++slot)
            if (is(element_of(description.slots, slot).kind, "extent")) options_.points = 8;
    }
    for (int t = 0; t < options_.targets; ++t) {
        starts_.emplace_back(2000.0 + 3000.0 * t + sample_.uniform(-200, 200),
                             1500.0 + 1000.0 * t + sample_.uniform(-200, 200), 500.0 + 200.0 * t);
        velocities_.emplace_back(10.0 - 4.0 * t + sample_.uniform(-2, 2), 8.0 + sample_.uniform(-2, 2), 0.0);
    }
    const bool has_scans = !ports_of(instance, PLR_MESSAGE_SCAN).empty();
    for (std::int64_t tick = options_.first_tick; tick < options_.first_tick + options_.ticks; ++tick) {
        if (!has_scans)  // truth and tracks name measurements that were made elsewhere
            for (const int target : living(tick)) seen_[{target, tick}] = {next_id_++};
        const std::size_t first = deliveries_.size();
        for (const std::uint32_t kind :
             {PLR_MESSAGE_SCAN, PLR_MESSAGE_TRUTH, PLR_MESSAGE_TRACKS, PLR_MESSAGE_VALUES, PLR_MESSAGE_TABLE})
            for (const std::uint32_t port : ports_of(instance, kind)) add(kind, port, tick);
        // A tick's truth comes before its scans, and those before what is made of them.
        std::stable_sort(deliveries_.begin() + static_cast<std::ptrdiff_t>(first), deliveries_.end(),
                         [](const Delivery& one, const Delivery& other) {
                             return one.message->kind == PLR_MESSAGE_TRUTH && other.message->kind != PLR_MESSAGE_TRUTH;
                         });
    }
}

void Feed::add(std::uint32_t kind, std::uint32_t port, std::int64_t tick) {
    const plr_port_type type = port_type_of(instance_, false, port);
    if (kind == PLR_MESSAGE_SCAN) add_scans(port, type, tick);
    if (kind == PLR_MESSAGE_TRACKS) add_tracks(port, type, tick);
    if (kind == PLR_MESSAGE_TRUTH) add_truth(port, type, tick);
    if (kind == PLR_MESSAGE_VALUES && tick % 8 == 0) add_values(port, tick);
    if (kind == PLR_MESSAGE_TABLE && tick % 8 == 0) add_table(port, tick);
}

int Feed::target_of(std::uint64_t measurement) const {
    const auto found = origins_.find(measurement);
    return found == origins_.end() ? -1 : found->second;
}

Eigen::Vector3d Feed::position(int target, std::int64_t time) const {
    const auto t = static_cast<std::size_t>(target);
    return starts_[t] + velocities_[t] * (static_cast<double>(time) * 1e-9);
}

std::vector<std::uint32_t> Feed::ports_of(const Instance& instance, std::uint32_t kind) {
    std::vector<std::uint32_t> ports;
    for (std::uint32_t port = 0; port < instance.description().in_port_count; ++port)
        if (element_of(instance.description().in_ports, port).message == kind) ports.push_back(port);
    return ports;
}

bool Feed::lives(int target, std::int64_t tick) const {
    return options_.lives ? options_.lives(target, tick) : target != 2 || 3 * tick < 2 * options_.ticks;
}

std::vector<int> Feed::living(std::int64_t tick) const {
    std::vector<int> targets;
    for (int t = 0; t < options_.targets; ++t)
        if (lives(t, tick)) targets.push_back(t);
    return targets;
}

std::vector<std::uint64_t> Feed::measurements_of(int target, std::int64_t tick) const {
    const auto found = seen_.find({target, tick});
    return found == seen_.end() || !options_.has_lists ? std::vector<std::uint64_t>() : found->second;
}

/// Without noise, as a sensor at the origin would have it.
double Feed::component(const plr_component& c, int target, std::int64_t time) const {
    const Eigen::Vector3d p = position(target, time) + offset_, v = velocities_[static_cast<std::size_t>(target)];
    const int axis = axis_of(c.name);
    const bool has_axis = axis >= 0 && axis < 3;
    if (has_axis && std::strncmp(c.name, "position.", 9) == 0) return p(axis);
    if (has_axis && std::strncmp(c.name, "velocity.", 9) == 0) return v(axis);
    if (has_axis && std::strncmp(c.name, "acceleration.", 13) == 0) return 0.0;
    if (is(c.name, "range")) return p.norm();
    if (is(c.name, "range_rate")) return p.dot(v) / p.norm();
    if (is(c.name, "azimuth")) return std::atan2(p.y(), p.x());
    if (is(c.name, "elevation")) return std::atan2(p.z(), std::hypot(p.x(), p.y()));
    if (is(c.name, "zenith")) return std::atan2(std::hypot(p.x(), p.y()), p.z());
    return (std::isfinite(c.prior_mean) ? c.prior_mean : 0.0) + 0.1 * (target + 1) * scale_of(c);
}

Eigen::VectorXd Feed::state(const plr_space& space, int target, std::int64_t time) const {
    Eigen::VectorXd x(space.size);
    for (std::uint32_t i = 0; i < space.size; ++i) x(i) = component(element_of(space.components, i), target, time);
    return x;
}

void Feed::add_scans(std::uint32_t port, const plr_port_type& type, std::int64_t tick) {
    const std::int64_t time = tick * feed_period;
    for (std::uint32_t s = 0; s < std::max(type.stream_count, 1u); ++s) {
        const plr_stream* const stream = type.stream_count == 0 ? nullptr : &element_of(type.streams, s);
        const pelorus::Space space = space_or(stream, pelorus::position_space(3));
        const std::string sensor = stream == nullptr || stream->sensor == nullptr ? "radar" : stream->sensor;
        pelorus::ScanBuilder scan(sensor, frame_of(stream), space);
        Eigen::VectorXd deviations(space.size());
        for (int i = 0; i < space.size(); ++i)
            deviations(i) = deviation_of(element_of(space.c()->components, static_cast<std::uint32_t>(i)));
        const Eigen::MatrixXd covariance = deviations.cwiseAbs2().asDiagonal();
        const auto add = [&](Eigen::VectorXd z, int target) {
            for (int i = 0; i < space.size(); ++i) z(i) += deviations(i) * sample_.normal();
            const std::uint64_t id = next_id_++;
            scan.add(id, z.data(), options_.has_covariances ? covariance.data() : nullptr);
            if (options_.is_scan_timed) scan.set_time(time - 1000 * scan.count());
            if (target >= 0) seen_[{target, tick}].push_back(id);
            origins_[id] = target;
        };
        for (const int target : living(tick))
            for (int point = 0; point < options_.points; ++point) {
                if (options_.points > 1)
                    offset_ = half_axes.cwiseProduct(
                        Eigen::Vector3d(sample_.normal(), sample_.normal(), sample_.normal()) / 2);
                const Eigen::VectorXd z = state(*space.c(), target, time);
                offset_.setZero();
                add(z, target);
            }
        if (sample_.uniform() < options_.clutter && options_.targets > 0) {
            Eigen::VectorXd z = state(*space.c(), 0, time);
            for (int i = 0; i < space.size(); ++i) z(i) += sample_.uniform(100.0, 200.0) * deviations(i);
            add(z, -1);
        }
        plr_message message = scan.message(time);
        plr_scan body = *message.body.scan;
        if (options_.is_covariance_common && body.covariances.data != nullptr) body.covariances.item_stride = 0;
        message.body.scan = &body;
        deliver(port, tick, message);
    }
}

void Feed::add_tracks(std::uint32_t port, const plr_port_type& type, std::int64_t tick) {
    if ((tick + 1) % options_.ticks_a_message != 0) return;
    const plr_stream* const stream = first_stream(type);
    const pelorus::Space space = space_or(stream, pelorus::kinematic_space(3, {1e5, 100.0}));
    std::int64_t axes = 0;
    while (axes < 3 && space.index(std::string("position.") + "xyz"[axes]) >= 0) ++axes;
    const int dimension = options_.has_extents ? static_cast<int>(axes) : 0;
    pelorus::TracksBuilder tracks(frame_of(stream), space, dimension);
    Eigen::VectorXd deviations(space.size());
    for (int i = 0; i < space.size(); ++i)
        deviations(i) = deviation_of(element_of(space.c()->components, static_cast<std::uint32_t>(i)));
    const Eigen::MatrixXd covariance = deviations.cwiseAbs2().asDiagonal(), extent = extent_of(axes);
    for (std::int64_t at = tick + 1 - options_.ticks_a_message; at <= tick; ++at)
        for (int target = 0; target < options_.targets; ++target) {
            const bool is_here = lives(target, at);
            if (!is_here && !(at > 0 && lives(target, at - 1))) continue;
            pelorus::TrackEntry entry;
            const std::int64_t time = at * feed_period;
            Eigen::VectorXd mean = state(*space.c(), target, time);
            // The errors of a target are a function of the tick alone, whoever tells them and in which message.
            for (int i = 0; i < space.size(); ++i)
                mean(i) += deviations(i) * std::sin(1.7 * static_cast<double>(at) + 2.3 * target + i);
            entry.id = static_cast<std::uint64_t>(100 + target);
            entry.time = time;
            entry.status = !is_here ? PLR_TRACK_DELETED : at < 2 ? PLR_TRACK_TENTATIVE : PLR_TRACK_CONFIRMED;
            entry.mean = mean.data();
            entry.covariance = covariance.data();
            if (dimension != 0) entry.extent = extent.data();
            if (is_here) entry.measurements = measurements_of(target, at);
            tracks.add(entry);
        }
    deliver(port, tick, tracks.message(tick * feed_period));
}

void Feed::add_truth(std::uint32_t port, const plr_port_type& type, std::int64_t tick) {
    if ((tick + 1) % options_.ticks_a_message != 0) return;
    const plr_stream* const stream = first_stream(type);
    const pelorus::Space space = space_or(stream, pelorus::kinematic_space(3, {1e5, 100.0}));
    std::int64_t axes = 0;
    while (axes < 3 && space.index(std::string("position.") + "xyz"[axes]) >= 0) ++axes;
    const int dimension = options_.has_extents ? static_cast<int>(axes) : 0;
    pelorus::TruthBuilder truth(frame_of(stream), space, dimension);
    const Eigen::MatrixXd extent = extent_of(axes);
    for (std::int64_t at = tick + 1 - options_.ticks_a_message; at <= tick; ++at)
        for (const int target : living(at)) {
            const Eigen::VectorXd x = state(*space.c(), target, at * feed_period);
            pelorus::TruthEntry entry;
            entry.id = entry.parent = static_cast<std::uint64_t>(1 + target);
            entry.time = at * feed_period;
            entry.state = x.data();
            if (dimension != 0) entry.extent = extent.data();
            entry.measurements = measurements_of(target, at);
            truth.add(entry);
        }
    deliver(port, tick, truth.message(tick * feed_period));
}

/// The stage's own inputs, at their defaults, where it has any.
void Feed::add_values(std::uint32_t port, std::int64_t tick) {
    pelorus::ValuesBuilder values;
    const plr_config& config = instance_.config();
    for (std::uint32_t i = 0; i < config.input_count; ++i) {
        const plr_input_place& place = element_of(config.inputs, i);
        const Eigen::Map<const Eigen::VectorXd> defaults(place.defaults, place.size);
        values.add("", place.name, place.unit, defaults);
    }
    if (config.input_count == 0) values.add("radar", "azimuth", "rad", Eigen::MatrixXd::Constant(1, 1, 0.1));
    deliver(port, tick, values.message(tick * feed_period));
}

void Feed::add_table(std::uint32_t port, std::int64_t tick) {
    pelorus::ResultBuilder table("by_time");
    table.column("time", "s", PLR_REDUCE_KEY);
    table.column("error", "m", PLR_REDUCE_MEAN);
    table.row({static_cast<double>(tick), 1.0});
    deliver(port, tick, table.message(tick * feed_period));
}

void Feed::deliver(std::uint32_t port, std::int64_t tick, const plr_message& message) {
    plr_message complete = message;
    complete.arrival = message.time;
    complete.sequence = deliveries_.size() + 1;
    complete.origin = "feed";
    deliveries_.push_back({port, tick, bench_.host().copy(complete)});
}

}  // namespace pelorus::conformance
