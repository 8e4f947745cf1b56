#include "gating.hpp"

#include <algorithm>
#include <cmath>

#include <pelorus/small_matrix.hpp>

namespace point_target {

namespace {

constexpr double nanosecond = 1e-9;
/// Share of the greatest speed that is the deviation of a speed of which nothing is known but that.
constexpr double speed_deviation = 1.0 / 3;

template <int Most> using Square = pelorus::small::Bounded<Most, Most>;
template <int Most> using Column = pelorus::small::Bounded<Most, 1>;

/// Squared distance and log determinant; false where S is not positive definite.
template <int Most> bool measure(const Square<Most>& s, const Column<Most>& e, GatedPair& pair) {
    Square<Most> root(s.rows(), s.cols());
    if (!pelorus::small::cholesky(s, root)) return false;
    pair.distance = pelorus::small::inverse_quadratic(root, e);
    pair.log_determinant = pelorus::small::log_determinant(root);
    return std::isfinite(pair.distance);
}

}  // namespace

std::array<double, 9> place_covariance(const Detections& detections, std::size_t detection) {
    const SensorModel& sensor = *detections.sensor;
    std::array<double, 9> out{};
    const std::size_t k = detections.k();
    const double* covariance = detections.covariance_of(detection);
    // Components are in the order of the Cartesian space, which has positions first.
    const auto axes = static_cast<std::size_t>(sensor.axes);
    for (std::size_t b = 0; b < axes; ++b)
        for (std::size_t a = 0; a < axes; ++a) out[b * axes + a] = covariance[b * k + a];
    return out;
}

void Gating::run(Models& models, TrackStore& tracks, const Detections& detections, std::int64_t scan_time, bool all) {
    record_size_ = models.record_size();
    takes_late_ = models.takes_late();
    failed_.assign(tracks.size(), 0);
    find_candidates(tracks, detections);
    list_predictions(tracks, detections, scan_time, all);
    predict(models, tracks);
    measure_distances(models, tracks, detections);
    measure_point_distances(tracks, detections);
}

/// How far from where it was last seen an object can be detected at that time, errors included, m.
double Gating::reach(const Track& track, const SensorModel& sensor, std::int64_t time, double deviation) const {
    // The place is that of the record's time where a measurement came late.
    const std::int64_t apart = std::max(std::abs(time - track.seen), time < track.time ? track.time - time : 0);
    const double elapsed = static_cast<double>(apart) * nanosecond;
    return maximum_speed_ * elapsed + std::sqrt(sensor.gate) * (track.deviation + deviation);
}

/// Whether the track can take a measurement of that time.
bool Gating::comes_in_time(const Track& track, std::int64_t time) const {
    if (!track.has_record) return time > track.seen;
    return takes_late_ || time >= track.time;
}

bool Gating::within_reach(const Track& track, const Detections& detections, std::size_t detection) const {
    const std::int64_t time = detections.times[detection];
    if (!comes_in_time(track, time)) return false;
    const SensorModel& sensor = *detections.sensor;
    double squares = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        if (sensor.axis[a] < 0) continue;
        const double difference = detections.places[detection][a] - track.place[a];
        squares += difference * difference;
    }
    const double limit = reach(track, sensor, time, detections.deviations[detection]);
    return squares <= limit * limit;
}

void Gating::find_candidates(const TrackStore& tracks, const Detections& detections) {
    candidates_.clear();
    point_candidates_.clear();
    if (detections.size() == 0) return;
    const SensorModel& sensor = *detections.sensor;
    if (sensor.locates()) grid_.build(detections.places, sensor.axis[0] < 0 ? 0 : sensor.axis[1] < 0 ? 1 : 2);
    const auto [first, last] = std::minmax_element(detections.times.begin(), detections.times.end());
    const std::int64_t earliest = *first, latest = *last;
    const double widest =
        sensor.locates() ? *std::max_element(detections.deviations.begin(), detections.deviations.end()) : 0.0;
    std::vector<std::size_t> near;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
        const Track& track = tracks[t];
        near.clear();
        if (sensor.locates()) {
            if (!comes_in_time(track, latest)) continue;
            const double farthest = std::max(reach(track, sensor, latest, widest),
                                             takes_late_ ? reach(track, sensor, earliest, widest) : 0.0);
            grid_.near(track.place, farthest, [&](std::size_t j) {
                if (within_reach(track, detections, j)) near.push_back(j);
            });
        } else if (track.has_record) {
            for (std::size_t j = 0; j < detections.size(); ++j)
                if (comes_in_time(track, detections.times[j])) near.push_back(j);
        }
        std::sort(near.begin(), near.end());
        for (const std::size_t j : near) (track.has_record ? candidates_ : point_candidates_).push_back({t, j, none});
    }
}

