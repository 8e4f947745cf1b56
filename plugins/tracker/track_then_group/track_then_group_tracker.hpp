/// tracker.track_then_group: groups of the tracks of any tracker. See README.md.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/stage.hpp>

#include "lineage.hpp"
#include "links.hpp"

namespace track_then_group {

/// Where positions and velocities stand in the space of the tracks.
struct Layout {
    std::vector<int> position, velocity;  ///< one an axis; no velocity where it is not told on every axis
};

/// What is known of a track: its newest entry.
struct Held {
    std::int64_t time = 0;  ///< ns
    std::int32_t status = 0, misses = 0;
    std::vector<double> mean, covariance;
    bool moves = false;       ///< fast enough to be grouped
    std::uint64_t group = 0;  ///< 0: none
    template <class Archive> void state(Archive& archive) {
        archive(time, status, misses, mean, covariance, moves, group);
    }
};

/// A group as it was told last.
struct Told {
    std::vector<double> mean, covariance, extent;
    Ids parents, members;
    template <class Archive> void state(Archive& archive) { archive(mean, covariance, extent, parents, members); }
};

class TrackThenGroupTracker : public pelorus::Stage<TrackThenGroupTracker> {
public:
    static constexpr const char* kind = "tracker";
    enum InPort : std::uint32_t { tracks_in };
    enum OutPort : std::uint32_t { tracks_out, groups_out };

    static void describe(pelorus::Describe<TrackThenGroupTracker>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;
    std::uint32_t passes_on(std::uint32_t) const { return 1 + tracks_in; }

    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks);

    template <class Archive> void state(Archive& archive) { archive(held_, told_, links_, lineage_, newest_); }

private:
    bool needs_velocity() const noexcept { return velocity_threshold_ || minimum_speed_; }
    void take(const plr_tracks& tracks, const Layout& layout);
    bool is_moving(const Held& held, const Layout& layout) const;
    std::vector<Member> members_at(std::int64_t time, const Layout& layout) const;
    void group_tracks(std::int64_t time, const Layout& layout);
    void publish_tracks(std::int64_t time, const plr_tracks& tracks);
    void publish_groups(std::int64_t time, const plr_tracks& tracks, const Layout& layout);
    std::map<std::uint64_t, Ids> members_of_groups() const;
    std::map<std::uint64_t, Ids> measurements_of_groups(const plr_tracks& tracks) const;
    pelorus::TrackEntry entry_of(std::uint64_t id, std::int64_t time) const;
    void set_status(const Ids& members, pelorus::TrackEntry& entry) const;
    Told moments_of(const Ids& members, std::int64_t time, const Layout& layout) const;

    // parameters
    double threshold_ = 0, hysteresis_ = 0;                     // m, -
    std::optional<double> velocity_threshold_, minimum_speed_;  // m/s
    double persistence_ = 0;                                    // s
    std::optional<double> memory_;                              // s
    double member_radius_ = 0;                                  // m

    std::string frame_;

    // state
    std::map<std::uint64_t, Held> held_;
    std::map<std::uint64_t, Told> told_;  // groups that have not ended
    Links links_;
    Lineage lineage_;
    std::optional<std::int64_t> newest_;  // ns
};

}  // namespace track_then_group
