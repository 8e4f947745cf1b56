/// Random samples of the quantities that plugins work on. Every sample is a function of its key: a check that failed fails again.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <pelorus/abi/abi.h>

namespace pelorus::conformance {

class Sample {
public:
    Sample(const plr_random& random, plr_key key) : random_(&random), key_(key) {}

    double uniform(double from = 0.0, double to = 1.0);
    double normal(double mean = 0.0, double deviation = 1.0);
    /// A whole number in [0, below).
    std::uint64_t below(std::uint64_t below);
    /// 0 .. count - 1 in random order.
    std::vector<std::int64_t> permutation(std::int64_t count);
    plr_key key() const noexcept { return key_; }

    /// A plausible vector of a space: metres by the ten thousand, metres a second by the hundred, angles all round; components of
    /// other units about their prior means.
    Eigen::VectorXd state(const plr_space& space);
    /// A covariance of a space, well conditioned up to units, correlated.
    Eigen::MatrixXd covariance(const plr_space& space);
    /// Likewise with given deviations.
    Eigen::MatrixXd covariance(const Eigen::VectorXd& deviations);
    /// Normal, with that covariance.
    Eigen::VectorXd normal(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance);
    /// A rotation of d dimensions.
    Eigen::MatrixXd rotation(int dimension);
    /// 0.05 s to 5 s.
    double step() { return uniform(0.05, 5.0); }

private:
    const plr_random* random_;
    plr_key key_;
    std::uint64_t used_ = 0;
};

/// The scale of a component: how far plausible values spread, for differences and tolerances.
double scale_of(const plr_component& component) noexcept;
Eigen::VectorXd scales_of(const plr_space& space);

}  // namespace pelorus::conformance
