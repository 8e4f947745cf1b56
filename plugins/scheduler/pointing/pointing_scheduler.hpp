/// scheduler.pointing: points a narrow sensor at what a track predicts. See README.md.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/stage.hpp>

#include "../../common/one_track/filter.hpp"
#include "../../common/sensing/direction.hpp"
#include "lock.hpp"
#include "search_pattern.hpp"

namespace pointing_scheduler {

enum class Policy { first, worst };

class PointingScheduler : public pelorus::Stage<PointingScheduler>, public Rules {
public:
    static constexpr const char* kind = "scheduler";
    enum InPort : std::uint32_t { tracks_in, scans_in, pointing_in };
    enum OutPort : std::uint32_t { commands_out, results_out };

    static void describe(pelorus::Describe<PointingScheduler>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;

    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks);
    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void on_values(const pelorus::Event& event, const plr_values& values);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        archive(lock_, target_, track_time_, record_, last_look_, spacing_, seen_at_, commanded_, filter_.caller,
                looks_, locks_, counts_);
        if constexpr (Archive::reading)
            if (looks_.size() % look_columns != 0 || locks_.size() % lock_columns != 0 ||
                (target_ && record_.size() != filter_.record_size()))
                throw pelorus::DataError("saved state is of another scheduler");
    }

private:
    static constexpr std::size_t look_columns = 9, lock_columns = 4;

    /// Where the target is predicted to be, as the sensor sees it.
    struct Prediction {
        one_track::At at;
        one_track::Record record;
        one_track::Projection projection;
        sensing::Direction direction;
        pelorus::Matrix<2> spread = pelorus::Matrix<2>::Zero();  ///< to the left and up, rad^2
    };

    struct Counts {
        std::int64_t looks = 0, locked = 0, losses = 0;
        std::optional<std::int64_t> first_lock;  // ns
        template <class Archive> void state(Archive& archive) { archive(looks, locked, losses, first_lock); }
    };

    /// From a look to the next (ns), or 0 where nothing is known of it.
    std::int64_t step() const { return period_ ? std::llround(*period_ * 1e9) : spacing_.value_or(0); }
    bool in_plane() const noexcept { return elevation_ < 0 && zenith_ < 0; }
    void find_sensor();
    void find_angles();
    void follow(const plr_tracks& tracks, std::int64_t entry);
    std::int64_t entry_of_target(const plr_tracks& tracks) const;
    std::int64_t chosen_entry(const plr_tracks& tracks) const;
    void drop_target(std::int64_t time);
    /// At `time`, or, where the track is newer than that, at its own.
    Prediction predicted(std::int64_t time);
    std::vector<Place> pattern(const Prediction& prediction) const;
    bool is_hit(const Prediction& prediction, const plr_scan& scan);
    /// Where the sensor looked at `time`, if it is told.
    std::optional<sensing::Direction> looked_at(std::int64_t time) const;
    void note_look(std::int64_t time, const Prediction& prediction, bool hit);
    void note_lock(State before, std::int64_t time);
    void command(std::int64_t arrival, std::int64_t stamp);

    std::optional<std::string> sensor_name_;
    std::optional<double> period_;  // s
    std::vector<double> field_of_view_;
    double sigmas_ = 3, gate_ = 5, misalignment_ = 0;  // deviations, deviations, rad
    double table_period_ = 0;                          // s
    Policy policy_ = Policy::first;

    one_track::Filter filter_;
    std::vector<int> positions_;  ///< components of a track that are positions
    Field field_;
    int sensor_ = 0;
    int azimuth_ = -1, elevation_ = -1, zenith_ = -1;  ///< places in the sensor's measurement
    std::string frame_;
    plr_key key_{};

    // What save keeps.
    Lock lock_;
    std::optional<std::uint64_t> target_;  ///< id of the track
    std::int64_t track_time_ = 0;          ///< ns, of the record
    one_track::Record record_;
    std::optional<std::int64_t> last_look_, spacing_;                   ///< ns
    std::vector<std::pair<std::int64_t, sensing::Direction>> seen_at_;  ///< the newest pointings told
    std::optional<sensing::Direction> commanded_;                       ///< last
    std::vector<double> looks_, locks_;                                 ///< rows of the tables
    Counts counts_;
};

}  // namespace pointing_scheduler
