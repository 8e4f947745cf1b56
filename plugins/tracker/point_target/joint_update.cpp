#include "joint_update.hpp"

#include <algorithm>
#include <cmath>

namespace point_target {

const Share& MixedTrack::likeliest() const {
    return *std::max_element(shares.begin(), shares.end(),
                             [](const Share& a, const Share& b) { return a.weight < b.weight; });
}

std::size_t JointUpdate::run(Models& models, const Gating& gating, const Detections& detections,
                             const std::vector<GatedPair>& pairs, const assignment::JointWeights& weights,
                             TrackStore& tracks) {
    list(detections, pairs, weights);
    update(models, gating, detections, pairs, tracks);
    move_to_common_time(models, detections, pairs);
    return mix(models, gating, weights, tracks);
}

/// Pairs without weight need no hypothesis, but their tracks are listed all the same.
void JointUpdate::list(const Detections& detections, const std::vector<GatedPair>& pairs,
                       const assignment::JointWeights& weights) {
    tracks_.clear();
    missed_.clear();
    hypotheses_.clear();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const GatedPair& pair = pairs[i];
        const std::int64_t time = detections.times[pair.detection];
        if (tracks_.empty() || tracks_.back().track != pair.track) {
            tracks_.push_back({pair.track, time, weights.none[pair.track], {}});
            missed_.push_back(pair.prediction);
        }
        if (time > tracks_.back().time) {
            tracks_.back().time = time;
            missed_.back() = pair.prediction;
        }
        if (weights.pairs[i] > 0) hypotheses_.push_back({tracks_.size() - 1, i});
    }
}

void JointUpdate::update(Models& models, const Gating& gating, const Detections& detections,
                         const std::vector<GatedPair>& pairs, const TrackStore& tracks) {
    const std::size_t size = models.record_size(), m = detections.m(), n = hypotheses_.size();
    std::vector<double> measurements, noises;
    ids_.clear();
    records_.clear();
    for (const Hypothesis& hypothesis : hypotheses_) {
        const GatedPair& pair = pairs[hypothesis.pair];
        const double* record = gating.predicted(pair.prediction);
        const double* z = detections.measurement_of(pair.detection);
        const double* r = detections.noise_of(pair.detection);
        ids_.push_back(tracks[pair.track].id);
        records_.insert(records_.end(), record, record + size);
        measurements.insert(measurements.end(), z, z + m);
        noises.insert(noises.end(), r, r + m * m);
        tracks_[hypothesis.mixed].shares.push_back({pair.detection, pair.distance, 0});
    }
    failed_.clear();
    if (n == 0) return;
    models.update(*detections.sensor, n, ids_.data(), measurements.data(), noises.data(), records_.data(), failed_);
}

/// Detections of a scan may have times of their own; hypotheses are mixed at that of the latest.
void JointUpdate::move_to_common_time(Models& models, const Detections& detections,
                                      const std::vector<GatedPair>& pairs) {
    std::vector<double> ahead;
    bool any = false;
    for (const Hypothesis& hypothesis : hypotheses_) {
        const std::int64_t time = detections.times[pairs[hypothesis.pair].detection];
        ahead.push_back(static_cast<double>(tracks_[hypothesis.mixed].time - time) * 1e-9);
        any = any || ahead.back() > 0;
    }
    if (!any) return;
    const Failures before = failed_;
    models.predict(hypotheses_.size(), ids_.data(), ahead.data(), records_.data(), failed_);
    for (std::size_t i = 0; i < before.size(); ++i) failed_[i] = failed_[i] != 0 || before[i] != 0 ? 1 : 0;
}

/// A hypothesis that failed goes to that of no detection.
std::size_t JointUpdate::mix(Models& models, const Gating& gating, const assignment::JointWeights& weights,
                             TrackStore& tracks) {
    const std::size_t size = models.record_size();
    std::size_t failures = 0, kept = 0, next = 0;
    mixed_record_.resize(size);
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        MixedTrack mixed = std::move(tracks_[t]);
        const double* missed = gating.predicted(missed_[t]);
        mixture_.assign(missed, missed + size);
        mixture_weights_.assign(1, mixed.none);
        std::size_t taken = 0;
        for (Share share : mixed.shares) {
            const std::size_t i = next++;
            share.weight = weights.pairs[hypotheses_[i].pair];
            if (failed_[i] != 0) {
                ++failures;
                mixture_weights_.front() += share.weight;
                continue;
            }
            mixture_.insert(mixture_.end(), records_.data() + i * size, records_.data() + (i + 1) * size);
            mixture_weights_.push_back(share.weight);
            mixed.shares[taken++] = share;
        }
        mixed.shares.resize(taken);
        mixed.none = mixture_weights_.front();
        if (!models.mix(tracks[mixed.track].id, mixture_weights_, mixture_.data(), mixed_record_.data())) {
            ++failures;
            continue;
        }
        std::copy(mixed_record_.begin(), mixed_record_.end(), tracks.record(mixed.track));
        tracks_[kept++] = std::move(mixed);
    }
    tracks_.resize(kept);
    return failures;
}

double estimated_clutter_density(const std::vector<GatedPair>& pairs, const SensorModel& sensor,
                                 double detection_probability, double gate_probability) {
    const double half = 0.5 * sensor.m, pi = 3.14159265358979323846;
    const double unit_ball = std::pow(pi, half) / std::tgamma(half + 1);
    double volume = 0, tracks = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (i > 0 && pairs[i].track == pairs[i - 1].track) continue;
        volume += unit_ball * std::pow(sensor.gate, half) * std::exp(0.5 * pairs[i].log_determinant);
        ++tracks;
    }
    const double own = detection_probability * gate_probability * tracks;
    return (std::max(0.0, static_cast<double>(pairs.size()) - own) + 1) / volume;
}

}  // namespace point_target
