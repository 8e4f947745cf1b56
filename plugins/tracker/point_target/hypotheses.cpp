// Tracks that begin with three points: all pairs of points within reach are tried, and a third one decides.
#include <algorithm>
#include <tuple>

#include "point_target_tracker.hpp"
#include "starts.hpp"

namespace point_target {

/// Two points that wait for a third one; others may have the same points.
bool PointTargetTracker::is_hypothesis(const Track& track) const {
    return start == Start::three_point && track.has_record && track.hits < 3;
}

/// Third points, nearest first; a measurement serves one track only, as first, second or third.
void PointTargetTracker::choose_hypotheses() {
    std::vector<GatedPair> pairs;
    for (const GatedPair& pair : gating_.pairs())
        if (taken_[pair.detection] == 0 && is_hypothesis(tracks_[pair.track])) pairs.push_back(pair);
    std::sort(pairs.begin(), pairs.end(), [](const GatedPair& a, const GatedPair& b) {
        return std::tie(a.distance, a.track, a.detection) < std::tie(b.distance, b.track, b.detection);
    });
    std::set<std::uint64_t> used;
    for (const GatedPair& pair : pairs) {
        const auto& begun = tracks_[pair.track].begun;
        if (taken_[pair.detection] != 0 || used.count(begun[0]) != 0 || used.count(begun[1]) != 0) continue;
        outcomes_[pair.track] = {pair.detection, pair.prediction, pair.distance, false, false, none};
        taken_[pair.detection] = 1;
        used.insert(begun.begin(), begun.end());
    }
    drop_rivals(used);
}

/// Ends what waits for measurements that have gone to others.
void PointTargetTracker::drop_rivals(const std::set<std::uint64_t>& used) {
    if (used.empty()) return;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        const Track& track = tracks_[t];
        if (outcomes_[t].hit() || (track.has_record && !is_hypothesis(track))) continue;
        if (used.count(track.begun[0]) != 0 || (track.has_record && used.count(track.begun[1]) != 0))
            outcomes_[t].removed = true;
    }
}

/// Each point with each detection within reach, which goes on waiting for itself, too.
void PointTargetTracker::branch_points() {
    const std::vector<GatedPair> pairs = free_point_pairs();
    if (pairs.empty()) return;
    std::vector<TwoPoints> chosen;
    for (const GatedPair& pair : pairs) chosen.push_back({&tracks_[pair.track], pair.detection});
    std::vector<double> records;
    Failures failed;
    start_from_two(models_, detections_, chosen, records, failed);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (failed[i] != 0) {
            count("numeric_failures", 1);
            continue;
        }
        Track track = tracks_[pairs[i].track];
        track.id = next_id_++;
        track.has_record = true;
        track.begun[1] = detections_.ids[pairs[i].detection];
        tracks_.add(track, records.data() + i * models_.record_size());
        outcomes_.push_back({pairs[i].detection, none, 0, false, false, none});
    }
}

}  // namespace point_target
