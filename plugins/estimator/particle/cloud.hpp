/// Sums over weighted points: mean and covariance, where angles go round.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <pelorus/sensor.hpp>

namespace particle {

/// Mean of weighted points (n x count): of angles that of their directions, atan2(sum w sin, sum w cos) (K. V. Mardia, P. E. Jupp,
/// Directional Statistics, 2000, 2.2.1).
inline void mean_of(const double* points, std::int64_t n, const double* weights, std::int64_t count,
                    const std::vector<int>& angles, double* mean) {
    for (std::int64_t k = 0; k < n; ++k) mean[k] = 0;
    for (std::int64_t i = 0; i < count; ++i)
        for (std::int64_t k = 0; k < n; ++k) mean[k] += weights[i] * points[i * n + k];
    for (const int k : angles) {
        double sine = 0, cosine = 0;
        for (std::int64_t i = 0; i < count; ++i) {
            sine += weights[i] * std::sin(points[i * n + k]);
            cosine += weights[i] * std::cos(points[i * n + k]);
        }
        mean[k] = std::atan2(sine, cosine);
    }
}

/// A point's deviation from the mean.
inline void deviation(const double* point, const double* mean, std::int64_t n, const std::vector<int>& angles,
                      double* out) {
    for (std::int64_t k = 0; k < n; ++k) out[k] = point[k] - mean[k];
    for (const int k : angles) out[k] = pelorus::wrap_angle(out[k]);
}

/// covariance += weight a b', n x m; symmetric to the last bit where a is b.
inline void add_outer(double weight, const double* a, std::int64_t n, const double* b, std::int64_t m,
                      double* covariance) {
    for (std::int64_t c = 0; c < m; ++c)
        for (std::int64_t r = 0; r < n; ++r) covariance[c * n + r] += weight * (a[r] * b[c]);
}

/// Mean and covariance (n x n).
inline void moments_of(const double* points, std::int64_t n, const double* weights, std::int64_t count,
                       const std::vector<int>& angles, double* mean, double* covariance) {
    mean_of(points, n, weights, count, angles, mean);
    for (std::int64_t k = 0; k < n * n; ++k) covariance[k] = 0;
    double apart[16];
    for (std::int64_t i = 0; i < count; ++i) {
        deviation(points + i * n, mean, n, angles, apart);
        add_outer(weights[i], apart, n, apart, n, covariance);
    }
}

}  // namespace particle
