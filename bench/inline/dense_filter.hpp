/// The textbook filter with full matrices of fixed size, in Eigen's expressions: no structure is made use of, no form is
/// chosen for its rounding. It tells how far the time of the others is from what is written first.
///
/// Tracks are records of n = 3 b numbers (b = 2: positions and velocities, 3: accelerations too) and n x n of their
/// covariance; b is 2 or 3.
#pragma once

#include "inline/track_filter.hpp"

namespace dense {

/// White noise of density `density` in the highest derivative, one time step for all; nothing is checked.
template <int B> void predict(const double* from, double* to, std::size_t count, double dt, double density);

/// One measurement a track; nothing is checked.
template <int B>
void update(plain::Sensor sensor, const plain::Mount& mount, const double* from, const plain::Measurement* measurements,
            double* to, double* log_likelihood, std::size_t count);

}  // namespace dense
