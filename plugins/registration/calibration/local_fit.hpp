/// A parabola through the measurements of one target around a time: where it was then, and how fast it moved through the
/// measurement space, without a model of its motion.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace calibration {

/// m measured components, n measurements; component by component, weighted by the inverse variances.
struct FitInput {
    std::vector<double> times;  ///< s, from the time in question
    Eigen::MatrixXd values;     ///< m x n, as differences from a reference (angles do not wrap)
    Eigen::MatrixXd variances;  ///< m x n
};

struct Fit {
    Eigen::VectorXd value, value_variance;  ///< at time 0
    Eigen::VectorXd rate, rate_variance;    ///< a second
    double squared = 0;                     ///< sum of the squared, normalised residuals
    int freedom = 0;                        ///< their degrees of freedom
};

/// The least number of measurements.
constexpr int least_for_fit = 3;

/// Least squares of value + rate t + curvature t^2. Throws NumericError where the times do not determine it.
Fit local_fit(const FitInput& input);

}  // namespace calibration
