/// The arithmetic of one item of the Kalman filter, on packed column-major arrays that the caller owns.
///
/// Template arguments are sizes known at compile time, or Eigen::Dynamic: then the run-time sizes count, up to max_state and
/// max_measurement. All functions are pure, [worker, concurrent] [hot]; outputs may be the inputs they replace.
#pragma once

#include <pelorus/small_matrix.hpp>

namespace kalman {

namespace small = pelorus::small;

constexpr int max_state = 12, max_measurement = 6;

/// Why an item could not be worked out.
enum class Outcome { done, covariance_indefinite, noise_indefinite, innovation_singular, not_finite };

inline const char* text(Outcome outcome) noexcept {
    switch (outcome) {
        case Outcome::done:
            return "done";
        case Outcome::covariance_indefinite:
            return "the state's covariance is not positive semidefinite";
        case Outcome::noise_indefinite:
            return "the measurement noise covariance is not positive semidefinite";
        case Outcome::innovation_singular:
            return "the innovation covariance H P H' + R is not positive definite";
        case Outcome::not_finite:
            return "the result is not finite";
    }
    return "";
}

/// A matrix of Rows x Cols, or of run-time sizes up to MaxRows x MaxCols.
template <int Rows, int Cols, int MaxRows, int MaxCols>
using Sized = Eigen::Matrix<double, Rows, Cols, Eigen::ColMajor, Rows == Eigen::Dynamic ? MaxRows : Rows,
                            Cols == Eigen::Dynamic ? MaxCols : Cols>;
template <int N> using StateMatrix = Sized<N, N, max_state, max_state>;
template <int N> using StateVector = Sized<N, 1, max_state, 1>;

/// A size as the compiler knows it, where it does: loops over it are then unrolled.
template <int Fixed> constexpr int size_of(int given) noexcept { return Fixed == Eigen::Dynamic ? given : Fixed; }

/// Mean and covariance, n and n x n.
struct Moments {
    const double* mean;
    const double* covariance;
};
struct MomentsOut {
    double* mean;
    double* covariance;
};

template <class Mean, class Covariance>
Outcome store(const Mean& mean, const Covariance& covariance, const MomentsOut& out) noexcept {
    if (!small::all_finite(mean) || !small::all_finite(covariance)) return Outcome::not_finite;
    std::copy_n(mean.data(), mean.size(), out.mean);
    std::copy_n(covariance.data(), covariance.size(), out.covariance);
    return Outcome::done;
}

/// Prediction by blocks: F = F1 (x) I, Q = Q1 (x) I with F1, Q1 b x b and d axes; a state is a d x b array whose columns are
/// the derivatives, so that F x is X F1'. A d-th of the work of full products.
template <int B, int D>
Outcome predict_blocks(int derivatives, int axes, const double* f1, const double* q1, const Moments& from,
                       const MomentsOut& out) noexcept {
    constexpr int n_fixed = B == Eigen::Dynamic ? Eigen::Dynamic : B * D;
    using Block = Sized<B, B, max_state, max_state>;
    using Axes = Sized<D, B, max_state, max_state>;
    const int b = size_of<B>(derivatives), d = size_of<D>(axes), n = b * d;
    const Eigen::Map<const Block> f(f1, b, b);

    StateVector<n_fixed> mean(n, 1);
    small::multiply_transposed(Eigen::Map<const Axes>(from.mean, d, b), f, Eigen::Map<Axes>(mean.data(), d, b));

    StateMatrix<n_fixed> left(n, n), covariance(n, n);  // left = F P
    for (int c = 0; c < n; ++c)
        small::multiply_transposed(Eigen::Map<const Axes>(from.covariance + c * n, d, b), f,
                                   Eigen::Map<Axes>(left.data() + c * n, d, b));
    for (int r = 0; r < b; ++r) {
        for (int axis = 0; axis < d; ++axis) {
            const int column = r * d + axis;
            double sum[n_fixed == Eigen::Dynamic ? max_state : n_fixed] = {};
            for (int k = 0; k < b; ++k) {
                const double factor = f1[k * b + r];
                for (int i = column; i < n; ++i) sum[i] += left.data()[(k * d + axis) * n + i] * factor;
            }
            for (int k = r; k < b; ++k) sum[k * d + axis] += q1[r * b + k];
            for (int i = column; i < n; ++i)
                covariance.data()[column * n + i] = covariance.data()[i * n + column] = sum[i];
        }
    }
    return store(mean, covariance, out);
}

/// Prediction by full matrices: the predicted mean is given, the covariance becomes F P F' + Q.
template <int N>
Outcome predict_full(int size, const double* f, const double* q, const double* predicted, const double* covariance,
                     const MomentsOut& out) noexcept {
    using Matrix = StateMatrix<N>;
    const int n = size_of<N>(size);
    Matrix result(n, n);
    small::symmetric_product(Eigen::Map<const Matrix>(f, n, n), Eigen::Map<const Matrix>(covariance, n, n), result);
    for (int c = 0; c < n; ++c) {
        for (int r = c; r < n; ++r) {
            result.data()[c * n + r] += 0.5 * (q[c * n + r] + q[r * n + c]);
            result.data()[r * n + c] = result.data()[c * n + r];
        }
    }
    return store(Eigen::Map<const StateVector<N>>(predicted, n, 1), result, out);
}

/// What an update needs besides the moments: H m x n, R m x m, innovation m.
struct Measured {
    const double* jacobian;
    const double* noise;
    const double* innovation;
};
/// What it tells besides the new moments; each may be nullptr.
struct Told {
    double* log_likelihood;
    double* innovation_covariance;  // m x m
};

/// The update, in Joseph's form from factors.
///
/// With P = L L', R = N N' and G = H L, the factor of S = G G' + R is the triangle of [G N], so that S itself, in which a
/// small R beside a large P would be lost, is never formed; K = L G' S^-1. The only Cholesky factorisations are those of P
/// and R, which accept singular matrices.
template <int N, int M>
Outcome update(int states, int measured, const Moments& from, const Measured& z, const MomentsOut& out,
               const Told& told) noexcept {
    constexpr int joined_fixed = N == Eigen::Dynamic || M == Eigen::Dynamic ? Eigen::Dynamic : N + M;
    using Square = Sized<M, M, max_measurement, max_measurement>;
    using Wide = Sized<M, N, max_measurement, max_state>;
    using Joined = Sized<M, joined_fixed, max_measurement, max_state + max_measurement>;
    using Innovation = Sized<M, 1, max_measurement, 1>;

    const int n = size_of<N>(states), m = size_of<M>(measured);
    StateMatrix<N> l(n, n);
    if (!small::cholesky_semidefinite(Eigen::Map<const StateMatrix<N>>(from.covariance, n, n), l))
        return Outcome::covariance_indefinite;
    Square noise(m, m);
    if (!small::cholesky_semidefinite(Eigen::Map<const Square>(z.noise, m, m), noise)) return Outcome::noise_indefinite;
    Wide g(m, n);
    small::multiply(Eigen::Map<const Wide>(z.jacobian, m, n), l, g);

    Joined joined(m, n + m);
    std::copy_n(g.data(), m * n, joined.data());
    std::copy_n(noise.data(), m * m, joined.data() + m * n);
    small::triangularise_rows(joined, m);
    const Eigen::Map<const Square> s(joined.data(), m, m);
    if (!small::all_finite(s)) return Outcome::not_finite;
    for (int i = 0; i < m; ++i) {
        if (!(s.data()[i * m + i] > 0.0)) return Outcome::innovation_singular;
    }

    Wide weighted = g;  // S^-1 G
    small::cholesky_solve(s, weighted);
    Sized<N, M, max_state, max_measurement> gain(n, m);
    small::multiply_transposed(l, weighted, gain);

    const Eigen::Map<const Innovation> innovation(z.innovation, m, 1);
    StateVector<N> mean(n, 1);
    small::multiply(gain, innovation, mean);
    for (int i = 0; i < n; ++i) mean.data()[i] += from.mean[i];
    StateMatrix<N> covariance(n, n);
    small::joseph_update(l, g, noise, gain, covariance);

    if (told.log_likelihood != nullptr) *told.log_likelihood = small::log_normal(s, innovation);
    if (told.innovation_covariance != nullptr) small::gram(s, Eigen::Map<Square>(told.innovation_covariance, m, m));
    return store(mean, covariance, out);
}

/// H P H' (m x m) and, unless nullptr, P H' (n x m).
template <int N, int M>
void project(int states, int measured, const double* covariance, const double* jacobian, double* projected,
             double* cross) noexcept {
    using Tall = Sized<N, M, max_state, max_measurement>;
    using Wide = Sized<M, N, max_measurement, max_state>;
    using Square = Sized<M, M, max_measurement, max_measurement>;
    const int n = size_of<N>(states), m = size_of<M>(measured);
    const Eigen::Map<const StateMatrix<N>> p(covariance, n, n);
    const Eigen::Map<const Wide> h(jacobian, m, n);
    small::symmetric_product(h, p, Eigen::Map<Square>(projected, m, m));
    if (cross != nullptr) small::multiply_transposed(p, h, Eigen::Map<Tall>(cross, n, m));
}

// Chosen by size, once for an instance or a sensor.

using PredictBlocks = Outcome (*)(int, int, const double*, const double*, const Moments&, const MomentsOut&);
using PredictFull = Outcome (*)(int, const double*, const double*, const double*, const double*, const MomentsOut&);
using Update = Outcome (*)(int, int, const Moments&, const Measured&, const MomentsOut&, const Told&);
using Project = void (*)(int, int, const double*, const double*, double*, double*);

struct Kernels {
    Update update;
    Project project;
};

PredictBlocks blocks_kernel(int b, int d) noexcept;
PredictFull full_kernel(int n) noexcept;
Kernels measurement_kernels(int n, int m) noexcept;

}  // namespace kalman
