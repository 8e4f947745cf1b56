/// Arguments and outputs of calls as matrices, an item a column, and how they differ.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <pelorus/space.hpp>

#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance {

/// Columns as items of an argument.
Argument columns(const std::string& name, const Eigen::MatrixXd& matrix);
/// An output of a call that must go well, an item a column, or an item a matrix.
Eigen::MatrixXd answered(const Instance& instance, const HotCall& call);
std::vector<Eigen::MatrixXd> answered_matrices(const Instance& instance, const HotCall& call, std::size_t output = 0);

/// The element where `got` is furthest off `expected` in units of `allowed`, by names; "" where none is off.
std::string first_difference(const Eigen::MatrixXd& got, const Eigen::MatrixXd& expected,
                             const Eigen::MatrixXd& allowed, const Space& rows, const Space& cols);
std::string first_difference(const Eigen::VectorXd& got, const Eigen::VectorXd& expected,
                             const Eigen::VectorXd& allowed, const Space& rows);
/// sqrt(Q_rr Q_cc): how large an element of a covariance may be.
Eigen::MatrixXd element_scales(const Eigen::MatrixXd& covariance);

/// An output of one item of a call that has been made.
Eigen::MatrixXd item_matrix(const HotCall& call, const Execution& done, std::size_t output, std::int64_t i);

}  // namespace pelorus::conformance
