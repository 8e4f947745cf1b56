/// A mixture of Gaussians, fitted to points by expectation and maximisation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <pelorus/small_matrix.hpp>

#include "../../common/partition/memory.hpp"

namespace expectation_maximisation {

/// Points D numbers each, of which some are looked at.
template <int D> struct Points {
    const double* numbers;
    const std::uint32_t* chosen;  ///< numbers of the points looked at
    std::uint32_t count;          ///< of them

    pelorus::Vector<D> operator[](std::uint32_t k) const noexcept {
        return Eigen::Map<const pelorus::Vector<D>>(numbers + D * std::size_t{chosen[k]});
    }
};

/// One part of the mixture, and the sums of a pass over the points.
template <int D> struct Component {
    pelorus::Vector<D> mean;
    pelorus::Matrix<D> covariance, root;  ///< root: Cholesky factor
    double weight;
    double members;  ///< sum of responsibilities
    pelorus::Vector<D> first;
    pelorus::Matrix<D> second;  ///< moments about the mean before the pass
};

/// sum_k w_k N(z; mean_k, covariance_k), and a background w_0 u of constant density u where there is one.
///
/// A pass gives each point to the parts by their shares of its density, and then takes the weights, means and covariances of
/// what was given. No eigenvalue of a covariance gets less than `least_variance`; with this bound, too, a pass is the best
/// one can do with the points so given, and the likelihood never falls.
/// Source: A. Dempster, N. Laird, D. Rubin, Maximum Likelihood from Incomplete Data via the EM Algorithm, Journal of the Royal
/// Statistical Society B 39(1), 1-38, 1977.
template <int D> class Mixture {
public:
    static constexpr std::int32_t background = -1;

    Mixture(partition::Memory& memory, std::uint32_t most, double least_variance)
        : components_(memory.take<Component<D>>(most)),
          logs_(memory.take<double>(most)),
          least_variance_(least_variance) {}
    static constexpr std::size_t bytes_per_component =
        sizeof(Component<D>) + sizeof(double) + 2 * partition::Memory::step;

    void clear() noexcept {
        count_ = 0;
        background_weight_ = 0;
    }
    void add(double weight, const pelorus::Vector<D>& mean, const pelorus::Matrix<D>& covariance) {
        Component<D>& own = components_[count_++];
        own.weight = weight;
        own.mean = mean;
        take_covariance(own, covariance);
    }
    void add_background(double weight, double density) noexcept {
        background_weight_ = weight;
        log_background_ = std::log(density);
    }
    std::uint32_t size() const noexcept { return count_; }

    /// Passes until the likelihood hardly grows; answers its logarithm, before the last pass.
    double fit(const Points<D>& points, std::int64_t passes) {
        double before = -std::numeric_limits<double>::infinity();
        for (std::int64_t pass = 0; pass < passes; ++pass) {
            const double now = one_pass(points);
            if (!(now - before > 1e-10 * (1 + std::abs(now)))) return now;
            before = now;
        }
        return before;
    }

    /// What is most likely the origin of a point (of equals the first; the background last), with the share that it has.
    struct Origin {
        std::int32_t component;
        double share;
    };
    Origin origin(const pelorus::Vector<D>& point) const noexcept {
        const double total = log_density(point);
        Origin best{background, 0};
        double most = background_weight_ > 0 ? log_of_background() : -std::numeric_limits<double>::infinity();
        for (std::uint32_t k = 0; k < count_; ++k)
            if (logs_[k] >= most && (logs_[k] > most || best.component == background)) {
                most = logs_[k];
                best = {static_cast<std::int32_t>(k), std::exp(logs_[k] - total)};
            }
        return best;
    }

private:
    double log_of_background() const noexcept { return std::log(background_weight_) + log_background_; }

    void take_covariance(Component<D>& own, const pelorus::Matrix<D>& covariance) {
        pelorus::Vector<D> values;
        pelorus::Matrix<D> axes;
        if (!pelorus::small::symmetric_eigen(covariance, values, axes))
            throw pelorus::NumericError("a covariance of the mixture is not finite");
        own.covariance = axes * values.cwiseMax(least_variance_).asDiagonal() * axes.transpose();
        if (!pelorus::small::cholesky(own.covariance, own.root))
            throw pelorus::NumericError("a covariance of the mixture is not positive definite");
    }

    /// Leaves the logarithms of the parts in logs_.
    double log_density(const pelorus::Vector<D>& point) const noexcept {
        double most = background_weight_ > 0 ? log_of_background() : -std::numeric_limits<double>::infinity();
        for (std::uint32_t k = 0; k < count_; ++k) {
            const Component<D>& own = components_[k];
            const pelorus::Vector<D> error = point - own.mean;
            logs_[k] = own.weight > 0 ? std::log(own.weight) + pelorus::small::log_normal(own.root, error)
                                      : -std::numeric_limits<double>::infinity();
            most = std::max(most, logs_[k]);
        }
        double sum = background_weight_ > 0 ? std::exp(log_of_background() - most) : 0;
        for (std::uint32_t k = 0; k < count_; ++k) sum += std::exp(logs_[k] - most);
        return most + std::log(sum);
    }

    double one_pass(const Points<D>& points) {
        for (std::uint32_t k = 0; k < count_; ++k) {
            components_[k].members = 0;
            components_[k].first.setZero();
            components_[k].second.setZero();
        }
        double log_likelihood = 0, of_background = 0;
        for (std::uint32_t i = 0; i < points.count; ++i) {
            const pelorus::Vector<D> point = points[i];
            const double total = log_density(point);
            log_likelihood += total;
            if (background_weight_ > 0) of_background += std::exp(log_of_background() - total);
            for (std::uint32_t k = 0; k < count_; ++k) {
                const double share = std::exp(logs_[k] - total);
                if (share == 0) continue;
                Component<D>& own = components_[k];
                const pelorus::Vector<D> error = point - own.mean;
                own.members += share;
                own.first += share * error;
                own.second += share * error * error.transpose();
            }
        }
        for (std::uint32_t k = 0; k < count_; ++k) take_moments(components_[k], points.count);
        background_weight_ = of_background / points.count;
        return log_likelihood;
    }
    void take_moments(Component<D>& own, std::uint32_t points) {
        own.weight = own.members / points;
        if (!(own.members > 1e-6)) {  // of no point: it keeps its place, and no weight
            own.weight = 0;
            return;
        }
        const pelorus::Vector<D> step = own.first / own.members;
        own.mean += step;
        take_covariance(own, own.second / own.members - step * step.transpose());
    }

    Component<D>* components_;
    double* logs_;
    std::uint32_t count_ = 0;
    double least_variance_, background_weight_ = 0, log_background_ = 0;
};

}  // namespace expectation_maximisation
