/// The tracks and measurements for which filters are timed.
#pragma once

#include <vector>

#include "inline/track_filter.hpp"

namespace pelorus::bench {

constexpr std::size_t tracks = 1000;
constexpr double dt = 0.5, density = 0.5;  // s; of jerk [m2/s5] or acceleration [m2/s3], as in configs/filter.yaml

/// The mount of the spherical sensor in configs/filter.yaml.
const plain::Mount& mount();

/// Tracks of different places and covariances, and a measurement by each sensor near each.
struct Scenario {
    std::vector<plain::Track> start = std::vector<plain::Track>(tracks), predicted = start;
    std::vector<plain::Measurement> position = std::vector<plain::Measurement>(tracks), spherical = position;

    Scenario();
    const plain::Measurement* measurements(plain::Sensor sensor) const {
        return sensor == plain::Sensor::position ? position.data() : spherical.data();
    }
    /// The first `states` (of 9) components of the tracks at the start, as records of mean and covariance.
    std::vector<double> leading(int states) const;
};

const Scenario& scenario();

}  // namespace pelorus::bench
