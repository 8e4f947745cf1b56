/// The value of a stream between two of its samples, or a little beyond them.
#pragma once

#include <vector>

#include "../../common/streams/sample.hpp"

namespace interpolate {

/// Where the rate of a component stands in its space: `velocity.x` for `position.x`, `range_rate` for `range`; -1: it is not measured.
int rate_of(const pelorus::Space& space, int component);

/// The matrices of a value W0 z0 + W1 z1 at the share `u` of the step of `dt` s from z0 to z1; u > 1 lies beyond z1.
struct Weights {
    Eigen::MatrixXd first, second;
};

/// The line through both: (1 - u) z0 + u z1.
Weights linear(int size, double u);
/// Components whose rate is measured by the cubic that has both values and both rates (Hermite), beyond z1 by z1 and its rate alone;
/// the others, and the rates, by the line.
Weights hermite(const pelorus::Space& space, double u, double dt);

/// Value and covariance, the samples' errors taken as independent. Angles of z1 lie within half a turn of those of z0.
streams::Estimate combined(const Weights& weights, const streams::Sample& first, const streams::Sample& second,
                           const pelorus::Space& space);

}  // namespace interpolate
