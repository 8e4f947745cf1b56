// org.example.analyzer.zone_alarm: tells when tracks enter a zone and when they leave it.
//
// A stage holds state: here, which tracks are inside since when. What evolves is named once, in `state`, and serves saving and loading;
// with it a run can be ended at a snapshot and go on later.
#include <map>

#include <pelorus/pelorus.hpp>

#include "zone.hpp"

namespace {

enum Kind : std::int32_t { entered, left, lost };

/// What is remembered of a track.
struct Watched {
    std::int64_t newest = 0;  // ns, of the entries seen
    std::int64_t since = 0;   // ns, when it entered
    bool inside = false;
    template <class Archive> void state(Archive& archive) { archive(newest, since, inside); }
};

/// A line of the log.
struct Incident {
    std::int64_t time = 0;  // ns
    std::uint64_t track = 0;
    Kind kind = entered;
    double x = 0, y = 0;  // m
    template <class Archive> void state(Archive& archive) { archive(time, track, kind, x, y); }
};

double seconds(std::int64_t time) { return static_cast<double>(time) * 1e-9; }

struct ZoneAlarm : pelorus::Stage<ZoneAlarm> {
    static constexpr const char* kind = "analyzer";
    enum Port : std::uint32_t { occupancy_port, results_port };

    static void describe(pelorus::Describe<ZoneAlarm>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const;
    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        archive(watched_, incidents_, inside_time_, newest_end_, ignored_);
    }

private:
    void look(const plr_tracks& tracks, std::int64_t i, std::int64_t message_time);
    void note(Watched& track, std::uint64_t id, Kind what, std::int64_t time, double x, double y);
    double inside() const;

    Corners zone_;
    double margin_ = 0;  // m
    std::string frame_;

    std::map<std::uint64_t, Watched> watched_;  // by the track's id
    std::vector<Incident> incidents_;
    double inside_time_ = 0;  // s, of tracks that are not inside any more
    std::int64_t newest_end_ =
        std::numeric_limits<std::int64_t>::min();  // ns, when a track was last told to have ended
    std::uint64_t ignored_ = 0;
};

void ZoneAlarm::describe(pelorus::Describe<ZoneAlarm>& plugin) {
    plugin.title("Zone alarm")
        .purpose(
            "Tells when confirmed tracks enter a zone on the ground and when they leave it. A track is in when it is "
            "deeper inside than the margin, and out when it is farther outside, so that one that goes along the edge "
            "does not "
            "raise an alarm with every scan.")
        .equation("d = distance to the edge, negative inside; d < -margin: in; d > margin: out; between: as before");
    plugin.parameter("zone", &ZoneAlarm::zone_)
        .unit("m")
        .initially("[[-1 km, -1 km], [1 km, -1 km], [1 km, 1 km], [-1 km, 1 km]]")
        .rows(3)
        .cols(2, 2)
        .doc("corners of a polygon in the order in which they are joined, x and y of each");
    plugin.parameter("margin", &ZoneAlarm::margin_)
        .unit("m")
        .initially("0 m")
        .min(0.0)
        .doc(
            "half the width of the band along the edge in which nothing changes; three deviations of a track's "
            "position are enough");
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "who is watched, by x and y");
    plugin.out_port("occupancy", PLR_MESSAGE_VALUES, "number of tracks inside, whenever it changes");
    plugin.out_port("results", PLR_MESSAGE_TABLE,
                    "table incidents; scalars entries, exits, lost, inside_time, first_entry, ignored");
}

void ZoneAlarm::setup(const pelorus::Setup& setup) {
    frame_ = setup.frame();
    if (!zone_.allFinite()) throw pelorus::ParameterError("zone", "a corner is not finite");
    for (Eigen::Index i = 0; i < zone_.rows(); ++i)
        if (zone_.row(i) == zone_.row((i + 1) % zone_.rows()))
            throw pelorus::ParameterError("zone", "corner " + std::to_string(i + 1) + " and the one after it coincide");
    if (!(std::fabs(twice_area(zone_)) > 0)) throw pelorus::ParameterError("zone", "its corners enclose no area");
}

std::vector<pelorus::Stream> ZoneAlarm::in_streams(std::uint32_t) const {
    pelorus::Stream tracks;
    tracks.any_sensor = true;
    tracks.space = pelorus::position_space(2);
    tracks.at_least = true;  // velocities, a height and what else a tracker tells are welcome
    tracks.frame = frame_;
    return {tracks};
}

