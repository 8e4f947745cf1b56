/// A stage that makes one scan of several sensors' (see scan_fusion.hpp), and one list of tracks of two trackers'.
///
///     struct Mine : fusion::TrackFusion<Mine> {
///         static constexpr bool takes_common = false;               // whether there is a port `common`
///         bool wants_common() const;                                 // and whether tracks wait for it
///         bool fuse_tracks(const TrackPair& pair, Fused& out) const; // false: they cannot be
///     };                                                             // and what ScanFusion asks for
///
/// Tracks of two trackers are of one time, or of stamps within the tolerance; who comes late is treated as scans are.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scan_fusion.hpp"
#include "track_pairs.hpp"

namespace fusion {

enum class Derivatives { position, velocity, acceleration };

/// Two tracks of one object.
struct TrackPair {
    const CommonSpace& space;
    std::int64_t time;  ///< ns
    Piece first, second;
    std::optional<Piece> common;  ///< what both know from the same source
};

template <class Derived> class TrackFusion : public ScanFusion<Derived> {
public:
    enum InPort : std::uint32_t { scans_in, first_in, second_in, common_in };
    enum OutPort : std::uint32_t { scans_out, tracks_out };

    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const {
        if (port == scans_in) return this->scan_in_streams();
        if (port > common_in || (port == common_in && !Derived::takes_common)) return {};
        std::vector<pelorus::Stream> out = track_streams();
        out.front().at_least = true;
        return out;
    }
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const {
        return port == scans_out ? this->scan_out_streams() : track_streams();
    }

    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
        if (event.port == common_in && !this->derived().wants_common()) return;
        Sight sight = read(event, tracks);
        if (meetings_.has(sight.sensor, sight.time))
            throw pelorus::DataError("this tracker has told of this time already");
        while (auto meeting = meetings_.next(event.arrival)) tell_tracks(*meeting);
        if (meetings_.is_late(sight.time)) return this->count("tracks_late", 1);
        meetings_.add(event.arrival, std::move(sight));
        while (auto meeting = meetings_.next(event.arrival)) tell_tracks(*meeting);
    }
    void finish(const pelorus::Event& event) {
        ScanFusion<Derived>::finish(event);
        while (auto meeting = meetings_.last()) tell_tracks(*meeting);
    }
    template <class Archive> void state(Archive& archive) {
        ScanFusion<Derived>::state(archive);
        archive(meetings_, pairs_, living_);
    }

    /// What is fused of each track.
    const pelorus::Space& track_space() const noexcept { return space_.space(); }

protected:
    static void describe_tracks(pelorus::Describe<Derived>& plugin) {
        plugin.parameter("dimension", &TrackFusion::dimension_)
            .initially("3")
            .min(2)
            .max(3)
            .doc("of the tracks: in the plane or in space");
        plugin.parameter("derivatives", &TrackFusion::derivatives_)
            .initially("velocity")
            .choices({{"position", ""}, {"velocity", ""}, {"acceleration", ""}})
            .doc("up to which derivative tracks are fused; they must tell it, what they tell besides is left out");
        plugin.in_port("first", PLR_MESSAGE_TRACKS, "of one tracker", PLR_PORT_OPTIONAL);
        plugin.in_port("second", PLR_MESSAGE_TRACKS, "of another one, of the same objects", PLR_PORT_OPTIONAL);
        if constexpr (Derived::takes_common)
            plugin.in_port("common", PLR_MESSAGE_TRACKS,
                           "what both trackers know from one source, predicted to the same time", PLR_PORT_OPTIONAL);
        plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "fused, with ids of this node's own");
    }
    void setup_tracks() {
        space_.add(
            pelorus::kinematic_space(dimension_, std::vector<double>(static_cast<std::size_t>(derivatives_) + 1, 0.0)),
            "tracks");
        meetings_.setup(*this, this->derived().wants_common() ? 3 : 2);
    }

