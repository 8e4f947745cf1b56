/// Dense products and factorisations of small matrices: the loops that filters spend their time in.
///
/// Purpose  Eigen's types hold the numbers and wrap the arrays of the ABI; these templated loops do the arithmetic. A loop
///          over sizes known at compile time is unrolled and vectorised like Eigen's expressions, and compiles in a
///          fraction of their time.
/// Types    Any column-major dense type with data(), rows(), cols() and Eigen's compile-time sizes, of bounded size:
///          pelorus::Matrix<R, C>, small::Bounded<R, C>, Eigen::Map of either.
/// Outputs  Are given, have the right size and overlap no input, except where a function says that they may.
/// Threads  All functions are pure: [worker, concurrent] [hot], no allocation, no exception.
/// Errors   Factorisations answer false where the matrix is not what they need; their output is then undefined. Sizes that
///          do not agree are a static assertion where both are fixed, else an assertion.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <type_traits>

#include <Eigen/Core>

namespace pelorus::small {

using Index = Eigen::Index;

/// A matrix whose sizes are known when it is made, up to a bound; it lies where it is declared, never on the heap.
template <int MaxRows, int MaxCols>
using Bounded = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, MaxRows, MaxCols>;

namespace detail {

template <class A> using plain = std::remove_cv_t<std::remove_reference_t<A>>;
template <class A> inline constexpr int rows_of = plain<A>::RowsAtCompileTime;
template <class A> inline constexpr int cols_of = plain<A>::ColsAtCompileTime;

template <int Max> constexpr int bounded() {
    static_assert(Max != Eigen::Dynamic, "the sizes of a small matrix must be bounded");
    return Max;
}
template <class A> constexpr int max_rows() { return bounded<plain<A>::MaxRowsAtCompileTime>(); }
template <class A> constexpr int max_cols() { return bounded<plain<A>::MaxColsAtCompileTime>(); }

/// Rows (or columns) that must agree: at compile time where both are fixed, by assertion otherwise.
template <int A, int B> inline void agree([[maybe_unused]] Index a, [[maybe_unused]] Index b) noexcept {
    static_assert(A == B || A == Eigen::Dynamic || B == Eigen::Dynamic, "sizes of matrices do not agree");
    assert(a == b);
}

/// Where the product of an A and a B is kept.
template <class A, class B>
using Product =
    Eigen::Matrix<double, rows_of<A>, cols_of<B>,
                  rows_of<A> == 1 && cols_of<B> != 1 ? Eigen::RowMajor : Eigen::ColMajor, max_rows<A>(), max_cols<B>()>;

/// out = A B or A B'.
template <bool transpose_b, class A, class B, class C> inline void product(const A& a, const B& b, C& out) noexcept {
    const Index rows = a.rows(), inner = a.cols(), cols = transpose_b ? b.rows() : b.cols(), ldb = b.rows();
    agree<cols_of<A>, transpose_b ? cols_of<B> : rows_of<B>>(inner, transpose_b ? b.cols() : b.rows());
    agree<rows_of<A>, rows_of<C>>(rows, out.rows());
    agree<transpose_b ? rows_of<B> : cols_of<B>, cols_of<C>>(cols, out.cols());
    const double *const x = a.data(), *const y = b.data();
    for (Index j = 0; j < cols; ++j) {
        double sum[max_rows<A>()] = {};
        for (Index k = 0; k < inner; ++k) {
            const double factor = transpose_b ? y[k * ldb + j] : y[j * ldb + k];
            for (Index i = 0; i < rows; ++i) sum[i] += x[k * rows + i] * factor;
        }
        double* const column = out.data() + j * rows;
        for (Index i = 0; i < rows; ++i) column[i] = sum[i];
    }
}

/// out = or out += A B', known to be symmetric: the lower triangle is computed, the upper one is its mirror.
template <bool add, class A, class B, class C>
inline void symmetric_product_transposed(const A& a, const B& b, C& out) noexcept {
    const Index n = a.rows(), inner = a.cols();
    agree<cols_of<A>, cols_of<B>>(inner, b.cols());
    agree<rows_of<A>, rows_of<B>>(n, b.rows());
    agree<rows_of<A>, rows_of<C>>(n, out.rows());
    agree<rows_of<A>, cols_of<C>>(n, out.cols());
    const double *const x = a.data(), *const y = b.data();
    double* const z = out.data();
    for (Index j = 0; j < n; ++j) {
        // Whole columns where their length is known: that is unrolled, which beats half the work in loops of changing length.
        const Index first = rows_of<A> == Eigen::Dynamic ? j : 0;
        double sum[max_rows<A>()] = {};
        for (Index k = 0; k < inner; ++k) {
            const double factor = y[k * n + j];
            for (Index i = first; i < n; ++i) sum[i] += x[k * n + i] * factor;
        }
        for (Index i = j; i < n; ++i) {
            z[j * n + i] = add ? z[j * n + i] + sum[i] : sum[i];
            z[i * n + j] = z[j * n + i];
        }
    }
}

}  // namespace detail

/// out = A B.
template <class A, class B, class C> inline void multiply(const A& a, const B& b, C&& out) noexcept {
    detail::product<false>(a, b, out);
}

/// out = A B'.
template <class A, class B, class C> inline void multiply_transposed(const A& a, const B& b, C&& out) noexcept {
    detail::product<true>(a, b, out);
}

/// out = A P A' for a symmetric P; exactly symmetric.
template <class A, class P, class C> inline void symmetric_product(const A& a, const P& p, C&& out) noexcept {
    detail::Product<A, P> ap(a.rows(), p.cols());
    multiply(a, p, ap);
    detail::symmetric_product_transposed<false>(ap, a, out);
}

/// out = A A'; exactly symmetric, never a negative diagonal.
template <class A, class C> inline void gram(const A& a, C&& out) noexcept {
    detail::symmetric_product_transposed<false>(a, a, out);
}

/// out += A A': a symmetric update of as many ranks as A has columns.
template <class A, class C> inline void add_gram(const A& a, C&& out) noexcept {
    detail::symmetric_product_transposed<true>(a, a, out);
}

/// out += factor x x'.
template <class X, class C> inline void add_outer(double factor, const X& x, C&& out) noexcept {
    const Index n = x.size();
    detail::agree<detail::rows_of<C>, detail::cols_of<C>>(n, out.rows());
    assert(n == out.cols());
    for (Index j = 0; j < n; ++j) {
        const double scaled = factor * x.data()[j];
        for (Index i = j; i < n; ++i) {
            out.data()[j * n + i] += x.data()[i] * scaled;
            out.data()[i * n + j] = out.data()[j * n + i];
        }
    }
}

/// A = (A + A') / 2.
template <class A> inline void symmetrise(A&& a) noexcept {
    const Index n = a.rows();
    detail::agree<detail::rows_of<A>, detail::cols_of<A>>(n, a.cols());
    double* const x = a.data();
    for (Index j = 0; j < n; ++j) {
        for (Index i = j + 1; i < n; ++i) x[j * n + i] = x[i * n + j] = 0.5 * (x[j * n + i] + x[i * n + j]);
    }
}

/// True where no element is infinite or NaN.
template <class A> [[nodiscard]] inline bool all_finite(const A& a) noexcept {
    // 0 x is NaN for every x that is not finite: sums instead of a test an element; several, so that one addition does not
    // wait for the one before it.
    constexpr Index lanes = 8;
    const double* const x = a.data();
    const Index size = a.size(), whole = size - size % lanes;
    double sum[lanes] = {};
    for (Index k = 0; k < whole; k += lanes)
        for (Index lane = 0; lane < lanes; ++lane) sum[lane] += 0.0 * x[k + lane];
    for (Index k = whole; k < size; ++k) sum[0] += 0.0 * x[k];
    for (Index lane = 1; lane < lanes; ++lane) sum[0] += sum[lane];
    return sum[0] == 0.0;
}

namespace detail {

/// Cholesky by columns; pivot(value, diagonal) turns the raw pivot into the one to use, or one below 0: give up.
template <class A, class L, class Pivot>
[[nodiscard]] inline bool cholesky_by_columns(const A& a, L& l, Pivot pivot) noexcept {
    const Index n = a.rows();
    agree<rows_of<A>, cols_of<A>>(n, a.cols());
    agree<rows_of<A>, rows_of<L>>(n, l.rows());
    agree<cols_of<A>, cols_of<L>>(n, l.cols());
    double* const f = l.data();
    for (Index j = 0; j < n; ++j) {
        double column[max_rows<A>()];
        for (Index i = j; i < n; ++i) column[i] = a.data()[j * n + i];
        const double diagonal = column[j];
        for (Index k = 0; k < j; ++k) {
            const double factor = f[k * n + j];
            for (Index i = j; i < n; ++i) column[i] -= f[k * n + i] * factor;
        }
        const double root = std::sqrt(pivot(column[j], diagonal));
        if (!(root >= 0.0)) return false;
        const double inverse = root > 0.0 ? 1.0 / root : 0.0;
        for (Index i = 0; i < j; ++i) f[j * n + i] = 0.0;
        f[j * n + j] = root;
        for (Index i = j + 1; i < n; ++i) f[j * n + i] = column[i] * inverse;
    }
    return all_finite(l);
}

}  // namespace detail

/// A = L L' with L lower triangular; reads A's lower triangle, may be done in place. False where A is not positive
/// definite or not finite.
template <class A, class L> [[nodiscard]] inline bool cholesky(const A& a, L&& l) noexcept {
    return detail::cholesky_by_columns(a, l, [](double value, double) { return value > 0.0 ? value : -1.0; });
}

/// The same for a covariance that may be singular, or no longer positive definite by rounding.
///
/// A pivot below n eps of its diagonal element (where rounding has eaten what was there) is raised to that: what the
/// number format has lost counts as unknown, not as known exactly. A component of no variance gives a zero column.
/// False where A is not finite or is indefinite beyond any rounding (a pivot below -1e-8 of its diagonal element).
template <class A, class L> [[nodiscard]] inline bool cholesky_semidefinite(const A& a, L&& l) noexcept {
    const double floor = static_cast<double>(a.rows()) * std::numeric_limits<double>::epsilon();
    return detail::cholesky_by_columns(a, l, [floor](double value, double diagonal) {
        return value < -1e-8 * diagonal ? -1.0 : std::max(std::fabs(value), floor * diagonal);
    });
}

/// B = L^-1 B for a lower triangular L of positive diagonal.
template <class L, class B> inline void solve_lower(const L& l, B&& b) noexcept {
    const Index n = l.rows();
    detail::agree<detail::rows_of<L>, detail::rows_of<B>>(n, b.rows());
    const double* const f = l.data();
    for (Index c = 0; c < b.cols(); ++c) {
        double* const x = b.data() + c * n;
        for (Index j = 0; j < n; ++j) {
            x[j] /= f[j * n + j];
            for (Index i = j + 1; i < n; ++i) x[i] -= f[j * n + i] * x[j];
        }
    }
}

/// B = L'^-1 B for a lower triangular L of positive diagonal.
template <class L, class B> inline void solve_lower_transposed(const L& l, B&& b) noexcept {
    const Index n = l.rows();
    detail::agree<detail::rows_of<L>, detail::rows_of<B>>(n, b.rows());
    const double* const f = l.data();
    for (Index c = 0; c < b.cols(); ++c) {
        double* const x = b.data() + c * n;
        for (Index j = n - 1; j >= 0; --j) {
            for (Index i = j + 1; i < n; ++i) x[j] -= f[j * n + i] * x[i];
            x[j] /= f[j * n + j];
        }
    }
}

/// B = A^-1 B with A = L L'.
template <class L, class B> inline void cholesky_solve(const L& l, B&& b) noexcept {
    solve_lower(l, b);
    solve_lower_transposed(l, b);
}

/// ln det A with A = L L'.
template <class L> [[nodiscard]] inline double log_determinant(const L& l) noexcept {
    double sum = 0.0;
    for (Index j = 0; j < l.rows(); ++j) sum += std::log(l.data()[j * l.rows() + j]);
    return 2.0 * sum;
}

/// e' A^-1 e with A = L L' (a squared Mahalanobis distance).
template <class L, class E> [[nodiscard]] inline double inverse_quadratic(const L& l, const E& e) noexcept {
    detail::Product<L, E> scaled(l.rows(), 1);
    std::copy_n(e.data(), l.rows(), scaled.data());
    solve_lower(l, scaled);
    double sum = 0.0;
    for (Index i = 0; i < l.rows(); ++i) sum += scaled.data()[i] * scaled.data()[i];
    return sum;
}

/// ln N(e; 0, A) with A = L L'.
template <class L, class E> [[nodiscard]] inline double log_normal(const L& l, const E& e) noexcept {
    constexpr double log_two_pi = 1.8378770664093454836;
    return -0.5 * (static_cast<double>(l.rows()) * log_two_pi + log_determinant(l) + inverse_quadratic(l, e));
}

/// Turns the first `count` rows of W (at least as many columns) into lower triangular form with a diagonal >= 0, by
/// Householder reflections from the right: W W' stays what it was (Golub, Van Loan: Matrix Computations, 5.2).
template <class W> inline void triangularise_rows(W&& w, Index count) noexcept {
    const Index rows = w.rows(), cols = w.cols();
    assert(count <= rows && count <= cols);
    double* const x = w.data();
    for (Index r = 0; r < count; ++r) {
        double v[detail::max_cols<W>()] = {};
        double tail = 0.0;
        for (Index j = r; j < cols; ++j) v[j] = x[j * rows + r];
        for (Index j = r + 1; j < cols; ++j) tail += v[j] * v[j];
        const double head = v[r];
        if (tail > 0.0) {
            const double norm = std::sqrt(head * head + tail);
            // head - norm without cancellation; the diagonal becomes +norm.
            v[r] = head <= 0.0 ? head - norm : -tail / (head + norm);
            const double beta = 2.0 / (v[r] * v[r] + tail);
            double dot[detail::max_rows<W>()] = {};
            for (Index j = r; j < cols; ++j) {
                for (Index i = r; i < rows; ++i) dot[i] += x[j * rows + i] * v[j];
            }
            for (Index j = r; j < cols; ++j) {
                const double factor = beta * v[j];
                for (Index i = r + 1; i < rows; ++i) x[j * rows + i] -= dot[i] * factor;
                x[j * rows + r] = 0.0;
            }
            x[r * rows + r] = norm;
        } else if (head < 0.0) {
            for (Index i = r; i < rows; ++i) x[r * rows + i] = -x[r * rows + i];
        }
    }
}

/// The covariance after an update, in Joseph's form, from factors: with P = L L', R = N N' and G = H L,
///     out = (I - K H) P (I - K H)' + K R K' = (L - K G)(L - K G)' + (K N)(K N)'
/// for any gain K, optimal or not. A sum of squares: symmetric, its diagonal never negative, and an error of the gain enters
/// only as its square (Bucy, Joseph: Filtering for Stochastic Processes with Applications to Guidance, 1968).
/// Shapes: L n x n, G m x n, N m x m, K n x m, out n x n.
template <class L, class G, class N, class K, class C>
inline void joseph_update(const L& l, const G& g, const N& noise, const K& k, C&& out) noexcept {
    const Index n = l.rows();
    detail::Product<K, G> rest(n, n);
    multiply(k, g, rest);
    for (Index e = 0; e < n * n; ++e) rest.data()[e] = l.data()[e] - rest.data()[e];
    detail::Product<K, N> noise_share(n, noise.cols());
    multiply(k, noise, noise_share);
    gram(rest, out);
    add_gram(noise_share, out);
}

/// Eigenvalues (ascending) and orthonormal eigenvectors (columns) of a symmetric A by cyclic Jacobi rotations, which find
/// the small eigenvalues of a positive definite matrix as exactly as the large ones (Golub, Van Loan, 8.5; Demmel,
/// Veselic 1992). Reads A's lower triangle. Shapes: A n x n, values n, vectors n x n. False where A is not finite.
template <class A, class D, class V>
[[nodiscard]] inline bool symmetric_eigen(const A& a, D&& values, V&& vectors) noexcept {
    const Index n = a.rows();
    detail::agree<detail::rows_of<A>, detail::cols_of<A>>(n, a.cols());
    detail::agree<detail::rows_of<A>, detail::rows_of<V>>(n, vectors.rows());
    assert(values.size() == n);
    double w[detail::max_rows<A>()][detail::max_rows<A>()];
    double* const v = vectors.data();
    for (Index j = 0; j < n; ++j) {
        for (Index i = j; i < n; ++i) w[i][j] = w[j][i] = a.data()[j * n + i];
        for (Index i = 0; i < n; ++i) v[j * n + i] = i == j ? 1.0 : 0.0;
    }
    if (!all_finite(a)) return false;
    bool rotated = true;
    for (int sweep = 0; rotated && sweep < 40; ++sweep) {
        rotated = false;
        for (Index p = 0; p < n; ++p) {
            for (Index q = p + 1; q < n; ++q) {
                const double off = w[p][q];
                // Below that it changes neither eigenvalue: relative to both diagonal elements, not to the largest one.
                const double negligible = std::sqrt(std::fabs(w[p][p])) * std::sqrt(std::fabs(w[q][q]));
                if (std::fabs(off) <= 0.5 * std::numeric_limits<double>::epsilon() * negligible) continue;
                rotated = true;
                const double theta = 0.5 * (w[q][q] - w[p][p]) / off;
                const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::hypot(1.0, theta));
                const double c = 1.0 / std::hypot(1.0, t), s = t * c;
                w[p][p] -= t * off;
                w[q][q] += t * off;
                w[p][q] = w[q][p] = 0.0;
                for (Index k = 0; k < n; ++k) {
                    if (k != p && k != q) {
                        const double kp = w[k][p], kq = w[k][q];
                        w[k][p] = w[p][k] = c * kp - s * kq;
                        w[k][q] = w[q][k] = s * kp + c * kq;
                    }
                    const double vp = v[p * n + k], vq = v[q * n + k];
                    v[p * n + k] = c * vp - s * vq;
                    v[q * n + k] = s * vp + c * vq;
                }
            }
        }
    }
    for (Index j = 0; j < n; ++j) values.data()[j] = w[j][j];
    for (Index j = 0; j + 1 < n; ++j) {
        const Index least = std::min_element(values.data() + j, values.data() + n) - values.data();
        if (least != j) std::swap_ranges(v + j * n, v + (j + 1) * n, v + least * n);
        std::swap(values.data()[j], values.data()[least]);
    }
    return true;
}

