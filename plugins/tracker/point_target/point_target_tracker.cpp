#include "point_target_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "starts.hpp"

namespace point_target {

void PointTargetTracker::setup(const pelorus::Setup& setup) {
    if (start_confirm > start_of)
        throw pelorus::ParameterError("start_confirm", "is greater than start_of; no track would ever be confirmed");
    if (misses == Misses::by_time && !silence)
        throw pelorus::ParameterError("silence", "is required with misses: by_time; nothing else would end a track");
    if (start == Start::three_point && start_confirm < 3)
        throw pelorus::ParameterError("start_confirm", "is less than 3, which start: three_point needs");
    if (start == Start::three_point && misses == Misses::by_time)
        throw pelorus::ParameterError("start", "three_point needs scans that show every object (misses: per_scan)");
    models_.setup(setup, gate_probability);
    if (start != Start::one_point) {
        const auto full = [&](const SensorModel& sensor) { return sensor.axes == models_.axes(); };
        if (std::none_of(models_.sensors().begin(), models_.sensors().end(), full))
            throw pelorus::PartError("estimator", "no sensor tells a whole position, which a start from points needs");
        for (int axis = 0; axis < models_.axes(); ++axis)
            if (models_.velocity(axis) < 0)
                throw pelorus::PartError("estimator", "has no velocity on every axis, which a start from points needs");
    }
    if (association == Association::joint) check_joint();
    gating_.setup(maximum_speed);
    tracks_.setup(models_.record_size());
    frame_ = setup.frame();
    message_.emplace(frame_, models_.cartesian());
    diagnostics_ = setup.optional_service<plr_diagnostics>();
    log_ = setup.optional_service<plr_log>();
}

void PointTargetTracker::check_joint() const {
    if (!models_.can_mix())
        throw pelorus::PartError("estimator", "cannot mix hypotheses (it has no extension " PLR_ESTIMATOR_MIX
                                              "), which association: joint needs");
    if (!clutter_density) return;
    const std::vector<SensorModel>& sensors = models_.sensors();
    const pelorus::Space first(*sensors.front().part.info().measurement);
    for (const SensorModel& sensor : sensors)
        if (const pelorus::Space space(*sensor.part.info().measurement); space.text() != first.text())
            throw pelorus::ParameterError("clutter_density",
                                          "sensors " + sensors.front().name + " and " + sensor.name +
                                              " measure different components, so that no one density suits both; "
                                              "left out, it is estimated from each scan");
}

std::vector<pelorus::Stream> PointTargetTracker::in_streams(std::uint32_t port) const {
    std::vector<pelorus::Stream> streams;
    if (port != scans) return streams;
    for (const SensorModel& sensor : models_.sensors()) {
        pelorus::Stream stream;
        stream.sensor = sensor.name;
        stream.any_sensor = sensor.name.empty() && models_.sensors().size() == 1;
        stream.space = pelorus::Space(*sensor.part.info().measurement);
        stream.frame = frame_;
        streams.push_back(std::move(stream));
    }
    return streams;
}

std::vector<pelorus::Stream> PointTargetTracker::out_streams(std::uint32_t port) const {
    if (port == innovations_out) return {};
    pelorus::Stream stream;
    stream.space = models_.cartesian();
    stream.frame = frame_;
    return {stream};
}

void PointTargetTracker::on_values(const pelorus::Event&, const plr_values& values) {
    if (models_.caller().take(values) == 0) throw pelorus::DataError("holds no input of the models in this tracker");
}

void PointTargetTracker::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    scan_time_ = event.time;
    models_.begin(scan_time_, step_ + 1);
    count("refused_measurements", read_scan(models_, scan, scan_time_, detections_));
    ++step_;
    late_ = newest_ && scan_time_ < *newest_;
    outcomes_.assign(tracks_.size(), Outcome{});
    taken_.assign(detections_.size(), 0);
    gating_.run(models_, tracks_, detections_, scan_time_, predicts_all());
    if (association == Association::joint)
        associate_jointly();
    else
        associate_tracks(true);
    associate_tracks(false);
    if (start == Start::three_point) {
        choose_hypotheses();
        branch_points();
    } else {
        associate_points();
    }
    update_tracks();
    start_tracks();
    settle();
    summarise();
    publish_tracks(event.time);
    if (models_.smoothed_times() > 0) publish_smoothed(event.time);
    std::vector<char> marked;
    for (const Outcome& outcome : outcomes_) marked.push_back(outcome.removed ? 1 : 0);
    tracks_.remove(marked);
    newest_ = std::max(newest_.value_or(scan_time_), scan_time_);
}

