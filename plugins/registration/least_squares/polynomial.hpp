/// The value at a time of a polynomial fitted to samples of arbitrary times by least squares.
#pragma once

#include <Eigen/Core>

#include "../../common/streams/sample.hpp"

namespace least_squares {

/// Weights w, so that sum w_i z_i is the value at time 0 of the polynomial of `order` (0, 1, 2) fitted to z by least squares, all samples
/// alike; fewer samples than coefficients lower the order. `times` [s] are all different. From the polynomials p_k that are
/// orthogonal on the times, w_i = sum_k p_k(0) p_k(t_i) / sum_j p_k(t_j)^2; for a line and times -(n - 1) T .. 0 this is
///     c1 + c2 i,  c1 = -2/n,  c2 = 6/(n (n + 1)),  sum w_i^2 = 2 (2 n - 1)/(n (n + 1)).
Eigen::VectorXd weights(const Eigen::VectorXd& times, int order);

/// The value at time 0 with its covariance, of the polynomial of `order` fitted to samples of known covariances. Where these are equal
/// it is the fit by `weights`, and the covariance sum w_i^2 times theirs. Where they differ, and each is positive definite, each
/// sample counts by its inverse covariance. `values` m x n, in one turn of their angles; `covariances` [n], m x m.
streams::Estimate fit(const Eigen::VectorXd& times, const Eigen::MatrixXd& values,
                      const std::vector<const Eigen::MatrixXd*>& covariances, int order);

}  // namespace least_squares
