/// How a function looks from a state's distribution, as far as points tell.
#pragma once

#include "point_rule.hpp"
#include "step_kernels.hpp"

namespace gaussian {

/// The points x + S xi of a rule, or of the listed rows of it: rows x p. S is n x n lower triangular.
void place_points(const PointRule& rule, const double* mean, const double* factor, std::int64_t n,
                  const std::vector<std::int64_t>& rows, double* out) noexcept;

/// The regression of f on the whitened state from the points' images: with y = f(x + S xi),
///     shift = sum w (y - y0), slope = sum w (y - y0 - shift) xi', columns e sqrt(w), e = y - y0 - shift - slope xi
/// so that the mean is y0 + shift and the covariance sum w (y - mean)(y - mean)' = G G' + E E' - u u' (S. Sarkka, Bayesian
/// Filtering and Smoothing, 2013, 5.5 and 6; I. Arasaratnam, S. Haykin, R. J. Elliott, Proceedings of the IEEE 95, 2007).
/// `values`, rows x p, holds y - y0 and becomes the residual; slope is rows x n (0 beyond the rule's components), shift and
/// downdate hold rows each.
Image regress(const PointRule& rule, std::int64_t n, std::int64_t rows, double* values, double* shift, double* slope,
              double* downdate) noexcept;

}  // namespace gaussian
