/// Dense products and factorisations of small matrices of `width` items at once: pelorus/small_matrix.hpp over lanes.
///
/// Shapes   Matrices are column-major arrays of Packs without gaps; sizes are ints or, where the compiler is to know them,
///          Fixed<N>. Outputs overlap no input, except where a function says that they may.
/// Errors   A factorisation adds the lanes in which it failed to a mask; what it leaves there is undefined, the others are as
///          if they stood alone.
/// Threads  All functions are pure: [worker, concurrent] [hot].
#pragma once

#include "pack.hpp"

namespace lanes {

inline namespace PELORUS_LANES {

/// Columns [first, end) of the lower triangular L with A = L L', once those before are there, for a covariance that may be
/// singular: pelorus::small::cholesky_semidefinite over lanes, with the same rule for pivots that rounding has eaten. Reads A's lower
/// triangle, writes L's; may be done in place.
template <class N>
inline void cholesky_columns(N size, int first, int end, const Pack* a, Pack* l, Mask& failed) noexcept {
    const int n = size;
    const double floor = n * std::numeric_limits<double>::epsilon();
    for (int j = first; j < end; ++j) {
        const Pack diagonal = a[j * n + j];
        Pack value = diagonal;
        for (int k = 0; k < j; ++k) value -= l[k * n + j] * l[k * n + j];
        failed |= value < -1e-8 * diagonal;
        const Pack pivot = larger(absolute(value), floor * diagonal), root = square_root(pivot);
        // An element of L that is not finite, or its square, would show in the root of its own row.
        failed |= ~is_finite(root);
        // 1 / root, without waiting for the root. Where the pivot has no reciprocal, there is nothing to divide.
        const Pack inverse = pivot >= std::numeric_limits<double>::min() ? root * (1.0 / pivot) : Pack{};
        l[j * n + j] = root;
        for (int i = j + 1; i < n; ++i) {
            Pack sum = a[j * n + i];
            for (int k = 0; k < j; ++k) sum -= l[k * n + i] * l[k * n + j];
            l[j * n + i] = sum * inverse;
        }
    }
}

/// All columns.
template <class N> inline void cholesky_semidefinite(N size, const Pack* a, Pack* l, Mask& failed) noexcept {
    cholesky_columns(size, 0, size, a, l, failed);
}

/// A Householder reflection that takes a row to (norm, 0, 0, ...), but for its sign: x becomes x - scale (x . v) v, v = (head, what
/// stands behind it in the row), and the first element then changes by `sign` (Golub, Van Loan: Matrix Computations, 5.1).
struct Reflection {
    Pack head, scale, sign, norm;
};

/// That of row r of W (rows x columns) from column r on.
template <class Rows, class Columns>
inline Reflection reflection(Rows rows, int r, Columns columns, const Pack* w) noexcept {
    const Pack head = w[r * rows + r];
    Pack tail{};
    for (int j = r + 1; j < columns; ++j) tail += w[j * rows + r] * w[j * rows + r];
    // The reflection makes -norm of a positive head, without cancellation; the column's sign is changed then. A row that
    // has its form already changes at most its sign.
    const Mask bent = tail > 0.0, positive = head > 0.0;
    const Pack norm = square_root(head * head + tail), sum = absolute(head) + norm;
    return {bent ? (positive ? sum : -sum) : all(1.0),                     //
            bent ? 1.0 / (norm * sum) : (head < 0.0 ? all(2.0) : Pack{}),  //
            bent & positive ? all(-1.0) : all(1.0), bent ? norm : absolute(head)};
}

/// Turns the rows of W (rows <= columns) into lower triangular form with a diagonal >= 0, by reflections from the right: W W' stays
/// what it was. What was above the diagonal is left undefined.
template <class Rows, class Columns> inline void triangularise_rows(Rows rows_size, Columns columns, Pack* w) noexcept {
    const int rows = rows_size, cols = columns;
    for (int r = 0; r < rows; ++r) {
        const Reflection by = reflection(rows_size, r, columns, w);
        for (int i = r + 1; i < rows; ++i) {
            Pack dot = w[r * rows + i] * by.head;
            for (int j = r + 1; j < cols; ++j) dot += w[j * rows + i] * w[j * rows + r];
            dot *= by.scale;
            w[r * rows + i] = (w[r * rows + i] - dot * by.head) * by.sign;
            for (int j = r + 1; j < cols; ++j) w[j * rows + i] -= dot * w[j * rows + r];
        }
        w[r * rows + r] = by.norm;
    }
}

/// B = (L L')^-1 B for a lower triangular L, n x n, given 1 / its diagonal; B is n x columns.
template <class N, class Columns>
inline void cholesky_solve(N size, Columns columns, const Pack* l, const Pack* inverse_diagonal, Pack* b) noexcept {
    const int n = size;
    for (int c = 0; c < columns; ++c) {
        Pack* const x = b + c * n;
        for (int j = 0; j < n; ++j) {
            for (int k = 0; k < j; ++k) x[j] -= l[k * n + j] * x[k];
            x[j] *= inverse_diagonal[j];
        }
        for (int j = n - 1; j >= 0; --j) {
            for (int i = j + 1; i < n; ++i) x[j] -= l[j * n + i] * x[i];
            x[j] *= inverse_diagonal[j];
        }
    }
}

/// L^-1 e for a lower triangular L, given 1 / its diagonal.
template <class N>
inline void whiten(N size, const Pack* l, const Pack* inverse_diagonal, const Pack* e, Pack* out) noexcept {
    const int n = size;
    for (int j = 0; j < n; ++j) {
        Pack scaled = e[j];
        for (int k = 0; k < j; ++k) scaled -= l[k * n + j] * out[k];
        out[j] = scaled * inverse_diagonal[j];
    }
}

/// ln N(e; 0, L L') for a lower triangular L of positive diagonal, given `whitened` = L^-1 e.
template <class N> inline Pack log_normal(N size, const Pack* l, const Pack* whitened) noexcept {
    constexpr double log_two_pi = 1.8378770664093454836;
    const int n = size;
    Pack sum = all(0.5 * n * log_two_pi);
    for (int j = 0; j < n; ++j) sum += logarithm(l[j * n + j]) + 0.5 * (whitened[j] * whitened[j]);
    return -sum;
}

/// The same, given 1 / the diagonal of L.
template <class N>
inline Pack log_normal(N size, const Pack* l, const Pack* inverse_diagonal, const Pack* e, Pack* scratch) noexcept {
    whiten(size, l, inverse_diagonal, e, scratch);
    return log_normal(size, l, scratch);
}

/// out = A A' for an n x columns A; both triangles.
template <class N, class Columns> inline void gram(N size, Columns columns, const Pack* a, Pack* out) noexcept {
    const int n = size;
    for (int j = 0; j < n; ++j) {
        for (int i = j; i < n; ++i) {
            Pack sum{};
            for (int k = 0; k < columns; ++k) sum += a[k * n + i] * a[k * n + j];
            out[j * n + i] = out[i * n + j] = sum;
        }
    }
}

}  // namespace PELORUS_LANES

}  // namespace lanes