/// A run without a single confirmed track ends well, but hardly as it was meant to.
void PointTargetTracker::finish(const pelorus::Event&) {
    if (confirmed_ != 0 || log_ == nullptr || PLR_LOG_WARNING < log_->level) return;
    std::string line = "no scan came, so no track was started";
    if (next_id_ != 1)
        line = "no track was confirmed: " + std::to_string(next_id_ - 1) +
               " were started, and none was hit often enough; do motion, noise and maximum_speed fit the data?";
    else if (step_ != 0)
        line =
            "no track was started: none of " + std::to_string(step_) + " scans had a measurement that could start one";
    log_->write(log_->context, PLR_LOG_WARNING, line.c_str());
}

/// Whether tracks without a detection are predicted to the scan's time, too: to count a miss, to be published, or now and then
/// to see how uncertain they have become.
bool PointTargetTracker::predicts_all() {
    if (late_) return false;
    if (misses == Misses::per_scan || publish_which == Publish::all) return true;
    if (!maximum_deviation || (next_sweep_ && scan_time_ < *next_sweep_)) return false;
    next_sweep_ = scan_time_ + nanoseconds(*silence / 20);
    return true;
}

/// Gated pairs of confirmed or of tentative tracks with detections that nobody has taken yet.
std::vector<GatedPair> PointTargetTracker::free_pairs(bool confirmed) const {
    std::vector<GatedPair> pairs;
    for (const GatedPair& pair : gating_.pairs())
        if (tracks_[pair.track].confirmed() == confirmed && taken_[pair.detection] == 0 &&
            !is_hypothesis(tracks_[pair.track]))
            pairs.push_back(pair);
    return pairs;
}

/// Confirmed tracks choose first, so that a track that is a false alarm takes nothing from them.
void PointTargetTracker::associate_tracks(bool confirmed) {
    const std::vector<GatedPair> pairs = free_pairs(confirmed);
    if (pairs.empty()) return;
    for (const std::size_t i : associate(pairs, detections_.sensor->gate)) {
        outcomes_[pairs[i].track] = {pairs[i].detection, pairs[i].prediction, pairs[i].distance, false, false, none};
        taken_[pairs[i].detection] = 1;
    }
}

/// Confirmed tracks share the detections. One that is more probably some confirmed track's than nobody's is taken.
void PointTargetTracker::associate_jointly() {
    joint_.clear();
    const std::vector<GatedPair> pairs = free_pairs(true);
    if (pairs.empty()) return;
    const SensorModel& sensor = *detections_.sensor;
    assignment::DetectionModel model{detection_probability, gate_probability, 0};
    model.clutter_density = clutter_density
                                ? *clutter_density
                                : estimated_clutter_density(pairs, sensor, detection_probability, gate_probability);
    std::vector<assignment::LikelihoodRatio> ratios;
    for (const GatedPair& pair : pairs)
        ratios.push_back({pair.track, pair.detection,
                          assignment::log_detection_ratio(pair.distance, pair.log_determinant, sensor.m, model)});
    const assignment::JointWeights weights = assignment::associate_jointly(ratios, tracks_.size(), most_joint_events);
    count("dropped_pairs", weights.dropped);
    count("numeric_failures", joint_.run(models_, gating_, detections_, pairs, weights, tracks_));
    std::vector<double> owned(detections_.size(), 0.0);
    for (std::size_t k = 0; k < joint_.tracks().size(); ++k) {
        const MixedTrack& mixed = joint_.tracks()[k];
        Outcome& outcome = outcomes_[mixed.track];
        outcome.mixture = k;
        for (const Share& share : mixed.shares) owned[share.detection] += share.weight;
        if (!mixed.seen()) continue;
        outcome.detection = mixed.likeliest().detection;
        outcome.distance = mixed.likeliest().distance;
    }
    for (std::size_t j = 0; j < owned.size(); ++j) taken_[j] = owned[j] > 0.5 ? 1 : 0;
}

/// The time that the record of an updated track stands at.
std::int64_t PointTargetTracker::record_time(const Outcome& outcome) const {
    return outcome.mixture != none ? joint_.tracks()[outcome.mixture].time : detections_.times[outcome.detection];
}

