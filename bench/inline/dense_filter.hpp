/// The textbook filter with full matrices of fixed size, in Eigen's expressions: no structure is made use of, no form is
/// chosen for its rounding. It tells how far the time of the others is from what is written first.
#pragma once

#include "inline/track_filter.hpp"

namespace dense {

/// See plain::predict; nothing is checked.
void predict(const plain::Track* from, plain::Track* to, std::size_t count, double dt, double jerk);

/// See plain::update, for a position sensor at the origin.
void update(const plain::Track* from, const plain::Measurement* measurements, plain::Track* to, double* log_likelihood,
            std::size_t count);

}  // namespace dense
