/// How tracks begin: the first record of a track from one detection or from two.
#pragma once

#include <vector>

#include "detections.hpp"
#include "track.hpp"

namespace point_target {

/// Records from single detections: what they tell; the rest is the estimator's prior. `records` has one for each detection.
void start_from_one(Models& models, const Detections& detections, const std::vector<std::size_t>& which,
                    const std::vector<std::uint64_t>& ids, std::vector<double>& records, Failures& failed);

/// A single point and the detection that came after it.
struct TwoPoints {
    const Track* first = nullptr;
    std::size_t second = 0;
};

/// Records from two points each: the second place, and the velocity there of who came from the first one as the motion moves:
/// v = v' + (z2 - p')/T with p', v' where the motion leads from z1 and (z2 - z1)/T; P_pp = R2, P_pv = R2 / T,
/// P_vv = (R1 + R2) / T^2. (Exact where the motion is linear or its accelerations hardly change within T.) An estimator that draws
/// is not asked: v is the velocity between both.
/// Source: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley 2001, 5.5.3.
void start_from_two(Models& models, const Detections& detections, const std::vector<TwoPoints>& pairs,
                    std::vector<double>& records, Failures& failed);

}  // namespace point_target