/// Single points with the detections within reach of them that nobody has taken yet.
std::vector<GatedPair> PointTargetTracker::free_point_pairs() const {
    std::vector<GatedPair> pairs;
    if (detections_.size() == 0 || detections_.sensor->axes != models_.axes()) return pairs;
    for (const GatedPair& pair : gating_.point_pairs())
        if (taken_[pair.detection] == 0 && !outcomes_[pair.track].removed) pairs.push_back(pair);
    return pairs;
}

/// Single points find their second one among the detections that are left.
void PointTargetTracker::associate_points() {
    const std::vector<GatedPair> pairs = free_point_pairs();
    if (pairs.empty()) return;
    double widest = 0;  // the reach is the gate
    for (const GatedPair& pair : pairs) widest = std::max(widest, pair.distance);
    std::vector<TwoPoints> chosen;
    std::vector<std::size_t> tracks;
    for (const std::size_t i : associate(pairs, widest)) {
        taken_[pairs[i].detection] = 1;
        chosen.push_back({&tracks_[pairs[i].track], pairs[i].detection});
        tracks.push_back(pairs[i].track);
    }
    std::vector<double> records;
    Failures failed;
    start_from_two(models_, detections_, chosen, records, failed);
    const std::size_t size = models_.record_size();
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        Outcome& outcome = outcomes_[tracks[i]];
        if (failed[i] != 0) {
            count("numeric_failures", 1);
            outcome.removed = true;
            continue;
        }
        std::copy(records.data() + i * size, records.data() + (i + 1) * size, tracks_.record(tracks[i]));
        tracks_[tracks[i]].has_record = true;
        outcome.detection = chosen[i].second;
    }
}

void PointTargetTracker::update_tracks() {
    std::vector<std::size_t> tracks;
    std::vector<std::uint64_t> ids;
    std::vector<double> records, measurements, noises;
    const std::size_t size = models_.record_size();
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        const Outcome& outcome = outcomes_[t];
        if (!outcome.hit() || outcome.prediction == none) continue;
        tracks.push_back(t);
        ids.push_back(tracks_[t].id);
        const double* record = gating_.predicted(outcome.prediction);
        const double* z = detections_.measurement_of(outcome.detection);
        const double* r = detections_.noise_of(outcome.detection);
        const std::size_t m = detections_.m();
        records.insert(records.end(), record, record + size);
        measurements.insert(measurements.end(), z, z + m);
        noises.insert(noises.end(), r, r + m * m);
    }
    if (tracks.empty()) return;
    Failures failed;
    models_.update(*detections_.sensor, tracks.size(), ids.data(), measurements.data(), noises.data(), records.data(),
                   failed);
    if (models_.takes_late()) bring_forward(tracks, records, failed);
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        if (failed[i] == 0) {
            std::copy(records.data() + i * size, records.data() + (i + 1) * size, tracks_.record(tracks[i]));
        } else {  // as if it had not been seen
            outcomes_[tracks[i]] = Outcome{};
            count("numeric_failures", 1);
        }
    }
}

/// Tracks that took a measurement older than themselves go back to where they were.
void PointTargetTracker::bring_forward(const std::vector<std::size_t>& tracks, std::vector<double>& records,
                                       Failures& failed) {
    std::vector<std::size_t> late;
    std::vector<std::uint64_t> ids;
    std::vector<double> steps, moving;
    const std::size_t size = models_.record_size();
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        const Track& track = tracks_[tracks[i]];
        const std::int64_t time = detections_.times[outcomes_[tracks[i]].detection];
        if (failed[i] != 0 || time >= track.time) continue;
        late.push_back(i);
        ids.push_back(track.id);
        steps.push_back(static_cast<double>(track.time - time) * 1e-9);
        moving.insert(moving.end(), records.data() + i * size, records.data() + (i + 1) * size);
    }
    if (late.empty()) return;
    Failures lost;
    models_.predict(late.size(), ids.data(), steps.data(), moving.data(), lost);
    std::size_t used = 0;
    for (std::size_t k = 0; k < late.size(); ++k) {
        failed[late[k]] = lost[k];
        used += lost[k] == 0 ? 1 : 0;
        std::copy(moving.data() + k * size, moving.data() + (k + 1) * size, records.data() + late[k] * size);
    }
    count("late_measurements_used", used);
}

