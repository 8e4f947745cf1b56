/// Factors of covariances over lanes: what makes them grow, shrink, and learn of a measurement.
///
/// L and S are lower triangular with a diagonal >= 0 and zeros above it. Shapes and threads as in algebra.hpp.
#pragma once

#include "algebra.hpp"

namespace lanes {

inline namespace PELORUS_LANES {

/// What lies above the diagonal of an n x n matrix becomes zero.
template <class N> inline void clear_above_diagonal(N size, Pack* l) noexcept {
    const int n = size;
    for (int j = 1; j < n; ++j)
        for (int i = 0; i < j; ++i) l[j * n + i] = Pack{};
}

/// The factor of L L' + C C', in place of L, by Householder reflections of [L C] from the right (Golub, Van Loan: Matrix
/// Computations, 5.2). The reflection that empties row r of C touches one column of L alone, since what is beside it in that row
/// is 0 already. C, n x columns, is used up.
template <class N, class Columns> inline void append_columns(N size, Columns columns, Pack* l, Pack* c) noexcept {
    const int n = size, k = columns;
    for (int r = 0; r < n; ++r) {
        Pack* const column = l + r * n;
        Pack tail{};
        for (int j = 0; j < k; ++j) tail += c[j * n + r] * c[j * n + r];
        // The reflection makes -norm of the head, without cancellation; the column's sign is changed then. What is not a number
        // is bent, too, so that it does not vanish.
        const Mask bent = ~(tail == 0.0);
        const Pack head = column[r], norm = square_root(head * head + tail), v = head + norm;
        const Pack beta = bent ? 1.0 / (norm * v) : Pack{}, sign = bent ? all(-1.0) : all(1.0);
        for (int i = r + 1; i < n; ++i) {
            Pack dot = column[i] * v;
            for (int j = 0; j < k; ++j) dot += c[j * n + i] * c[j * n + r];
            dot *= beta;
            column[i] = (column[i] - dot * v) * sign;
            for (int j = 0; j < k; ++j) c[j * n + i] -= dot * c[j * n + r];
        }
        column[r] = bent ? norm : head;
    }
}

/// The factor of L L' - u u', in place of L; u is used up. With L p = u and a^2 = 1 - p' p, rotations that turn [p; a] into [0; 1]
/// turn [L 0] into [the new factor, u] (Gill, Golub, Murray, Saunders: Methods for modifying matrix factorizations, 1974). Fails
/// where L L' - u u' is indefinite. `scratch` holds n.
template <class N> inline void downdate(N size, Pack* l, Pack* u, Pack* scratch, Mask& failed) noexcept {
    const int n = size;
    Pack* const p = u;
    Pack rest = all(1.0);
    for (int j = 0; j < n; ++j) {
        const Pack diagonal = l[j * n + j];
        const Mask spread = diagonal > 0.0;
        // Where L tells of no spread there can be nothing to take away.
        failed |= ~spread & ~(u[j] == 0.0);
        p[j] = spread ? u[j] / diagonal : Pack{};
        for (int i = j + 1; i < n; ++i) u[i] -= l[j * n + i] * p[j];
        rest -= p[j] * p[j];
    }
    failed |= ~(rest >= 0.0);
    Pack a = square_root(larger(rest, Pack{}));
    Pack* const column = scratch;
    for (int i = 0; i < n; ++i) column[i] = Pack{};
    for (int step = 1; step <= n; ++step) {
        const int j = n - step;
        const Mask turned = ~(p[j] == 0.0);
        const Pack norm = square_root(a * a + p[j] * p[j]), inverse = 1.0 / norm;
        const Pack c = turned ? a * inverse : all(1.0), s = turned ? p[j] * inverse : Pack{};
        a = turned ? norm : a;
        for (int i = j; i < n; ++i) {
            const Pack before = column[i];
            column[i] = c * before + s * l[j * n + i];
            l[j * n + i] = c * l[j * n + i] - s * before;
        }
    }
}

/// The array form of a measurement update: with P = S S', G = H S and R = N N',
///
///     [N G]     [Z 0 ]
///     [0 S] U = [K S+],  U orthogonal:   Z Z' = H P H' + R,   K = P H' Z'^-1,   S+ S+' = P - K K'
///
/// U is made of plane rotations that take the elements of a row of G from right to left into the diagonal of N, as in
/// Carlson's update; so S stays triangular in whatever order of its rows it is, and no matrix is formed in which a small R beside
/// a large P would be lost, nor is R inverted (N. A. Carlson, Fast triangular formulation of the square root filter, AIAA
/// Journal 11, 1973; T. Kailath, A. H. Sayed, B. Hassibi, Linear Estimation, 2000, 12.3).
/// S n x n and N m x m become S+ and Z; G m x seen, whose other columns are zero, is used up; K n x m is written. `scratch` holds
/// seen + 1.
template <class N, class M, class Seen>
inline void array_update(N states, M measured, Seen looked_at, Pack* s, Pack* noise, Pack* g, Pack* k,
                         Pack* scratch) noexcept {
    const int n = states, m = measured, seen = looked_at;
    for (int e = 0; e < n * m; ++e) k[e] = Pack{};
    for (int i = 0; i < m; ++i) {
        Pack* const pivot = noise + i * m;
        Pack* const gain = k + i * n;
        // What the pivot is after each rotation: a row's rotations leave its elements alone, so no root waits for another.
        Pack* const norm = scratch;
        Pack square = pivot[i] * pivot[i];
        norm[seen] = pivot[i];
        for (int step = 1; step <= seen; ++step) {
            const int j = seen - step;
            const Pack looks = g[j * m + i];
            square += looks * looks;
            norm[j] = looks == 0.0 ? norm[j + 1] : square_root(square);
        }
        for (int step = 1; step <= seen; ++step) {
            const int j = seen - step;
            Pack* const looks = g + j * m;
            const Mask turned = ~(looks[i] == 0.0);
            const Pack inverse = 1.0 / norm[j];
            const Pack c = turned ? norm[j + 1] * inverse : all(1.0), sine = turned ? looks[i] * inverse : Pack{};
            for (int r = i + 1; r < m; ++r) {
                const Pack before = pivot[r];
                pivot[r] = c * before + sine * looks[r];
                looks[r] = c * looks[r] - sine * before;
            }
            Pack* const column = s + j * n;
            for (int r = 0; r < n; ++r) {
                const Pack before = gain[r];
                gain[r] = c * before + sine * column[r];
                column[r] = c * column[r] - sine * before;
            }
        }
        pivot[i] = norm[0];
    }
}

/// Where column j of [K S+] lies, as reflect_update leaves it.
template <class N, class Seen>
inline Pack* column_of_update(N states, Seen looked_at, Pack* s, Pack* more, int j) noexcept {
    return j < looked_at ? s + j * states : more + (j - looked_at) * states;
}

/// The same with reflections in place of rotations, each of which takes a whole row: fewer operations and roots, for an S+ that
/// need not be triangular.
///
///     [G N]     [Z 0 ]
///     [S 0] U = [K S+]
///
/// W = [G N], m x (seen + m), becomes Z, in its first m columns. Of S, n x n, only the first `seen` columns take part, all
/// of whose numbers must be there: these and `more`, n x m, become the m columns of K and the `seen` of S+ (column_of_update).
template <class N, class M, class Seen>
inline void reflect_update(N states, M measured, Seen looked_at, Pack* w, Pack* s, Pack* more) noexcept {
    const int n = states, m = measured, seen = looked_at;
    for (int r = 0; r < m; ++r) {
        const int last =
            seen + r;  // N is a triangle: the row has zeros from there on, and so far the columns of `more`
        const Reflection by = reflection(m, r, last + 1, w);
        for (int i = r + 1; i < m; ++i) {
            Pack dot = w[r * m + i] * by.head;
            for (int j = r + 1; j <= last; ++j) dot += w[j * m + i] * w[j * m + r];
            dot *= by.scale;
            w[r * m + i] = (w[r * m + i] - dot * by.head) * by.sign;
            for (int j = r + 1; j <= last; ++j) w[j * m + i] -= dot * w[j * m + r];
        }
        Pack* const first = column_of_update(states, looked_at, s, more, r);
        for (int i = 0; i < n; ++i) {
            Pack dot = first[i] * by.head;
            for (int j = r + 1; j < last; ++j) dot += column_of_update(states, looked_at, s, more, j)[i] * w[j * m + r];
            dot *= by.scale;
            first[i] = (first[i] - dot * by.head) * by.sign;
            for (int j = r + 1; j < last; ++j) column_of_update(states, looked_at, s, more, j)[i] -= dot * w[j * m + r];
            more[r * n + i] = -(dot * w[last * m + r]);
        }
        w[r * m + r] = by.norm;
    }
}

}  // namespace PELORUS_LANES

}  // namespace lanes