private:
    /// The last estimate of a fused track, with which its end is told.
    struct Last {
        Eigen::VectorXd mean;
        Eigen::MatrixXd covariance;
        template <class Archive> void state(Archive& archive) { archive(mean, covariance); }
    };

    std::vector<pelorus::Stream> track_streams() const {
        pelorus::Stream stream;
        stream.space = space_.space();
        stream.frame = this->frame();
        return {stream};
    }

    Sight read(const pelorus::Event& event, const plr_tracks& tracks) const {
        const pelorus::Space theirs(*tracks.space);
        std::vector<int> places;
        for (const pelorus::Component& component : space_.space().components()) {
            places.push_back(theirs.index(component.name));
            if (places.back() < 0) throw pelorus::DataError("tracks without " + component.name + ": " + theirs.text());
        }
        Sight sight{static_cast<int>(event.port) - 1, event.time, {}};
        for (std::int64_t i = 0; i < tracks.count; ++i) {
            if (tracks.status[i] == PLR_TRACK_DELETED) continue;
            if (tracks.times[i] != event.time) {
                this->count("tracks_of_other_times", 1);
                continue;
            }
            sight.sightings.push_back({tracks.ids[i], pelorus::item(tracks.mean, i)(places, 0),
                                       pelorus::item(tracks.covariance, i)(places, places), tracks.status[i]});
        }
        return sight;
    }

    Piece piece(const Sighting& track) const {
        Piece out{{}, track.value, track.covariance};
        for (int c = 0; c < space_.size(); ++c) out.places.push_back(c);
        return out;
    }

    void tell_tracks(const Meeting& meeting) {
        const Sight* sides[3] = {};
        for (const Sight& sight : meeting.sights) sides[sight.sensor] = &sight;
        const bool is_whole = sides[0] != nullptr && sides[1] != nullptr;
        if (!is_whole && (this->alone == Alone::drop || (sides[0] == nullptr && sides[1] == nullptr)))
            return this->count("times_dropped", 1);
        if (!is_whole) this->count("times_not_whole", 1);
        pelorus::TracksBuilder builder(this->frame(), space_.space());
        std::map<std::uint64_t, Last> told;
        for (const Pair& pair : pairs_.pair(space_, sides[0], sides[1], this->gate())) {
            const bool is_alone = pair.first < 0 || pair.second < 0;
            if (is_alone && this->alone == Alone::drop) continue;
            const Sighting& one = pair.first >= 0 ? sides[0]->sightings[static_cast<std::size_t>(pair.first)]
                                                  : sides[1]->sightings[static_cast<std::size_t>(pair.second)];
            Last estimate{one.value, one.covariance};
            std::int32_t status = one.status;
            if (!is_alone) {
                const Sighting& other = sides[1]->sightings[static_cast<std::size_t>(pair.second)];
                status = std::min(status == PLR_TRACK_TENTATIVE ? other.status : status,
                                  other.status == PLR_TRACK_TENTATIVE ? status : other.status);
                estimate = fused(meeting.time, one, other, sides[2]);
            }
            tell(builder, pair.id, meeting.time, status, estimate);
            told.emplace(pair.id, std::move(estimate));
        }
        for (const auto& [id, estimate] : living_) {
            if (told.count(id) != 0) continue;
            if (is_whole)
                tell(builder, id, meeting.time, PLR_TRACK_DELETED, estimate);
            else
                told.emplace(id, estimate);  // whose tracker has not told: nothing is known of its end
        }
        living_ = std::move(told);
        this->publish(tracks_out, builder.message(meeting.time));
    }

    /// Of a pair; the first one where the rule does not apply.
    Last fused(std::int64_t time, const Sighting& first, const Sighting& second, const Sight* common) const {
        TrackPair pair{space_, time, piece(first), piece(second), nearest(piece(first), common)};
        Fused out;
        if (this->derived().fuse_tracks(pair, out)) return {out.mean, out.covariance};
        this->count("tracks_not_fused", 1);
        return {first.value, first.covariance};
    }

    std::optional<Piece> nearest(const Piece& track, const Sight* common) const {
        std::optional<Piece> best;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; common != nullptr && i < common->sightings.size(); ++i) {
            int shared = 0;
            Piece each = piece(common->sightings[i]);
            const double apart = distance(space_, track, each, shared);
            if (!(apart < least)) continue;
            least = apart;
            best = std::move(each);
        }
        return best;
    }

    static void tell(pelorus::TracksBuilder& builder, std::uint64_t id, std::int64_t time, std::int32_t status,
                     const Last& estimate) {
        pelorus::TrackEntry entry;
        entry.id = id;
        entry.time = time;
        entry.status = status;
        entry.mean = estimate.mean.data();
        entry.covariance = estimate.covariance.data();
        builder.add(entry);
    }

    int dimension_ = 3;
    Derivatives derivatives_ = Derivatives::velocity;
    CommonSpace space_;

    // State.
    Gathering meetings_;
    TrackPairs pairs_;
    std::map<std::uint64_t, Last> living_;
};

}  // namespace fusion
