/// The stage under test, with tracks that a test makes by hand.
#pragma once

#include "../../../tests/fixtures/stage_bench.hpp"
#include "track_then_group_tracker.hpp"

namespace track_then_group {

constexpr std::int64_t second = 1'000'000'000;

/// One entry of a published message.
struct Entry {
    std::uint64_t id;
    std::int32_t status;
    std::uint64_t group;
    Ids parents, measurements;
    std::vector<double> mean, covariance, extent;
};

/// A track in the plane: position and velocity, variances 4 m^2 and 1 m^2/s^2.
struct TrackAt {
    std::uint64_t id;
    double x, y, vx = 0, vy = 0;
    std::int32_t status = PLR_TRACK_CONFIRMED;
    double age = 0;  ///< of the entry at the message's time, s
    Ids parents = {}, measurements = {};
};

struct GroupingRig {
    pelorus::test::Bench bench;
    pelorus::test::StageUnderTest tracker;

    explicit GroupingRig(const std::string& with)
        : tracker(bench, pelorus::test::plugin_of<TrackThenGroupTracker>("tracker.track_then_group"), with) {}

    struct Answer {
        std::vector<Entry> tracks, groups;
        /// Ids of the groups that the tracks are in.
        Ids track_groups() const {
            Ids ids;
            for (const Entry& entry : tracks) ids.push_back(entry.group);
            return ids;
        }
    };
    Answer send(double time, const std::vector<TrackAt>& tracks) {
        pelorus::TracksBuilder builder("", pelorus::kinematic_space(2, {100.0, 10.0}));
        const std::int64_t now = std::llround(time * 1e9);
        const double covariance[16] = {4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        for (const TrackAt& track : tracks) {
            const double mean[4] = {track.x, track.y, track.vx, track.vy};
            builder.add({track.id,
                         now - std::llround(track.age * 1e9),
                         track.status,
                         0,
                         mean,
                         covariance,
                         nullptr,
                         track.parents,
                         0,
                         track.measurements,
                         {}});
        }
        return send(builder.message(now));
    }
    Answer send(const plr_message& message) {
        bench.published.clear();
        tracker.receive(TrackThenGroupTracker::tracks_in, message);
        Answer answer;
        for (const pelorus::test::Published& published : bench.published)
            (published.port == TrackThenGroupTracker::tracks_out ? answer.tracks : answer.groups) =
                entries_of(published.tracks());
        return answer;
    }

    static std::vector<Entry> entries_of(const plr_tracks& tracks) {
        const auto list = [](const std::int64_t* offsets, const std::uint64_t* ids, std::int64_t i) {
            return offsets == nullptr ? Ids{} : Ids(ids + offsets[i], ids + offsets[i + 1]);
        };
        const auto numbers = [](const plr_const_view& view, std::int64_t i) {
            std::vector<double> out;
            if (view.data == nullptr) return out;
            const auto matrix = pelorus::item(view, i);
            for (std::int64_t c = 0; c < view.cols; ++c)
                for (std::int64_t r = 0; r < view.rows; ++r) out.push_back(matrix(r, c));
            return out;
        };
        std::vector<Entry> entries;
        for (std::int64_t i = 0; i < tracks.count; ++i)
            entries.push_back({tracks.ids[i], tracks.status[i], tracks.groups == nullptr ? 0 : tracks.groups[i],
                               list(tracks.parent_offsets, tracks.parents, i),
                               list(tracks.measurement_offsets, tracks.measurements, i), numbers(tracks.mean, i),
                               numbers(tracks.covariance, i), numbers(tracks.extent, i)});
        return entries;
    }
};

}  // namespace track_then_group