namespace detail {

/// out = V f(D) V' for A = V D V'; false where f answers something that is not finite.
template <class A, class C, class Function>
[[nodiscard]] inline bool spectral(const A& a, C& out, Function function) noexcept {
    Product<A, A> vectors(a.rows(), a.rows()), scaled(a.rows(), a.rows());
    Eigen::Matrix<double, rows_of<A>, 1, Eigen::ColMajor, max_rows<A>(), 1> values(a.rows());
    if (!symmetric_eigen(a, values, vectors)) return false;
    const Index n = a.rows();
    for (Index j = 0; j < n; ++j) {
        const double factor = function(values.data()[j], values.data()[n - 1]);
        for (Index i = 0; i < n; ++i) scaled.data()[j * n + i] = vectors.data()[j * n + i] * factor;
    }
    if (!all_finite(scaled)) return false;
    symmetric_product_transposed<false>(scaled, vectors, out);
    return true;
}

}  // namespace detail

/// out = A^1/2, symmetric, for a positive semidefinite A. False where A is not finite, or an eigenvalue is negative beyond
/// what rounding makes of 0 (n eps of the largest).
template <class A, class C> [[nodiscard]] inline bool square_root(const A& a, C&& out) noexcept {
    const double tolerance = static_cast<double>(a.rows()) * std::numeric_limits<double>::epsilon();
    return detail::spectral(a, out, [tolerance](double value, double largest) {
        return value < 0.0 && value >= -tolerance * largest ? 0.0 : std::sqrt(value);
    });
}

/// out = A^-1/2, symmetric, for a positive definite A. False where it is not.
template <class A, class C> [[nodiscard]] inline bool inverse_square_root(const A& a, C&& out) noexcept {
    return detail::spectral(a, out, [](double value, double) { return 1.0 / std::sqrt(value); });
}

}  // namespace pelorus::small
