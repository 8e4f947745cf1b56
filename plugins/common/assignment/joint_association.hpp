/// Joint probabilistic data association: how probable it is that each detection came from each track's object, when a
/// detection comes from one object at most and an object causes one detection at most.
#pragma once

#include <cstddef>
#include <vector>

namespace assignment {

/// A track and a detection that may have come from its object.
struct LikelihoodRatio {
    std::size_t track = 0, detection = 0;
    double log_ratio = 0;  ///< ln of the likelihood that it did over that of a miss and a false alarm; finite
};

/// What is known of detections besides the tracks: 0 < P_D, P_G < 1.
struct DetectionModel {
    double detection_probability = 0;  ///< P_D
    double gate_probability = 0;       ///< P_G: the object's own detection lies within the gate
    double clutter_density = 0;        ///< false alarms per unit of the measurement space
};

/// ln [ P_D N(e; 0, S) / (clutter density (1 - P_D P_G)) ] for an innovation e of `components` components with e' S^-1 e =
/// `squared_distance` and ln det S = `log_determinant`.
/// Source: Bar-Shalom, Fortmann 1988, 6.4 (PDA with Poisson clutter); the gate's own P_G cancels in P_D P_G N / P_G.
double log_detection_ratio(double squared_distance, double log_determinant, int components,
                           const DetectionModel& model);

/// Weights of the hypotheses; a track's pairs and its `none` sum to 1.
struct JointWeights {
    std::vector<double> pairs;  ///< [pairs]
    std::vector<double> none;   ///< [tracks]: no detection is of the track's object
    std::size_t dropped = 0;    ///< pairs that were left out to keep clusters within the limit; they weigh 0
};

/// Enumerates, depth first, the joint events of each cluster (tracks that share detections, directly or through others). The
/// probability of an event is the product of its pairs' ratios, normalised; a pair's weight is the sum of those it is in.
/// Exact while a cluster has at most `most_events`, counted as if detections could be shared: the product, over its tracks,
/// of 1 + the number of its pairs. From a larger cluster the weakest pairs are left out (those with the least weight if each
/// track were alone), as few of them as make its parts small enough.
///
/// `pairs` is in ascending order of track, then detection, each pair once; tracks are below `tracks`. [worker, concurrent].
///
/// Source: T. Fortmann, Y. Bar-Shalom, M. Scheffe, Sonar Tracking of Multiple Targets Using Joint Probabilistic Data
/// Association, IEEE Journal of Oceanic Engineering 8(3), 173-184, 1983; Y. Bar-Shalom, T. Fortmann, Tracking and Data
/// Association, Academic Press 1988, 9.3.
JointWeights associate_jointly(const std::vector<LikelihoodRatio>& pairs, std::size_t tracks, double most_events);

}  // namespace assignment
