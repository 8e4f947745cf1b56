// What a scan means for the status of tracks.
#include "point_target_tracker.hpp"

namespace point_target {

/// Counts hits and misses, confirms and ends.
void PointTargetTracker::settle() {
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        Track& track = tracks_[t];
        Outcome& outcome = outcomes_[t];
        if (counts_scans()) ++track.scans;
        if (outcome.hit()) {
            ++track.hits;
            const std::int64_t time = record_time(outcome);
            const bool is_news = time >= track.seen;  // else it is from before a miss
            if (is_news) track.misses = 0;
            outcome.moved = time > track.time;
            track.time = std::max(track.time, time);
            track.seen = std::max(track.seen, time);
            const std::int32_t before = track.status;
            if (track.confirmed() ? is_news : track.hits >= start_confirm && track.has_record)
                track.status = PLR_TRACK_CONFIRMED;
            outcome.changed = track.status != before;
            if (before == PLR_TRACK_TENTATIVE && track.confirmed()) ++confirmed_;
        } else {
            settle_miss(t);
        }
        outcome.removed = outcome.removed || has_ended(track);
    }
}

void PointTargetTracker::settle_miss(std::size_t t) {
    Track& track = tracks_[t];
    Outcome& outcome = outcomes_[t];
    if (gating_.failed(t)) {
        count("numeric_failures", 1);
        outcome.removed = true;
        return;
    }
    if (outcome.mixture != none) track.time = record_time(outcome);
    if (!counts_scans()) return;
    ++track.misses;
    if (track.status == PLR_TRACK_CONFIRMED) {
        track.status = PLR_TRACK_COASTING;
        outcome.changed = true;
    }
    const std::size_t prediction = gating_.at_scan_time(t);
    if (prediction == none || outcome.mixture != none) return;
    const double* record = gating_.predicted(prediction);
    std::copy(record, record + models_.record_size(), tracks_.record(t));
    outcome.moved = scan_time_ > track.time;
    track.time = scan_time_;
}

bool PointTargetTracker::has_ended(const Track& track) const {
    if (silence && scan_time_ - track.seen > nanoseconds(*silence)) return true;
    if (!counts_scans()) return false;
    if (track.confirmed()) return track.misses >= misses_to_delete;
    return track.hits + start_of - track.scans < start_confirm;
}

}  // namespace point_target
