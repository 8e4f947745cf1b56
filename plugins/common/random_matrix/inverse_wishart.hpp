/// The extent X of an object as an inverse-Wishart variable: degrees of freedom v and scale V, E[X] = V / (v - 2 d - 2).
/// In a record: v, V by columns, the age.
#pragma once

#include <algorithm>
#include <cmath>

#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

#include "scatter.hpp"

namespace random_matrix {

/// X exists for v > 2 d + 2 only. Forgetting ends this far above: beyond it a step without points leaves everything as it is.
constexpr double least_excess = 0.1;

enum class Start { published, consistent };

/// Points that a start scan must have: a scatter of d + 1 points has full rank; two scans of two points are floored.
template <int D> constexpr std::int32_t start_points(Start start) { return start == Start::published ? D + 1 : 2; }

template <int D> struct InverseWishart {
    static constexpr int record_size = 2 + D * D;
    static constexpr std::uint32_t record_version = 2;

    double degrees = 0;
    Matrix<D> scale = Matrix<D>::Zero();  ///< m^2
    double age = 0;                       ///< s since the start

    Matrix<D> extent() const { return scale / (degrees - (2 * D + 2)); }

    /// v- = e^(-tau T) v, V- = V (v- - d - 1)/(v - d - 1).
    void forget(double rate, double dt) {
        if (dt < 0) throw pelorus::UnsupportedError("cannot move backward in time (dt < 0)");
        const double least = std::min(degrees, 2 * D + 2 + least_excess);
        const double predicted = std::max(std::exp(-rate * dt) * degrees, least);
        scale *= (predicted - D - 1) / (degrees - D - 1);
        degrees = predicted;
        age += dt;
    }
    void turn(const Matrix<D>& rotation) {
        Matrix<D> turned;
        pelorus::small::symmetric_product(rotation, scale, turned);
        scale = turned;
    }

    static InverseWishart read(const double* record) {
        InverseWishart out;
        out.degrees = record[0];
        for (int k = 0; k < D * D; ++k) out.scale.data()[k] = record[1 + k];
        out.age = record[1 + D * D];
        return out;
    }
    /// Throws NumericError unless the expected extent is positive definite.
    void write(double* record) const {
        Matrix<D> root;
        if (!(degrees > 2 * D + 2) || !std::isfinite(age) || !pelorus::small::all_finite(scale) ||
            !pelorus::small::cholesky(scale, root))
            throw pelorus::NumericError("the extent is no longer positive definite");
        record[0] = degrees;
        for (int k = 0; k < D * D; ++k) record[1 + k] = scale.data()[k];
        record[1 + D * D] = age;
    }
};

/// Raises the eigenvalues of a symmetric matrix to a floor.
template <int D> Matrix<D> with_floor(const Matrix<D>& matrix, double floor) {
    Vector<D> values;
    Matrix<D> vectors, scaled, out;
    if (!pelorus::small::symmetric_eigen(matrix, values, vectors))
        throw pelorus::NumericError("the scatter of the points is not finite");
    for (int k = 0; k < D; ++k) scaled.col(k) = vectors.col(k) * std::max(values(k), floor);
    pelorus::small::multiply_transposed(scaled, vectors, out);
    pelorus::small::symmetrise(out);
    return out;
}

/// Throws ArgumentError unless these are the scans that a start wants.
template <int D>
void expect_start(const plr_extent_points* scan, std::uint32_t scans, std::int32_t wanted, std::int64_t count) {
    if (scan == nullptr || scans != static_cast<std::uint32_t>(wanted))
        throw pelorus::ArgumentError("scans: is " + std::to_string(scans) + ", expected " + std::to_string(wanted) +
                                     " (start_scans)");
    for (std::uint32_t s = 0; s < scans; ++s) expect_points<D>(scan[s], count);
}

/// The scatter, if it has an extent on every axis beyond what rounding leaves of points in a plane. Throws NumericError.
template <int D> Matrix<D> of_full_rank(const Matrix<D>& scatter) {
    Vector<D> values;
    Matrix<D> vectors;
    if (!pelorus::small::symmetric_eigen(scatter, values, vectors) || !(values(0) > 1e-12 * values(D - 1)))
        throw pelorus::NumericError("the points lie in a plane, on a line or in one place: they make no shape");
    return scatter;
}

/// Start `published`: V0 = undivided scatter, v0 = 2 d + 3, so that E[X0] = V0.
/// Start `consistent`: C = (Z0 + Z1)/(n0 + n1 - 2), lambda X1 = C - R with its eigenvalues at least 0.05 tr(C)/d,
/// v1 = 2 d + 2 + n1, V1 = n1 X1.
/// Throws NumericError for too few points.
template <int D>
InverseWishart<D> begin_shape(Start start, double lambda, const plr_extent_points* scan, std::int64_t i) {
    const auto enough = [](const Scatter<D>& scatter, std::int64_t least) {
        if (scatter.points < least)
            throw pelorus::NumericError("the shape starts with at least " + std::to_string(least) +
                                        " points a scan, got " + std::to_string(scatter.points));
        return scatter;
    };
    if (start == Start::published)
        return {2 * D + 3, of_full_rank<D>(enough(scatter_of<D>(scan[0], i), start_points<D>(start)).sum), 0};
    const Scatter<D> first = enough(scatter_of<D>(scan[0], i), start_points<D>(start));
    const Scatter<D> second = enough(scatter_of<D>(scan[1], i), start_points<D>(start));
    const double total = first.number + second.number;
    const Matrix<D> spread = (first.sum + second.sum) / (total - 2.0);
    const Matrix<D> noise = (first.number * first.noise + second.number * second.noise) / total;
    const Matrix<D> scaled = with_floor<D>(spread - noise, 0.05 * spread.trace() / D);
    return {2 * D + 2 + second.number, second.number / lambda * scaled, 0};
}

/// Throws ArgumentError unless the outputs of a shape call, as far as they are wanted, are of D dimensions.
template <int D> void expect_shape(const plr_extent_shape& args) {
    const std::int64_t count = args.matrix.count;
    pelorus::expect(args.matrix, D, D, count, "matrix");
    if (args.half_axes.data != nullptr) pelorus::expect(args.half_axes, D, 1, count, "half_axes");
    if (args.axes.data != nullptr) pelorus::expect(args.axes, D, D, count, "axes");
}

/// The shape outputs of an extent matrix: half axes descending, each axis with its largest component positive.
template <int D> void store_shape(const Matrix<D>& extent, const plr_extent_shape& args, std::int64_t i) {
    pelorus::store<D, D>(args.matrix, i, extent);
    if (args.half_axes.data == nullptr && args.axes.data == nullptr) return;
    Vector<D> values, half_axes;
    Matrix<D> vectors, axes;
    if (!pelorus::small::symmetric_eigen(extent, values, vectors))
        throw pelorus::NumericError("the extent is not finite");
    for (int k = 0; k < D; ++k) {
        half_axes(k) = std::sqrt(std::max(values(D - 1 - k), 0.0));
        axes.col(k) = vectors.col(D - 1 - k);
        int largest = 0;
        for (int r = 1; r < D; ++r)
            if (std::fabs(axes(r, k)) > std::fabs(axes(largest, k))) largest = r;
        if (axes(largest, k) < 0) axes.col(k) = -axes.col(k);
    }
    if (args.half_axes.data != nullptr) pelorus::store<D, 1>(args.half_axes, i, half_axes);
    if (args.axes.data != nullptr) pelorus::store<D, D>(args.axes, i, axes);
}

}  // namespace random_matrix
