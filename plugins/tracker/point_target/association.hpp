/// Global nearest neighbour: which of the gated pairs of tracks and detections come true.
#pragma once

#include <cstddef>
#include <vector>

namespace point_target {

/// A track and a detection within its gate.
struct GatedPair {
    std::size_t track = 0, detection = 0;
    std::size_t prediction = 0;  ///< the caller's: where the prediction of this track to the detection's time is kept
    double distance = 0;         ///< squared Mahalanobis
    double log_determinant = 0;  ///< of S
};

/// Chooses pairs such that each track has at most one detection and each detection at most one track, at the least sum of
/// distance + log determinant (up to a factor and a constant the negative log likelihood). A track without a detection costs
/// gate + the largest log determinant of its cluster: the least constant at which no gated pair is worse than none, and the
/// same for all of a cluster, as a constant probability of detection and density of false alarms would have it.
/// Works cluster by cluster (connected components of the pairs), exactly.
/// `pairs` is in ascending order of track, then detection; `gate` is not less than any distance. Answers indices into it,
/// ascending.
/// Source: S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, Artech House 1999, 6.4.
std::vector<std::size_t> associate(const std::vector<GatedPair>& pairs, double gate);

}  // namespace point_target
