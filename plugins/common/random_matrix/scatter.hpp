/// What a random matrix takes from the points of one object in one scan: number, centroid, scatter, mean sensor noise.
#pragma once

#include <cstdint>

#include <pelorus/abi/extent.h>
#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

namespace random_matrix {

using pelorus::Matrix;
using pelorus::Vector;

/// Throws ArgumentError unless these are the points of `count` objects in D dimensions.
template <int D> void expect_points(const plr_extent_points& scan, std::int64_t count) {
    if (scan.offsets == nullptr)
        throw pelorus::ArgumentError("offsets: is NULL, expected one more than there are items");
    const std::int64_t total = scan.offsets[count];
    pelorus::expect(scan.points, D, 1, total, "points");
    pelorus::expect(scan.noise, D, D, total, "noise");
    if (scan.weights.data != nullptr) pelorus::expect(scan.weights, 1, 1, total, "weights");
}

template <int D> struct Scatter {
    std::int64_t points = 0;
    double number = 0;                       ///< n; 1 / sum w^2 where the points are weighted
    Vector<D> centroid = Vector<D>::Zero();  ///< m
    Matrix<D> sum = Matrix<D>::Zero();       ///< undivided: sum of (z - centroid)(z - centroid)', m^2
    Matrix<D> noise = Matrix<D>::Zero();     ///< weighted mean of the points' R, m^2
};

/// The points of item i. Weighted ones are taken as n = 1 / sum w^2 points with sum = n times the weighted mean square.
template <int D> Scatter<D> scatter_of(const plr_extent_points& scan, std::int64_t i) {
    const std::int64_t first = scan.offsets[i], last = scan.offsets[i + 1];
    Scatter<D> out;
    out.points = last - first;
    if (out.points <= 0) return out;
    const double share = 1.0 / static_cast<double>(out.points);
    const auto weight = [&](std::int64_t k) {
        return scan.weights.data == nullptr ? share : scan.weights.data[k * scan.weights.item_stride];
    };
    double squares = 0;
    for (std::int64_t k = first; k < last; ++k) {
        const double w = weight(k);
        squares += w * w;
        out.centroid += w * pelorus::load<D, 1>(scan.points, k);
        out.noise += w * pelorus::load<D, D>(scan.noise, k);
    }
    // Without weights n is the number itself, not what 1/n summed and inverted makes of it.
    out.number = scan.weights.data == nullptr ? static_cast<double>(out.points) : 1.0 / squares;
    for (std::int64_t k = first; k < last; ++k) {
        const Vector<D> offset = pelorus::load<D, 1>(scan.points, k) - out.centroid;
        pelorus::small::add_outer(out.number * weight(k), offset, out.sum);
    }
    return out;
}

/// e' (A)^-1 e. Throws NumericError where A is not positive definite.
template <int D> double squared_distance(const Vector<D>& e, const Matrix<D>& covariance) {
    Matrix<D> root;
    if (!pelorus::small::cholesky(covariance, root))
        throw pelorus::NumericError("the covariance of a point is not positive definite");
    return pelorus::small::inverse_quadratic(root, e);
}

/// ln N(e; 0, A). Throws NumericError where A is not positive definite.
template <int D> double log_normal(const Vector<D>& e, const Matrix<D>& covariance) {
    Matrix<D> root;
    if (!pelorus::small::cholesky(covariance, root))
        throw pelorus::NumericError("the innovation covariance is not positive definite");
    return pelorus::small::log_normal(root, e);
}

/// ln of the density of n points about their given centroid, each with covariance Y:
/// -(n - 1)/2 (d ln 2 pi + ln det Y) - d/2 ln n - tr(Y^-1 Z)/2. With the likelihood of the centroid, N(e; 0, HPH' + Y/n), it
/// makes the joint density of all points.
template <int D> double log_spread(const Scatter<D>& scatter, const Matrix<D>& covariance) {
    constexpr double log_two_pi = 1.8378770664093454836;
    Matrix<D> root;
    if (!pelorus::small::cholesky(covariance, root))
        throw pelorus::NumericError("the covariance of a point is not positive definite");
    Matrix<D> scaled = scatter.sum;
    pelorus::small::cholesky_solve(root, scaled);
    const double dimension = D;
    return -0.5 * ((scatter.number - 1.0) * (dimension * log_two_pi + pelorus::small::log_determinant(root)) +
                   dimension * std::log(scatter.number) + scaled.trace());
}

inline pelorus::NumericError not_definite() {
    return pelorus::NumericError("an innovation covariance is not positive definite");
}

/// X^1/2 A^-1/2 M A^-1/2 X^1/2 with symmetric roots: what has covariance A is brought to covariance X.
template <int D> Matrix<D> whitened(const Matrix<D>& extent, const Matrix<D>& covariance, const Matrix<D>& moment) {
    Matrix<D> root, inverse, factor, out;
    if (!pelorus::small::square_root(extent, root) || !pelorus::small::inverse_square_root(covariance, inverse))
        throw not_definite();
    pelorus::small::multiply(root, inverse, factor);
    pelorus::small::symmetric_product(factor, moment, out);
    return out;
}

/// Squared distances of the points of item i from `centre`, each with its own noise added to what they have in common.
template <int D>
void store_distances(const plr_extent_points& scan, std::int64_t i, const Vector<D>& centre, const Matrix<D>& common,
                     const plr_view& out) {
    for (std::int64_t k = scan.offsets[i]; k < scan.offsets[i + 1]; ++k) {
        const Vector<D> offset = pelorus::load<D, 1>(scan.points, k) - centre;
        const Matrix<D> covariance = common + pelorus::load<D, D>(scan.noise, k);
        pelorus::store<1, 1>(out, k, Matrix<1>::Constant(squared_distance<D>(offset, covariance)));
    }
}

}  // namespace random_matrix