/// Every detection that nobody has taken begins a track, unless it comes too late to tell of a new object.
void PointTargetTracker::start_tracks() {
    std::vector<std::size_t> starting;
    std::vector<std::uint64_t> ids;
    std::size_t too_late = 0;
    for (std::size_t j = 0; j < detections_.size(); ++j) {
        if (taken_[j] != 0) continue;
        if (newest_ && detections_.times[j] < *newest_) {
            ++too_late;
        } else if (start == Start::one_point ? detections_.sensor->locates()
                                             : detections_.sensor->axes == models_.axes()) {
            starting.push_back(j);
            ids.push_back(next_id_ + ids.size());
        }
    }
    count("late_measurements", too_late);
    if (starting.empty()) return;
    if (start != Start::one_point) {
        for (const std::size_t j : starting) add_track(j, nullptr);
        return;
    }
    std::vector<double> records;
    Failures failed;
    start_from_one(models_, detections_, starting, ids, records, failed);
    for (std::size_t i = 0; i < starting.size(); ++i)
        if (failed[i] == 0)
            add_track(starting[i], records.data() + i * models_.record_size());
        else
            count("numeric_failures", 1);
}

void PointTargetTracker::add_track(std::size_t detection, const double* record) {
    Track track;
    track.id = next_id_++;
    track.has_record = record != nullptr;
    track.time = track.seen = detections_.times[detection];
    track.place = detections_.places[detection];
    track.deviation = detections_.deviations[detection];
    if (record == nullptr) track.covariance = place_covariance(detections_, detection);
    track.begun = {detections_.ids[detection], 0};
    track.hits = track.scans = 0;  // settle() counts this scan
    tracks_.add(track, record);
    outcomes_.push_back({detection, none, 0, false, false, none});
    count("tracks_started", 1);
}

/// Means and covariances of all tracks that were updated or are to be published; those that have become too uncertain end.
void PointTargetTracker::summarise() {
    wanted_.clear();
    std::vector<std::uint64_t> ids;
    std::vector<double> records;
    const std::size_t size = models_.record_size();
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        const Track& track = tracks_[t];
        const Outcome& outcome = outcomes_[t];
        const bool mixed = outcome.mixture != none;
        const std::size_t ahead =
            !outcome.hit() && !mixed && !outcome.removed && track.time < scan_time_ ? gating_.at_scan_time(t) : none;
        const bool judged = maximum_deviation && !outcome.hit() && (ahead != none || mixed || track.time == scan_time_);
        if (!track.has_record || !(outcome.hit() || is_published(t) || judged)) continue;
        const double* record = ahead == none ? tracks_.record(t) : gating_.predicted(ahead);
        wanted_.push_back({t, ahead == none ? track.time : scan_time_});
        ids.push_back(track.id);
        records.insert(records.end(), record, record + size);
    }
    const std::size_t n = wanted_.size(), c = static_cast<std::size_t>(models_.cartesian().size());
    means_.resize(n * c);
    covariances_.resize(n * c * c);
    if (n == 0) return;
    Failures failed;
    models_.summary(n, ids.data(), records.data(), means_.data(), covariances_.data(), failed);
    for (std::size_t i = 0; i < n; ++i) {
        if (failed[i] != 0) throw pelorus::NumericError(models_.caller().explain("summary"));
        remember(wanted_[i].track, means_.data() + i * c, covariances_.data() + i * c * c);
    }
}

void PointTargetTracker::remember(std::size_t t, const double* mean, const double* covariance) {
    Track& track = tracks_[t];
    const auto c = static_cast<std::size_t>(models_.cartesian().size());
    double trace = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(models_.axes()); ++a) trace += covariance[a * c + a];
    const double deviation = std::sqrt(trace);
    if (outcomes_[t].hit()) {
        std::copy(mean, mean + models_.axes(), track.place.begin());
        track.deviation = deviation;
    } else if (maximum_deviation && deviation > *maximum_deviation) {
        outcomes_[t].removed = true;
    }
}

void PointTargetTracker::count(const char* name, std::size_t by) const {
    if (diagnostics_ != nullptr && by > 0)
        diagnostics_->count(diagnostics_->context, name, static_cast<std::int64_t>(by));
}

}  // namespace point_target
