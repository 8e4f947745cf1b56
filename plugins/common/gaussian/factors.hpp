/// Factors of covariances, one by one: what makes them grow. Those of batches are in plugins/common/lanes/factors.hpp.
///
/// Arrays are packed, column-major and the caller's. N is the size where it is known at compile time, so that loops are
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

}  // namespace gaussian
