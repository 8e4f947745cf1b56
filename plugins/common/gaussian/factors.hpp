/// Factors of covariances: what makes them grow, shrink, and learn of a measurement.
///
/// Arrays are packed, column-major and the caller's. N (or M) is the size where it is known at compile time, so that loops are
/// unrolled, and 0 where the run-time size counts, up to max_n. [worker, concurrent] [hot]: no allocation, no exception.
#pragma once

#include <cmath>

#include <pelorus/small_matrix.hpp>

namespace gaussian {

namespace small = pelorus::small;

/// The lower triangular factor of L L' + C C', in place of L, by Householder reflections of [L C] from the right (Golub, Van
/// Loan: Matrix Computations, 5.2). The reflection that empties row r of C touches one column of L alone, since what is
/// beside it in that row is 0 already. L: n x n, diagonal >= 0; C: n x k, is used up. The diagonal stays >= 0.
template <int N, int max_n> void append_columns(int size, double* l, double* c, int k) noexcept {
    const int n = N > 0 ? N : size;
    for (int r = 0; r < n; ++r) {
        double tail = 0.0;
        for (int j = 0; j < k; ++j) tail += c[j * n + r] * c[j * n + r];
        if (tail == 0.0) continue;
        double* const column = l + r * n;
        const double head = column[r], norm = std::sqrt(head * head + tail);
        const double v = -tail / (head + norm);  // head - norm without cancellation
        const double beta = 2.0 / (v * v + tail);
        // All rows where their number is known: those above are 0 and stay 0, and the loops are unrolled.
        const int first = N > 0 ? 0 : r;
        double dot[max_n];
        for (int i = first; i < n; ++i) dot[i] = column[i] * v;
        for (int j = 0; j < k; ++j) {
            const double factor = c[j * n + r];
            for (int i = first; i < n; ++i) dot[i] += c[j * n + i] * factor;
        }
        for (int i = first; i < n; ++i) {
            dot[i] *= beta;
            column[i] -= dot[i] * v;
        }
        column[r] = norm;
        for (int j = 0; j < k; ++j) {
            const double factor = c[j * n + r];
            for (int i = first; i < n; ++i) c[j * n + i] -= dot[i] * factor;
            c[j * n + r] = 0.0;
        }
    }
}

/// The lower triangular factor of L L' - u u', in place of L; u is used up. With L p = u and a^2 = 1 - p' p, rotations that turn
/// [p; a] into [0; 1] turn [L 0] into [the new factor, u] (Gill, Golub, Murray, Saunders: Methods for modifying matrix
/// factorizations, 1974). False where L L' - u u' is indefinite.
template <int max_n> [[nodiscard]] bool downdate(int n, double* l, double* u) noexcept {
    double p[max_n], rest = 1.0;
    for (int j = 0; j < n; ++j) {
        const double diagonal = l[j * n + j];
        // Where L tells of no spread there can be nothing to take away.
        if (!(diagonal > 0.0) && u[j] != 0.0) return false;
        p[j] = diagonal > 0.0 ? u[j] / diagonal : 0.0;
        for (int i = j + 1; i < n; ++i) u[i] -= l[j * n + i] * p[j];
        rest -= p[j] * p[j];
    }
    if (!(rest >= 0.0)) return false;
    double a = std::sqrt(rest);
    double column[max_n] = {};
    for (int j = n - 1; j >= 0; --j) {
        if (p[j] == 0.0) continue;
        const double norm = std::sqrt(a * a + p[j] * p[j]), c = a / norm, s = p[j] / norm;
        a = norm;
        for (int i = j; i < n; ++i) {
            const double before = column[i];
            column[i] = c * before + s * l[j * n + i];
            l[j * n + i] = c * l[j * n + i] - s * before;
        }
    }
    return true;
}

/// The array form of a measurement update: with P = S S', G = H S and R = N N',
///
///     [N G]     [Z 0 ]
///     [0 S] U = [K S+],  U orthogonal:   Z Z' = H P H' + R,   K = P H' Z'^-1,   S+ S+' = P - K K'
///
/// U is made of plane rotations that take the elements of a row of G from right to left into the diagonal of N, as in
/// Carlson's update; so S stays lower triangular with a diagonal >= 0, and no matrix is formed in which a small R beside a
/// large P would be lost, nor is R inverted (N. A. Carlson, Fast triangular formulation of the square root filter, AIAA
/// Journal 11, 1973; T. Kailath, A. H. Sayed, B. Hassibi, Linear Estimation, 2000, 12.3).
/// S n x n and N m x m lower triangular, become S+ and Z; G m x n is used up; K n x m is written.
template <int N, int M>
void array_update(int states, int measured, double* s, double* noise, double* g, double* k) noexcept {
    const int n = N > 0 ? N : states, m = M > 0 ? M : measured;
    for (int e = 0; e < n * m; ++e) k[e] = 0.0;
    for (int i = 0; i < m; ++i) {
        double* const pivot = noise + i * m;
        double* const gain = k + i * n;
        for (int j = n - 1; j >= 0; --j) {
            double* const looks = g + j * m;
            if (looks[i] == 0.0) continue;
            const double norm = std::sqrt(pivot[i] * pivot[i] + looks[i] * looks[i]), inverse = 1.0 / norm;
            const double c = pivot[i] * inverse, sine = looks[i] * inverse;
            pivot[i] = norm;
            for (int r = i + 1; r < m; ++r) {
                const double before = pivot[r];
                pivot[r] = c * before + sine * looks[r];
                looks[r] = c * looks[r] - sine * before;
            }
            double* const column = s + j * n;
            // From the diagonal on; all rows where their number is known: those above are 0 and stay 0.
            for (int r = N > 0 ? 0 : j; r < n; ++r) {
                const double before = gain[r];
                gain[r] = c * before + sine * column[r];
                column[r] = c * column[r] - sine * before;
            }
        }
    }
}

}  // namespace gaussian
