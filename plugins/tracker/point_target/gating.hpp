/// Which tracks could have caused which detections: first by what is physically possible, then by the estimator's own
/// uncertainty.
#pragma once

#include "association.hpp"
#include "detections.hpp"
#include "track.hpp"

namespace point_target {

/// A track moved to a time.
struct Prediction {
    std::size_t track = 0;
    std::int64_t time = 0;  ///< ns
};

class Gating {
public:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    void setup(double maximum_speed) { maximum_speed_ = maximum_speed; }

    /// Predicts every track that is within reach of a detection to that detection's time and measures their distance. `all`:
    /// every track is predicted to `scan_time` besides. Costs grow with the number of tracks, of detections and of pairs within
    /// reach.
    void run(Models& models, TrackStore& tracks, const Detections& detections, std::int64_t scan_time, bool all);

    /// Tracks with records and detections within their gates, ascending; likewise single points that wait for a second one, with
    /// detections within reach.
    const std::vector<GatedPair>& pairs() const noexcept { return pairs_; }
    const std::vector<GatedPair>& point_pairs() const noexcept { return point_pairs_; }
    const double* predicted(std::size_t prediction) const { return records_.data() + prediction * record_size_; }
    /// The track's prediction to the scan's time, or `none`.
    std::size_t at_scan_time(std::size_t track) const { return at_scan_time_[track]; }
    /// Whether the estimator could not predict the track forward.
    bool failed(std::size_t track) const { return failed_[track] != 0; }

private:
    struct Candidate {
        std::size_t track, detection, prediction;
    };
    void find_candidates(const TrackStore& tracks, const Detections& detections);
    bool comes_in_time(const Track& track, std::int64_t time) const;
    bool within_reach(const Track& track, const Detections& detections, std::size_t detection) const;
    double reach(const Track& track, const SensorModel& sensor, std::int64_t time, double deviation) const;
    void list_predictions(const TrackStore& tracks, const Detections& detections, std::int64_t scan_time, bool all);
    void predict(Models& models, TrackStore& tracks);
    void measure_distances(Models& models, const TrackStore& tracks, const Detections& detections);
    void measure_point_distances(const TrackStore& tracks, const Detections& detections);

    double maximum_speed_ = 0;  // m/s
    bool takes_late_ = false;   // tracks take measurements older than themselves
    std::size_t record_size_ = 0;
    MeasurementGrid grid_;
    std::vector<Candidate> candidates_;        // tracks with records
    std::vector<Candidate> point_candidates_;  // single points
    std::vector<Prediction> predictions_;      // those of candidates come first
    std::size_t gated_ = 0;                    // how many of them
    std::vector<double> records_;              // predicted
    std::vector<std::size_t> at_scan_time_;    // by track
    std::vector<char> failed_;                 // by track
    std::vector<char> unpredicted_;            // by prediction
    std::vector<GatedPair> pairs_, point_pairs_;
};

/// Covariance of the place (axes x axes, column-major) that a detection tells by itself.
std::array<double, 9> place_covariance(const Detections& detections, std::size_t detection);

}  // namespace point_target
