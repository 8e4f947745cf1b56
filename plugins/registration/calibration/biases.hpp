/// What may be wrong with a sensor, as one normal vector, and how probable it is that something is.
///
/// Three angles by which it is turned about its own axes (roll, pitch, yaw; rad), an offset of its position along the axes of the
/// frame (m), an addend of its range (m) and of its time stamps (s). Those whose prior deviation is 0 are right for certain.
///
/// A Kalman filter, in the square-root information form, estimates them as if each of them were wrong, b ~ N(0, diag(sd)^2). Whether one is wrong at all is a question of
/// its own: each is with probability `presence`, else it is 0. As the priors are independent, the evidence for a set of zeros
/// against none is the posterior density at these zeros over the prior density there (J. M. Dickey, The weighted likelihood
/// ratio, linear hypotheses on normal location parameters, The Annals of Mathematical Statistics 42(1), 204-223, 1971), and
/// the posterior of the others is that of the filter given the zeros. The estimate is the mean over all sets (spike and slab:
/// T. J. Mitchell, J. J. Beauchamp, Bayesian variable selection in linear regression, Journal of the American Statistical
/// Association 83(404), 1023-1032, 1988).
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <pelorus/archive.hpp>

namespace calibration {

enum Bias : int { roll, pitch, yaw, offset_x, offset_y, offset_z, range_bias, clock_offset, bias_count };

struct BiasName {
    const char* name;
    const char* unit;
};
constexpr std::array<BiasName, bias_count> bias_names{{{"roll", "rad"},
                                                       {"pitch", "rad"},
                                                       {"yaw", "rad"},
                                                       {"offset_x", "m"},
                                                       {"offset_y", "m"},
                                                       {"offset_z", "m"},
                                                       {"range_bias", "m"},
                                                       {"clock_offset", "s"}}};

/// One number a bias; 0 for one that is not estimated.
using BiasVector = Eigen::Matrix<double, bias_count, 1>;
using BiasMatrix = Eigen::Matrix<double, bias_count, bias_count>;
/// Derivatives of a measurement, one column a bias.
using BiasSlope = Eigen::Matrix<double, Eigen::Dynamic, bias_count>;

/// What is known, averaged over what may be wrong.
struct Estimate {
    BiasVector value = BiasVector::Zero();
    BiasMatrix covariance = BiasMatrix::Zero();
    BiasVector presence = BiasVector::Zero();  ///< probability that it is not 0
};

/// A direction in the space of the biases, each in units of its prior deviation.
struct Direction {
    double ratio;      ///< posterior to prior deviation along it
    BiasVector share;  ///< of norm 1
};

class Biases {
public:
    Biases() = default;
    /// Prior deviations (0: not estimated) and the probability that a bias is there at all, in (0, 1].
    Biases(const BiasVector& deviations, double presence);

    const std::vector<int>& active() const noexcept { return active_; }
    /// What the filter believes, for linearisation and gates: all that may be wrong is.
    BiasVector mean() const { return spread(mean_); }
    BiasMatrix covariance() const;
    const Estimate& estimate() const noexcept { return estimate_; }
    /// Posterior to prior deviation of one bias: 1 where nothing has been learnt.
    double ratio(int bias) const;
    /// All directions, the least known first.
    std::vector<Direction> directions() const;

    /// residual = slope (b - mean) + noise. Throws NumericError, and learns nothing, where that is not finite or
    /// the noise not positive definite.
    void update(const Eigen::VectorXd& residual, const BiasSlope& slope, const Eigen::MatrixXd& noise);

    template <class Archive> void state(Archive& archive) {
        archive(mean_, root_);
        if constexpr (Archive::reading) {
            const auto n = static_cast<Eigen::Index>(active_.size());
            if (mean_.size() != n || root_.rows() != n || root_.cols() != n)
                throw pelorus::DataError("the saved biases are of other parameters");
            covariance_ = covariance_of(root_);
            average();
        }
    }

private:
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, bias_count, 1>;
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, bias_count, bias_count>;

    BiasVector spread(const Vector& whitened) const;
    static Matrix covariance_of(const Matrix& root);
    void average();

    std::vector<int> active_;
    BiasVector deviations_ = BiasVector::Zero();
    double presence_ = 1;
    Vector mean_;        ///< of the active ones, in units of their prior deviations
    Matrix root_;        ///< upper triangular: root' root is the information
    Matrix covariance_;  ///< its inverse
    Estimate estimate_;
};

}  // namespace calibration
