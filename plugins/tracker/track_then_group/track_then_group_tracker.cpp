#include "track_then_group_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace track_then_group {

namespace {

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

Layout layout_of(const plr_space& raw) {
    const pelorus::Space space(raw);
    Layout layout;
    for (const char* axis : {"x", "y", "z"}) {
        const int position = space.index(std::string("position.") + axis);
        if (position < 0) continue;
        layout.position.push_back(position);
        if (const int velocity = space.index(std::string("velocity.") + axis); velocity >= 0)
            layout.velocity.push_back(velocity);
    }
    if (layout.position.empty()) throw pelorus::DataError("tracks tell no position: " + space.text());
    if (layout.velocity.size() != layout.position.size()) layout.velocity.clear();
    return layout;
}

double component(const std::vector<double>& mean, int index) { return mean[static_cast<std::size_t>(index)]; }

/// Item i, packed.
std::vector<double> packed(const plr_const_view& view, std::int64_t i) {
    std::vector<double> out;
    const auto matrix = pelorus::item(view, i);
    for (std::int64_t c = 0; c < matrix.cols(); ++c)
        for (std::int64_t r = 0; r < matrix.rows(); ++r) out.push_back(matrix(r, c));
    return out;
}

/// The position at another time, along the velocity.
std::array<double, 3> position_at(const Held& held, std::int64_t time, const Layout& layout) {
    std::array<double, 3> out{};
    const double dt = static_cast<double>(time - held.time) * 1e-9;
    for (std::size_t a = 0; a < layout.position.size(); ++a) {
        out[a] = component(held.mean, layout.position[a]);
        if (!layout.velocity.empty()) out[a] += dt * component(held.mean, layout.velocity[a]);
    }
    return out;
}

}  // namespace

void TrackThenGroupTracker::describe(pelorus::Describe<TrackThenGroupTracker>& plugin) {
    plugin.title("Groups of the tracks of another tracker")
        .purpose(
            "Targets are tracked one by one, by whatever tracker stands before this one; groups are what is linked of "
            "their estimates: pairs nearer than a threshold, directly or through others, with hysteresis. Groups keep "
            "their ids through splits and mergers, and parents say which group came from which.")
        .equation(
            "a pair links at |a - b| < (1 - h) d0, unlinks at |a - b| >= (1 + h) d0 (velocities likewise), either "
            "after the time of persistence; groups: connected components; extent = (d + 2) S + r^2 I, S the scatter of "
            "the n members about their mean, divided by n")
        .source(
            "L. Han, L. Zhou, Journal of Ordnance Equipment Engineering 41(12), 240-246, 2020 (distance linkage); H. "
            "Jeung, M. "
            "L. Yiu, X. Zhou, C. S. Jensen, H. T. Shen, Discovery of Convoys in Trajectory Databases, PVLDB 1(1), "
            "2008 (objects together for a time); D. Greene, D. Doyle, P. Cunningham, Tracking the Evolution of "
            "Communities in Dynamic Social Networks, ASONAM 2010 (which group goes on in which)");
    plugin.parameter("threshold", &TrackThenGroupTracker::threshold_)
        .unit("m")
        .min(1e-6)
        .max(1e14)
        .doc("d0: tracks less than so far apart belong together");
    plugin.parameter("hysteresis", &TrackThenGroupTracker::hysteresis_)
        .initially("10 %")
        .min(0.0)
        .below(1.0)
        .doc("h: share of the thresholds by which they are lower for what links and higher for what unlinks");
    plugin.parameter("velocity_threshold", &TrackThenGroupTracker::velocity_threshold_)
        .unit("m/s")
        .above(0.0)
        .doc("tracks that belong together also differ in velocity by less than that; absent: velocities do not matter");
    plugin.parameter("minimum_speed", &TrackThenGroupTracker::minimum_speed_)
        .unit("m/s")
        .above(0.0)
        .doc("slower tracks are in no group (of 0), with the same hysteresis; absent: all are grouped");
    plugin.parameter("persistence", &TrackThenGroupTracker::persistence_)
        .unit("s")
        .initially("0 s")
        .min(0.0)
        .max(1e9)
        .doc("a pair links, or unlinks, once it has been near, or apart, for so long");
    plugin.parameter("memory", &TrackThenGroupTracker::memory_)
        .unit("s")
        .min(0.0)
        .max(1e9)
        .doc(
            "for so long a group that another one has absorbed can come back under its id; absent: as long as its "
            "tracks live");
    plugin.parameter("member_radius", &TrackThenGroupTracker::member_radius_)
        .unit("m")
        .initially("10 m")
        .above(0.0)
        .doc("r: half axis of the extent of a group of one");
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "tracks of single targets");
    plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "the same, each with the id of its group");
    plugin.out_port("groups", PLR_MESSAGE_TRACKS,
                    "the groups: centre, extent, parents; those with a member among the tracks told, or with other "
                    "members than before");
}

