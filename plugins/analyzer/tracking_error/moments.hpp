/// What the estimates of one time err by.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <pelorus/small_matrix.hpp>
#include <pelorus/truth_pairs.hpp>

namespace tracking_error {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

using Pairs = std::vector<pelorus::TruthPairs::Pair>;

/// Errors of positions (derivative 0), velocities or accelerations over the pairs of one time that tell them on both sides.
struct Errors {
    double norm = nothing;           ///< root mean square of |error|
    std::vector<double> axis, bias;  ///< root mean square and mean, an axis
    double count = 0;                ///< pairs

    Errors(const Pairs& pairs, int axes, int derivative) {
        const auto n = static_cast<std::size_t>(axes), first = n * static_cast<std::size_t>(derivative);
        axis.assign(n, 0);
        bias.assign(n, 0);
        for (const auto& pair : pairs) {
            if (pair.estimate->derivatives() <= derivative || pair.truth->derivatives() <= derivative) continue;
            count += 1;
            for (std::size_t k = 0; k < n; ++k) {
                const double error = pair.estimate->moments[first + k] - pair.truth->moments[first + k];
                axis[k] += error * error;
                bias[k] += error;
            }
        }
        double squares = 0;
        for (std::size_t k = 0; k < n; ++k) {
            squares += axis[k];
            axis[k] = count > 0 ? std::sqrt(axis[k] / count) : nothing;
            bias[k] = count > 0 ? bias[k] / count : nothing;
        }
        if (count > 0) norm = std::sqrt(squares / count);
    }
};

/// Squares that have as many degrees of freedom where covariances are right.
struct NormalisedSquares {
    double sum = 0, degrees = 0, count = 0;

    void add(double square, double components) {
        sum += square;
        degrees += components;
        count += 1;
    }
    double mean() const { return count > 0 ? sum / count : nothing; }
    double ratio() const { return count > 0 ? sum / degrees : nothing; }  ///< 1 where all is right
    double bounded_degrees() const { return count > 0 ? degrees : nothing; }
    template <class Archive> void state(Archive& archive) { archive(sum, degrees, count); }
};

/// Adds e' P^-1 e of as many derivatives as are asked for (1: positions, 2: velocities too, 3: accelerations too) and told on both
/// sides; nothing where P is not positive definite.
inline void add_error(const pelorus::TruthPairs::Pair& pair, int derivatives, NormalisedSquares& to) {
    using Square = pelorus::small::Bounded<9, 9>;
    using Column = pelorus::small::Bounded<9, 1>;
    const int axes = pair.estimate->axes;
    const Eigen::Index given = axes * pair.estimate->derivatives();
    const Eigen::Index n = axes * std::min({derivatives, pair.estimate->derivatives(), pair.truth->derivatives()});
    Square covariance(n, n), root(n, n);
    Column error(n, 1);
    for (Eigen::Index col = 0; col < n; ++col) {
        const auto k = static_cast<std::size_t>(col);
        error(col, 0) = pair.estimate->moments[k] - pair.truth->moments[k];
        for (Eigen::Index row = 0; row < n; ++row)
            covariance(row, col) = pair.estimate->covariance[static_cast<std::size_t>(col * given + row)];
    }
    if (pelorus::small::cholesky(covariance, root))
        to.add(pelorus::small::inverse_quadratic(root, error), static_cast<double>(n));
}

}  // namespace tracking_error
