/// How good a clustering is, so that numbers of clusters can be compared. More is better.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "../../common/partition/k_means.hpp"

namespace kmeans_plus_plus {

/// The Bayesian information criterion of equal, round Gaussians: the logarithm of the likelihood less p/2 ln m, with
/// p = (K - 1) + d K + 1 parameters and the variance SS/(d (m - K)), but not less than `least_variance` (m^2).
///
/// Source: D. Pelleg, A. Moore, X-means: Extending K-means with Efficient Estimation of the Number of Clusters, ICML 2000,
/// with the variance of one axis where they have that of all.
template <int D>
double information_criterion(const partition::KMeans<D>& clustering, std::uint32_t points, double sum_of_squares,
                             double least_variance, std::uint32_t* size) {
    const std::uint32_t clusters = clustering.clusters();
    std::fill_n(size, clusters, 0u);
    for (std::uint32_t i = 0; i < points; ++i) ++size[clustering.cluster(i)];
    const double m = points, k = clusters;
    const double variance = std::max(points > clusters ? sum_of_squares / (D * (m - k)) : 0.0, least_variance);
    double log_likelihood =
        -m * D / 2 * std::log(2 * 3.14159265358979323846 * variance) - sum_of_squares / (2 * variance);
    for (std::uint32_t c = 0; c < clusters; ++c)
        if (size[c] > 0) log_likelihood += size[c] * std::log(size[c] / m);
    return log_likelihood - (k - 1 + D * k + 1) / 2 * std::log(m);
}

/// The mean silhouette: (b - a)/max(a, b) with a a point's mean distance to the others of its cluster and b the least mean
/// distance to those of another one. 0 for points that are alone, and for one cluster. O(m^2).
///
/// Source: P. Rousseeuw, Silhouettes: A Graphical Aid to the Interpretation and Validation of Cluster Analysis, Journal of
/// Computational and Applied Mathematics 20, 53-65, 1987.
template <int D>
double silhouette(const partition::KMeans<D>& clustering, const double* points, std::uint32_t count, double* distance,
                  std::uint32_t* size) {
    const std::uint32_t clusters = clustering.clusters();
    std::fill_n(size, clusters, 0u);
    for (std::uint32_t i = 0; i < count; ++i) ++size[clustering.cluster(i)];
    double sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t own = clustering.cluster(i);
        if (size[own] < 2) continue;
        std::fill_n(distance, clusters, 0.0);
        for (std::uint32_t j = 0; j < count; ++j) {
            double square = 0;
            for (int axis = 0; axis < D; ++axis) {
                const double e = points[D * std::size_t{i} + static_cast<std::size_t>(axis)] -
                                 points[D * std::size_t{j} + static_cast<std::size_t>(axis)];
                square += e * e;
            }
            distance[clustering.cluster(j)] += std::sqrt(square);
        }
        const double a = distance[own] / (size[own] - 1);
        double b = std::numeric_limits<double>::infinity();
        for (std::uint32_t c = 0; c < clusters; ++c)
            if (c != own && size[c] > 0) b = std::min(b, distance[c] / size[c]);
        if (std::isfinite(b) && std::max(a, b) > 0) sum += (b - a) / std::max(a, b);
    }
    return sum / count;
}

}  // namespace kmeans_plus_plus
