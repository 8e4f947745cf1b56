/// Points and weights that stand for a normal distribution: sum w f(xi) for E f(xi), xi ~ N(0, I), exact for polynomials up to
/// some degree. Data, made once for an instance.
#pragma once

#include "factor_kernels.hpp"

#include <cstdint>
#include <vector>

namespace gaussian {

/// Point 0 is the centre, of weight 0 where the rule has none: means and differences of angles are taken about it.
struct PointRule {
    std::int64_t size = 0;                                 // components of xi
    std::vector<double> points;                            // size x p, column-major
    std::vector<double> mean_weights, covariance_weights;  // [p]; those of a covariance differ at the centre alone
    /// Points are the centre and +-scale along the axes, +e1 -e1 +e2 -e2 ..., all pairs of one weight, 1/(2 scale^2).
    bool is_star = false;
    double scale = 0.0;

    std::int64_t count() const noexcept { return static_cast<std::int64_t>(mean_weights.size()); }
    const double* point(std::int64_t p) const noexcept { return points.data() + p * size; }
};

/// The third-degree spherical-radial rule: 2n points at sqrt(n) on the axes, weights 1/(2n) (Arasaratnam, Haykin 2009, eq. 45).
PointRule cubature_rule(int n);
/// The scaled unscented transform: lambda = alpha^2 (n + kappa) - n, points at sqrt(n + lambda), weights 1/(2(n + lambda)), of
/// the centre lambda/(n + lambda), in covariances 1 - alpha^2 + beta more (Wan, van der Merwe 2000). n + kappa > 0.
PointRule unscented_rule(int n, double alpha, double beta, double kappa);
/// order^n points: the tensor product of the Gauss-Hermite rule of `order` points, whose nodes are the eigenvalues of the
/// tridiagonal matrix of the recurrence (Golub, Welsch 1969). 2 <= order <= 32.
PointRule gauss_hermite_rule(int n, int order);
/// order^n, or more than any bound.
double gauss_hermite_count(int n, int order);

/// The rule for a function of the first `leading` components alone: points that differ in others only are one, of their
/// weights' sum.
PointRule leading_rule(const PointRule& rule, std::int64_t leading);

/// A rule as kernels see it, as long as it lives. The centre's residual is -shift, and its weight may be negative; then, of
/// differences d from the centre's image,
///     sum w (d - shift)(d - shift)' = sum w d d' + (sum w - 2) shift shift'
/// may hold nothing negative, and does not cancel where points lie close to the centre.
Points points_of(const PointRule& rule) noexcept;

}  // namespace gaussian
