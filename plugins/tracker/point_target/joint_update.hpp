/// Joint probabilistic data association: tracks updated by all detections within their gates, each as far as it is theirs.
#pragma once

#include <vector>

#include "../../common/assignment/joint_association.hpp"
#include "gating.hpp"

namespace point_target {

/// A detection that a track was updated with, and how probably it is the track's.
struct Share {
    std::size_t detection = 0;
    double distance = 0;  ///< squared Mahalanobis
    double weight = 0;
};

/// A track after the mixture of its hypotheses.
struct MixedTrack {
    std::size_t track = 0;
    std::int64_t time = 0;  ///< ns, of the record: that of the latest detection within the gate
    double none = 1;        ///< weight of no detection being the track's
    std::vector<Share> shares;
    bool seen() const noexcept { return none < 0.5; }
    const Share& likeliest() const;
};

class JointUpdate {
public:
    void clear() { tracks_.clear(); }
    /// Updates each track of `pairs` with each of its detections, moves the hypotheses to a common time and mixes them by the
    /// weights; `tracks` gets the mixed records. Tracks whose mixture fails are left as they were, and are not listed. Answers
    /// how many calls failed.
    std::size_t run(Models& models, const Gating& gating, const Detections& detections,
                    const std::vector<GatedPair>& pairs, const assignment::JointWeights& weights, TrackStore& tracks);
    /// Ascending by track.
    const std::vector<MixedTrack>& tracks() const noexcept { return tracks_; }

private:
    /// One detection of a track: a record updated with it.
    struct Hypothesis {
        std::size_t mixed = 0, pair = 0;
    };
    void list(const Detections& detections, const std::vector<GatedPair>& pairs,
              const assignment::JointWeights& weights);
    void update(Models& models, const Gating& gating, const Detections& detections, const std::vector<GatedPair>& pairs,
                const TrackStore& tracks);
    void move_to_common_time(Models& models, const Detections& detections, const std::vector<GatedPair>& pairs);
    std::size_t mix(Models& models, const Gating& gating, const assignment::JointWeights& weights, TrackStore& tracks);

    std::vector<MixedTrack> tracks_;
    std::vector<std::size_t> missed_;  // by mixed track: its prediction to the common time
    std::vector<Hypothesis> hypotheses_;
    std::vector<std::uint64_t> ids_;  // by hypothesis, as all below
    std::vector<double> records_;
    Failures failed_;
    std::vector<double> mixture_, mixture_weights_, mixed_record_;  // of the track at hand
};

/// False alarms per unit of the measurement space, from the scan itself: (k + 1) / V with the volume V of the gates of `pairs` and
/// k, the number of pairs beyond the P_D P_G that each track causes itself (0 at least): the mean of Poisson's density given k
/// in V, if nothing is known of it before. Overlapping gates count twice, and so do the detections in them.
double estimated_clutter_density(const std::vector<GatedPair>& pairs, const SensorModel& sensor,
                                 double detection_probability, double gate_probability);

}  // namespace point_target
