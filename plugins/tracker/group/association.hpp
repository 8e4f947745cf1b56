/// Which pairs belong together, the nearest first.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "../../common/extended/points.hpp"

namespace group {

/// A possible pair and how far its two are apart.
struct Pair {
    std::size_t left = 0, right = 0;
    double squared_distance = 0;
};

/// Takes the pairs from the smallest distance on, each left and each right one at most once. Ties: the smaller left, then the smaller
/// right.
std::vector<Pair> nearest_first(std::vector<Pair> pairs);

/// e' S^-1 e; infinite where S is not positive definite, so that nothing is within a gate about it.
double squared_distance(const Eigen::VectorXd& e, const Eigen::MatrixXd& covariance);

/// The point that is nearest to a place of that covariance by e' (covariance + R)^-1 e, within the gate.
std::optional<std::size_t> nearest_point(const Eigen::VectorXd& place, const Eigen::MatrixXd& covariance,
                                         const extended::Points& points, double gate);

}  // namespace group
