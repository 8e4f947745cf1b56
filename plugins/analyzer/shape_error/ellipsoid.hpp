/// What two ellipsoids differ by, in two or three dimensions.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

#include "overlap.hpp"

namespace shape_error {

using pelorus::Matrix;
using pelorus::Vector;

constexpr double degrees = 180.0 / 3.14159265358979323846;

/// The published measures of an ellipsoid: the short half axis is the mean of the two smaller roots (in the plane: the smaller one).
template <int D> struct Ellipsoid {
    double short_axis = 0, long_axis = 0;  ///< m
    Vector<D> main_axis;                   ///< unit

    /// Nothing where X is not positive definite.
    static std::optional<Ellipsoid> of(const Matrix<D>& extent) {
        Vector<D> values;
        Matrix<D> vectors;
        if (!pelorus::small::symmetric_eigen(extent, values, vectors) || !(values(0) > 0)) return std::nullopt;
        Ellipsoid out;
        for (int k = 0; k < D - 1; ++k) out.short_axis += std::sqrt(values(k)) / (D - 1);
        out.long_axis = std::sqrt(values(D - 1));
        out.main_axis = vectors.col(D - 1);
        return out;
    }
};

/// Estimate minus truth.
struct Difference {
    double short_axis = 0, long_axis = 0;  ///< m, signed
    double axis_angle = 0;                 ///< degrees between the main axes, folded to 0..90
    double gaussian_wasserstein = 0;       ///< m
    double intersection_over_union = std::numeric_limits<double>::quiet_NaN();  ///< where it was asked for
};

/// sqrt(|c1 - c2|^2 + tr(X1 + X2 - 2 (X1^1/2 X2 X1^1/2)^1/2)).
template <int D> double gaussian_wasserstein(const Vector<D>& offset, const Matrix<D>& one, const Matrix<D>& other) {
    Matrix<D> root, product, mixed;
    if (!pelorus::small::square_root(one, root)) return std::nan("");
    pelorus::small::symmetric_product(root, other, product);
    if (!pelorus::small::square_root(product, mixed)) return std::nan("");
    // Equal shapes leave a rounding residue of either sign.
    return std::sqrt(offset.squaredNorm() + std::max(0.0, (one + other - 2.0 * mixed).trace()));
}

/// Centres (m) and extents (m^2, by columns) of estimate and truth; nothing where one of them is no ellipsoid. `overlap`: whether
/// their intersection is asked for.
template <int D>
std::optional<Difference> difference(const double* centre, const double* extent, const double* true_centre,
                                     const double* true_extent, bool overlap) {
    const Matrix<D> estimated = Eigen::Map<const Matrix<D>>(extent), real = Eigen::Map<const Matrix<D>>(true_extent);
    const auto one = Ellipsoid<D>::of(estimated), other = Ellipsoid<D>::of(real);
    if (!one || !other) return std::nullopt;
    const Vector<D> offset = Eigen::Map<const Vector<D>>(centre) - Eigen::Map<const Vector<D>>(true_centre);
    Difference out;
    out.short_axis = one->short_axis - other->short_axis;
    out.long_axis = one->long_axis - other->long_axis;
    out.axis_angle = std::acos(std::min(1.0, std::fabs(one->main_axis.dot(other->main_axis)))) * degrees;
    out.gaussian_wasserstein = gaussian_wasserstein<D>(offset, estimated, real);
    if (overlap) out.intersection_over_union = intersection_over_union(offset, estimated, real);
    return out;
}

}  // namespace shape_error
