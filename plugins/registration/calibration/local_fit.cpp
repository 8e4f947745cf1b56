#include "local_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <pelorus/failure.hpp>

namespace calibration {

Fit local_fit(const FitInput& input) {
    const Eigen::Index m = input.values.rows(), n = input.values.cols();
    double reach = 0;  // times in units of the farthest one: the normal equations are then well scaled
    for (const double t : input.times) reach = std::max(reach, std::abs(t));
    if (n < least_for_fit || !(reach > 0)) throw pelorus::NumericError("too few times for a parabola");

    Fit out{Eigen::VectorXd(m),
            Eigen::VectorXd(m),
            Eigen::VectorXd(m),
            Eigen::VectorXd(m),
            0,
            static_cast<int>(m * (n - least_for_fit))};
    for (Eigen::Index c = 0; c < m; ++c) {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (Eigen::Index i = 0; i < n; ++i) {
            const double t = input.times[static_cast<std::size_t>(i)] / reach, weight = 1 / input.variances(c, i);
            const Eigen::Vector3d row(1, t, t * t);
            normal += weight * row * row.transpose();
            right += weight * input.values(c, i) * row;
        }
        const Eigen::LLT<Eigen::Matrix3d> factor(normal);
        if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-12))
            throw pelorus::NumericError("the times do not determine a parabola");
        const Eigen::Vector3d at = factor.solve(right);
        const Eigen::Matrix3d covariance = factor.solve(Eigen::Matrix3d::Identity());
        out.value(c) = at(0);
        out.value_variance(c) = covariance(0, 0);
        out.rate(c) = at(1) / reach;
        out.rate_variance(c) = covariance(1, 1) / (reach * reach);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double t = input.times[static_cast<std::size_t>(i)] / reach;
            const double left = input.values(c, i) - at(0) - t * (at(1) + t * at(2));
            out.squared += left * left / input.variances(c, i);
        }
    }
    return out;
}

}  // namespace calibration