void Gating::list_predictions(const TrackStore& tracks, const Detections& detections, std::int64_t scan_time,
                              bool all) {
    predictions_.clear();
    at_scan_time_.assign(tracks.size(), none);
    std::size_t first = 0;  // of the predictions of the track at hand
    for (Candidate& candidate : candidates_) {
        const std::int64_t time = detections.times[candidate.detection];
        if (predictions_.empty() || predictions_.back().track != candidate.track) first = predictions_.size();
        std::size_t found = first;
        while (found < predictions_.size() && predictions_[found].time != time) ++found;
        if (found == predictions_.size()) predictions_.push_back({candidate.track, time});
        candidate.prediction = found;
        if (time == scan_time) at_scan_time_[candidate.track] = found;
    }
    gated_ = predictions_.size();
    for (std::size_t t = 0; all && t < tracks.size(); ++t) {
        if (!tracks[t].has_record || at_scan_time_[t] != none || tracks[t].time > scan_time) continue;
        at_scan_time_[t] = predictions_.size();
        predictions_.push_back({t, scan_time});
    }
}

void Gating::predict(Models& models, TrackStore& tracks) {
    const std::size_t n = predictions_.size();
    records_.resize(n * record_size_);
    std::vector<std::uint64_t> ids(n);
    std::vector<double> dt(n);
    for (std::size_t p = 0; p < n; ++p) {
        const std::size_t t = predictions_[p].track;
        ids[p] = tracks[t].id;
        dt[p] = static_cast<double>(predictions_[p].time - tracks[t].time) * nanosecond;
        std::copy(tracks.record(t), tracks.record(t) + record_size_, records_.data() + p * record_size_);
    }
    if (n == 0) return;
    models.predict(n, ids.data(), dt.data(), records_.data(), unpredicted_);
    // What came too late for a track is no fault of it.
    for (std::size_t p = 0; p < n; ++p)
        if (unpredicted_[p] != 0 && dt[p] >= 0) failed_[predictions_[p].track] = 1;
}

void Gating::measure_distances(Models& models, const TrackStore& tracks, const Detections& detections) {
    pairs_.clear();
    if (candidates_.empty()) return;
    const SensorModel& sensor = *detections.sensor;
    const std::size_t m = detections.m(), n = candidates_.size();
    std::vector<std::uint64_t> ids(gated_);
    for (std::size_t p = 0; p < gated_; ++p) ids[p] = tracks[predictions_[p].track].id;
    std::vector<double> projected(gated_ * m), spread(gated_ * m * m);
    Failures unprojected, unmeasured;
    models.project(sensor, gated_, ids.data(), records_.data(), projected.data(), spread.data(), unprojected);
    std::vector<double> measured(n * m), reference(n * m), difference(n * m);
    for (std::size_t i = 0; i < n; ++i) {
        const double* z = detections.measurement_of(candidates_[i].detection);
        const double* prediction = projected.data() + candidates_[i].prediction * m;
        std::copy(z, z + m, measured.data() + i * m);
        std::copy(prediction, prediction + m, reference.data() + i * m);
    }
    models.residual(sensor, n, measured.data(), reference.data(), difference.data(), unmeasured);
    const auto size = static_cast<Eigen::Index>(m);
    Square<most_measured> s(size, size);
    Column<most_measured> e(size, 1);
    for (std::size_t i = 0; i < n; ++i) {
        const Candidate& candidate = candidates_[i];
        if (unprojected[candidate.prediction] != 0 || unpredicted_[candidate.prediction] != 0 || unmeasured[i] != 0 ||
            failed_[candidate.track] != 0)
            continue;
        const double* p = spread.data() + candidate.prediction * m * m;
        const double* r = detections.noise_of(candidate.detection);
        for (std::size_t k = 0; k < m * m; ++k) s.data()[k] = p[k] + r[k];
        std::copy(difference.data() + i * m, difference.data() + (i + 1) * m, e.data());
        GatedPair pair{candidate.track, candidate.detection, candidate.prediction, 0, 0};
        if (measure<most_measured>(s, e, pair) && pair.distance <= sensor.gate) pairs_.push_back(pair);
    }
}

/// Between a single point and a detection: as if the speed were normal about 0, with a third of the greatest one as its deviation.
void Gating::measure_point_distances(const TrackStore& tracks, const Detections& detections) {
    point_pairs_.clear();
    if (point_candidates_.empty()) return;
    const auto axes = static_cast<std::size_t>(detections.sensor->axes);
    const auto size = static_cast<Eigen::Index>(axes);
    Square<3> s(size, size);
    Column<3> e(size, 1);
    for (const Candidate& candidate : point_candidates_) {
        const Track& point = tracks[candidate.track];
        const std::array<double, 9> second = place_covariance(detections, candidate.detection);
        const double elapsed = static_cast<double>(detections.times[candidate.detection] - point.seen) * nanosecond;
        const double travelled = speed_deviation * maximum_speed_ * elapsed;
        for (std::size_t k = 0; k < axes * axes; ++k) s.data()[k] = point.covariance[k] + second[k];
        for (std::size_t a = 0; a < axes; ++a) {
            s.data()[a * axes + a] += travelled * travelled;
            e.data()[a] = detections.places[candidate.detection][a] - point.place[a];
        }
        GatedPair pair{candidate.track, candidate.detection, none, 0, 0};
        if (measure<3>(s, e, pair)) point_pairs_.push_back(pair);
    }
}

}  // namespace point_target