void ZoneAlarm::on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
    const double before = inside();
    for (std::int64_t i = 0; i < tracks.count; ++i) look(tracks, i, event.time);
    const double now = inside();
    if (now == before) return;
    pelorus::ValuesBuilder values;
    values.add("", "occupancy", "", Eigen::MatrixXd::Constant(1, 1, now), event.time);
    publish(occupancy_port, values.message(event.time));
}

/// One entry. A message may come late, or twice: what is not newer than what is known of its track changes nothing, and a track
/// that nobody knows is not taken up from a time before one has ended, since that may have been this one.
void ZoneAlarm::look(const plr_tracks& tracks, std::int64_t i, std::int64_t message_time) {
    const std::int64_t time = tracks.times[i];
    const auto known = watched_.find(tracks.ids[i]);
    const bool ends = tracks.status[i] == PLR_TRACK_DELETED;
    if (tracks.status[i] == PLR_TRACK_TENTATIVE) return;
    // A track's end is told with the time at which it was seen last.
    if (known == watched_.end() ? time < newest_end_
        : ends                  ? time < known->second.newest
                                : time <= known->second.newest) {
        ++ignored_;
        return;
    }
    const auto position = pelorus::item(tracks.mean, i);
    const double x = position(0, 0), y = position(1, 0);
    if (ends) {
        newest_end_ = std::max(newest_end_, message_time);
        if (known == watched_.end()) return;
        if (known->second.inside) note(known->second, known->first, lost, time, x, y);
        watched_.erase(known);
        return;
    }
    Watched& track = known == watched_.end() ? watched_[tracks.ids[i]] : known->second;
    track.newest = time;
    const double outside = distance_outside(zone_, x, y);
    if (!track.inside && outside < -margin_) note(track, tracks.ids[i], entered, time, x, y);
    if (track.inside && outside > margin_) note(track, tracks.ids[i], left, time, x, y);
}

void ZoneAlarm::note(Watched& track, std::uint64_t id, Kind what, std::int64_t time, double x, double y) {
    track.inside = what == entered;
    if (track.inside)
        track.since = time;
    else
        inside_time_ += seconds(time - track.since);
    incidents_.push_back({time, id, what, x, y});
}

double ZoneAlarm::inside() const {
    return static_cast<double>(
        std::count_if(watched_.begin(), watched_.end(), [](const auto& track) { return track.second.inside; }));
}

void ZoneAlarm::finish(const pelorus::Event& event) {
    pelorus::ResultBuilder result("incidents");
    // What happened is told of the first run only: those of many runs have no rows in common.
    result.column("number", "", PLR_REDUCE_KEY);
    result.column("time", "s", PLR_REDUCE_FIRST_RUN);
    result.column("track", "", PLR_REDUCE_FIRST_RUN);
    result.text_column("incident", PLR_REDUCE_FIRST_RUN, {"entered", "left", "lost"});
    result.column("position.x", "m", PLR_REDUCE_FIRST_RUN);
    result.column("position.y", "m", PLR_REDUCE_FIRST_RUN);
    double number = 0, counts[3] = {0, 0, 0}, first_entry = std::numeric_limits<double>::quiet_NaN();
    for (const Incident& incident : incidents_) {
        if (incident.kind == entered && counts[entered] == 0) first_entry = seconds(incident.time);
        counts[incident.kind] += 1;
        result.row({++number, seconds(incident.time), static_cast<double>(incident.track),
                    static_cast<double>(incident.kind), incident.x, incident.y});
    }
    double inside_time = inside_time_;
    for (const auto& [id, track] : watched_)
        if (track.inside) inside_time += seconds(track.newest - track.since);
    result.scalar("entries", "", PLR_REDUCE_MEAN, counts[entered]);
    result.scalar("exits", "", PLR_REDUCE_MEAN, counts[left]);
    result.scalar("lost", "", PLR_REDUCE_MEAN, counts[lost]);
    result.scalar("inside_time", "s", PLR_REDUCE_MEAN, inside_time);
    result.scalar("first_entry", "s", PLR_REDUCE_MEAN, first_entry);
    result.scalar("ignored", "", PLR_REDUCE_MEAN, static_cast<double>(ignored_));
    publish(results_port, result.message(event.time));
}

}  // namespace

PELORUS_PLUGIN(ZoneAlarm, "org.example.analyzer.zone_alarm");
