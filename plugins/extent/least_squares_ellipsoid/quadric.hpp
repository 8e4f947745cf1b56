/// The quadric that fits points best in the least-squares sense, as half axes and directions.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

namespace least_squares_ellipsoid {

using pelorus::Matrix;
using pelorus::Vector;

/// q'A q + 2 b'q = 1: D (D + 1)/2 elements of A, D of b.
template <int D> constexpr int parameters = D*(D + 3) / 2;

template <int D> struct Quadric {
    Matrix<D> form;       ///< A, 1/m^2
    Vector<D> linear;     ///< b, 1/m
    bool is_ellipsoid;    ///< else its half axes are those of the absolute eigenvalues
    Matrix<D> ellipsoid;  ///< of these half axes, m^2
};

/// The normal equations of the fit, gathered point by point.
template <int D> class Fit {
public:
    static constexpr int size = parameters<D>;

    /// A point, from their mean and over their spread, so that all columns are of one size.
    void add(const Vector<D>& q) {
        std::array<double, size> row{};
        int at = 0;
        for (int r = 0; r < D; ++r)
            for (int c = r; c < D; ++c) row[static_cast<std::size_t>(at++)] = (r == c ? 1.0 : 2.0) * q(r) * q(c);
        for (int r = 0; r < D; ++r) row[static_cast<std::size_t>(at++)] = 2.0 * q(r);
        // A row more of the triangle: Q'[M 1] by reflections, which squares no condition.
        for (int k = 0; k < size; ++k) rows_(size + 1, k) = row[static_cast<std::size_t>(k)];
        rows_(size + 1, size) = 1;
        rotate_in();
        ++points_;
    }

    /// Nothing where the points do not determine a quadric.
    std::optional<Quadric<D>> solve() const {
        if (points_ < size) return std::nullopt;
        std::array<double, size> p{};
        double largest = 0;
        for (int k = 0; k < size; ++k) largest = std::max(largest, std::fabs(rows_(k, k)));
        for (int k = size - 1; k >= 0; --k) {
            // Beyond what rounding leaves of a column that depends on the others.
            if (!(std::fabs(rows_(k, k)) > 1e-10 * largest)) return std::nullopt;
            double sum = rows_(k, size);
            for (int j = k + 1; j < size; ++j) sum -= rows_(k, j) * p[static_cast<std::size_t>(j)];
            p[static_cast<std::size_t>(k)] = sum / rows_(k, k);
        }
        return quadric(p);
    }

private:
    /// Givens rotations of the last row into the triangle above it.
    void rotate_in() {
        for (int k = 0; k <= size; ++k) {
            const double below = rows_(size + 1, k);
            if (below == 0) continue;
            const double length = std::hypot(rows_(k, k), below);
            const double c = rows_(k, k) / length, s = below / length;
            for (int j = k; j <= size; ++j) {
                const double upper = rows_(k, j), lower = rows_(size + 1, j);
                rows_(k, j) = c * upper + s * lower;
                rows_(size + 1, j) = c * lower - s * upper;
            }
        }
    }

    static std::optional<Quadric<D>> quadric(const std::array<double, size>& p) {
        Quadric<D> out;
        int at = 0;
        for (int r = 0; r < D; ++r)
            for (int c = r; c < D; ++c) out.form(r, c) = out.form(c, r) = p[static_cast<std::size_t>(at++)];
        for (int r = 0; r < D; ++r) out.linear(r) = p[static_cast<std::size_t>(at++)];
        Vector<D> values;
        Matrix<D> vectors;
        if (!pelorus::small::symmetric_eigen(out.form, values, vectors)) return std::nullopt;
        // (q - c)'A (q - c) = 1 + b'A^-1 b with the centre c = -A^-1 b.
        const Vector<D> along = vectors.transpose() * out.linear;
        double level = 1;
        for (int k = 0; k < D; ++k) level += along(k) * along(k) / values(k);
        out.is_ellipsoid = level > 0 && values(0) > 0;
        out.ellipsoid = Matrix<D>::Zero();
        for (int k = 0; k < D; ++k)
            pelorus::small::add_outer(std::fabs(level / values(k)), Vector<D>(vectors.col(k)), out.ellipsoid);
        if (!pelorus::small::all_finite(out.ellipsoid)) return std::nullopt;
        return out;
    }

    Matrix<size + 2, size + 1> rows_ = Matrix<size + 2, size + 1>::Zero();
    int points_ = 0;
};

}  // namespace least_squares_ellipsoid