void TrackThenGroupTracker::setup(const pelorus::Setup& setup) {
    frame_ = setup.frame();
    links_.setup({threshold_, hysteresis_, velocity_threshold_, nanoseconds(persistence_)});
    lineage_.setup(memory_ ? nanoseconds(*memory_) : Lineage::always);
}

std::vector<pelorus::Stream> TrackThenGroupTracker::in_streams(std::uint32_t) const {
    pelorus::Stream stream;
    stream.space = needs_velocity() ? pelorus::kinematic_space(1, {0.0, 0.0}) : pelorus::position_space(1);
    stream.frame = frame_;
    stream.at_least = true;
    return {stream};
}

void TrackThenGroupTracker::on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
    const Layout layout = layout_of(*tracks.space);
    if (needs_velocity() && layout.velocity.empty())
        throw pelorus::DataError("tracks tell no velocity, which velocity_threshold and minimum_speed ask for");
    const auto size = static_cast<std::size_t>(tracks.space->size);
    if (!held_.empty() && held_.begin()->second.mean.size() != size)
        throw pelorus::DataError("tracks have " + std::to_string(size) + " components, those before had " +
                                 std::to_string(held_.begin()->second.mean.size()));
    take(tracks, layout);
    newest_ = std::max(newest_.value_or(event.time), event.time);
    group_tracks(*newest_, layout);
    publish_tracks(event.time, tracks);
    publish_groups(*newest_, tracks, layout);
    for (auto at = held_.begin(); at != held_.end();)
        at = at->second.status == PLR_TRACK_DELETED ? held_.erase(at) : std::next(at);
}

/// Keeps the newest entry of every track that is more than an attempt.
void TrackThenGroupTracker::take(const plr_tracks& tracks, const Layout& layout) {
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        if (tracks.status[i] == PLR_TRACK_TENTATIVE) continue;
        Held& held = held_[tracks.ids[i]];
        if (!held.mean.empty() && tracks.times[i] < held.time && tracks.status[i] != PLR_TRACK_DELETED) continue;
        held.time = tracks.times[i];
        held.status = tracks.status[i];
        held.misses = tracks.misses[i];
        held.mean = packed(tracks.mean, i);
        held.covariance = packed(tracks.covariance, i);
        held.moves = is_moving(held, layout);
    }
}

bool TrackThenGroupTracker::is_moving(const Held& held, const Layout& layout) const {
    if (!minimum_speed_) return true;
    double squares = 0;
    for (const int index : layout.velocity) squares += component(held.mean, index) * component(held.mean, index);
    return std::sqrt(squares) > *minimum_speed_ * (held.moves ? 1 - hysteresis_ : 1 + hysteresis_);
}

/// What can be linked, where it is at that time; a track that has gone beyond all numbers is nowhere.
std::vector<Member> TrackThenGroupTracker::members_at(std::int64_t time, const Layout& layout) const {
    std::vector<Member> members;
    for (const auto& [id, held] : held_) {
        if (held.status == PLR_TRACK_DELETED || !held.moves) continue;
        Member member{id, position_at(held, time, layout), {}};
        for (std::size_t a = 0; a < layout.velocity.size(); ++a)
            member.velocity[a] = component(held.mean, layout.velocity[a]);
        const auto& p = member.position;
        if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) members.push_back(member);
    }
    return members;
}

void TrackThenGroupTracker::group_tracks(std::int64_t time, const Layout& layout) {
    const std::vector<Member> members = members_at(time, layout);
    std::vector<Ids> lists;
    for (const auto& indices : components(members.size(), links_.update(time, members))) {
        lists.emplace_back();
        for (const std::size_t i : indices) lists.back().push_back(members[i].id);
    }
    const Ids groups = lineage_.update(time, lists);
    for (auto& [id, held] : held_)
        if (held.status != PLR_TRACK_DELETED) held.group = 0;  // one that ended was where it was
    for (std::size_t k = 0; k < lists.size(); ++k)
        for (const std::uint64_t id : lists[k]) held_[id].group = groups[k];
}

void TrackThenGroupTracker::publish_tracks(std::int64_t time, const plr_tracks& tracks) {
    Ids groups;
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        const auto found = held_.find(tracks.ids[i]);
        groups.push_back(found == held_.end() ? 0 : found->second.group);
    }
    plr_tracks told = tracks;
    told.struct_size = sizeof told;
    told.groups = groups.data();
    plr_message message = pelorus::detail::message_of(PLR_MESSAGE_TRACKS, time);
    message.body.tracks = &told;
    publish(tracks_out, message);
}

