// What the tracker tells after a scan.
#include "point_target_tracker.hpp"

namespace point_target {

bool PointTargetTracker::is_published(std::size_t t) const {
    const Track& track = tracks_[t];
    const Outcome& outcome = outcomes_[t];
    if (!track.has_record) return false;
    if (outcome.removed) return track.told;
    if (!track.confirmed() && tentative == Tentative::hide) return false;
    return outcome.hit() || outcome.changed || (publish_which == Publish::all && !late_);
}

void PointTargetTracker::publish_tracks(std::int64_t time) {
    message_->clear();
    innovations_.clear();
    weights_.clear();
    const auto c = static_cast<std::size_t>(models_.cartesian().size());
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
        const std::size_t t = wanted_[i].track;
        if (!is_published(t)) continue;
        Track& track = tracks_[t];
        const Outcome& outcome = outcomes_[t];
        pelorus::TrackEntry entry;
        entry.id = track.id;
        entry.time = wanted_[i].time;
        entry.status = outcome.removed                       ? std::int32_t{PLR_TRACK_DELETED}
                       : track.confirmed() && !outcome.hit() ? std::int32_t{PLR_TRACK_COASTING}
                                                             : track.status;
        entry.misses = track.misses;
        entry.mean = means_.data() + i * c;
        entry.covariance = covariances_.data() + i * c * c;
        tell_measurements(outcome, track.id, entry);
        message_->add(entry);
        track.told = true;
    }
    plr_message told = message_->message(time);
    plr_tracks tracks = *told.body.tracks;
    if (association == Association::joint) tracks.measurement_weights = weights_.data();
    told.body.tracks = &tracks;
    publish(tracks_out, told);
    if (innovations_.count() > 0) publish(innovations_out, innovations_.message(time));
}

/// What starts a track was predicted by nothing, so that it has no innovation.
void PointTargetTracker::tell_measurements(const Outcome& outcome, std::uint64_t id, pelorus::TrackEntry& entry) {
    const bool mixed = outcome.mixture != none;
    if (outcome.hit() && (mixed || outcome.prediction != none))
        innovations_.add(id, outcome.distance, detections_.sensor->m);
    const auto tell = [&](const Share& share) {
        entry.measurements.push_back(detections_.ids[share.detection]);
        entry.distances.push_back(share.distance);
        weights_.push_back(share.weight);
    };
    if (mixed)
        for (const Share& share : joint_.tracks()[outcome.mixture].shares) tell(share);
    else if (outcome.hit())
        tell({outcome.detection, outcome.distance, 1});
}

/// How tracks were, as far back as the estimator tells: of each that has moved on and is that old.
void PointTargetTracker::publish_smoothed(std::int64_t time) {
    const std::size_t size = models_.record_size(), most = models_.smoothed_times();
    const auto c = static_cast<std::size_t>(models_.cartesian().size());
    std::vector<std::size_t> tracks;
    std::vector<std::uint64_t> ids;
    std::vector<double> records;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        const Track& track = tracks_[t];
        if (!outcomes_[t].moved || outcomes_[t].removed || !track.has_record || !track.confirmed()) continue;
        tracks.push_back(t);
        ids.push_back(track.id);
        records.insert(records.end(), tracks_.record(t), tracks_.record(t) + size);
    }
    const std::size_t n = tracks.size();
    if (n == 0) return;
    std::vector<double> known(n), ages(n * most), means(n * most * c), covariances(n * most * c * c);
    Failures failed;
    models_.smoothed(n, ids.data(), records.data(), known.data(), ages.data(), means.data(), covariances.data(),
                     failed);
    message_->clear();
    std::size_t told = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (failed[i] != 0 || known[i] < static_cast<double>(most)) continue;
        const std::size_t oldest = i * most + most - 1;
        pelorus::TrackEntry entry;
        entry.id = ids[i];
        entry.time = tracks_[tracks[i]].time - nanoseconds(ages[oldest]);
        entry.status = PLR_TRACK_CONFIRMED;
        entry.mean = means.data() + oldest * c;
        entry.covariance = covariances.data() + oldest * c * c;
        message_->add(entry);
        ++told;
    }
    if (told > 0) publish(smoothed_out, message_->message(time));
}

}  // namespace point_target