/// Mean and covariance of the centre, the errors of the members taken as independent, and the extent.
Told TrackThenGroupTracker::moments_of(const Ids& members, std::int64_t time, const Layout& layout) const {
    const std::size_t d = layout.position.size(), c = held_.at(members.front()).mean.size();
    const auto n = static_cast<double>(members.size());
    Told told{
        std::vector<double>(c, 0.0), std::vector<double>(c * c, 0.0), std::vector<double>(d * d, 0.0), {}, members};
    std::vector<std::array<double, 3>> places;
    for (const std::uint64_t id : members) {
        Held held = held_.at(id);
        places.push_back(position_at(held, time, layout));
        for (std::size_t a = 0; a < d; ++a) held.mean[static_cast<std::size_t>(layout.position[a])] = places.back()[a];
        for (std::size_t k = 0; k < c; ++k) told.mean[k] += held.mean[k] / n;
        for (std::size_t k = 0; k < c * c; ++k) told.covariance[k] += held.covariance[k] / (n * n);
    }
    for (std::size_t a = 0; a < d; ++a)
        for (std::size_t b = 0; b < d; ++b) {
            double scatter = 0;
            for (const auto& place : places)
                scatter += (place[a] - component(told.mean, layout.position[a])) *
                           (place[b] - component(told.mean, layout.position[b])) / n;
            told.extent[b * d + a] =
                static_cast<double>(d + 2) * scatter + (a == b ? member_radius_ * member_radius_ : 0.0);
        }
    return told;
}

/// Living members of each group.
std::map<std::uint64_t, Ids> TrackThenGroupTracker::members_of_groups() const {
    std::map<std::uint64_t, Ids> members;
    for (const auto& [id, held] : held_)
        if (held.group != 0 && held.status != PLR_TRACK_DELETED) members[held.group].push_back(id);
    return members;
}

/// What the members of each group used, of those groups that have a member in the message.
std::map<std::uint64_t, Ids> TrackThenGroupTracker::measurements_of_groups(const plr_tracks& tracks) const {
    std::map<std::uint64_t, Ids> measurements;
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        const auto found = held_.find(tracks.ids[i]);
        if (found == held_.end() || found->second.group == 0) continue;
        Ids& list = measurements[found->second.group];
        if (tracks.measurement_offsets != nullptr)
            list.insert(list.end(), tracks.measurements + tracks.measurement_offsets[i],
                        tracks.measurements + tracks.measurement_offsets[i + 1]);
    }
    return measurements;
}

/// An entry with what the group was told with last.
pelorus::TrackEntry TrackThenGroupTracker::entry_of(std::uint64_t id, std::int64_t time) const {
    const Told& told = told_.at(id);
    pelorus::TrackEntry entry;
    entry.id = id;
    entry.time = time;
    entry.status = PLR_TRACK_DELETED;
    entry.mean = told.mean.data();
    entry.covariance = told.covariance.data();
    entry.extent = told.extent.data();
    entry.parents = told.parents;
    return entry;
}

/// As its members are: seen if one of them was.
void TrackThenGroupTracker::set_status(const Ids& members, pelorus::TrackEntry& entry) const {
    entry.misses = held_.at(members.front()).misses;
    entry.status = PLR_TRACK_COASTING;
    for (const std::uint64_t member : members) {
        const Held& held = held_.at(member);
        entry.misses = std::min(entry.misses, held.misses);
        if (held.status == PLR_TRACK_CONFIRMED) entry.status = PLR_TRACK_CONFIRMED;
    }
}

void TrackThenGroupTracker::publish_groups(std::int64_t time, const plr_tracks& tracks, const Layout& layout) {
    pelorus::TracksBuilder builder(tracks.frame, pelorus::Space(*tracks.space),
                                   static_cast<int>(layout.position.size()));
    for (const std::uint64_t id : lineage_.ended()) {
        if (told_.count(id) == 0) continue;
        builder.add(entry_of(id, time));
        told_.erase(id);
    }
    const std::map<std::uint64_t, Ids> measurements = measurements_of_groups(tracks);
    for (const auto& [id, members] : members_of_groups()) {
        const auto news = measurements.find(id);
        const auto before = told_.find(id);
        if (news == measurements.end() && before != told_.end() && before->second.members == members) continue;
        told_[id] = moments_of(members, time, layout);
        told_[id].parents = lineage_.parents(id);
        pelorus::TrackEntry entry = entry_of(id, time);
        set_status(members, entry);
        if (news != measurements.end()) entry.measurements = news->second;
        builder.add(entry);
    }
    publish(groups_out, builder.message(time));
}

}  // namespace track_then_group
