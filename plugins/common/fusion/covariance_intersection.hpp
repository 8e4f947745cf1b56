/// Covariance intersection: one estimate from several whose errors may be correlated in ways that nobody knows.
///
///     P^-1 = sum w_i P_i^-1      x = P sum w_i P_i^-1 x_i      w_i >= 0, sum w_i = 1
///
/// Whatever the cross-correlations, P is not less than the covariance of the error of x, if no P_i is less than its own.
///
/// Source: S. J. Julier, J. K. Uhlmann, A Non-divergent Estimation Algorithm in the Presence of Unknown Correlations,
/// Proceedings of the American Control Conference, 2369-2373, 1997.
/// All functions are pure: [worker, concurrent] [hot]. False where a covariance is not positive definite.
#pragma once

#include <pelorus/small_matrix.hpp>

namespace fusion {

/// Mean (n x 1) and covariance (n x n) in components that all have in common; differences of angles are the caller's to wrap.
template <int Max> struct Estimate {
    pelorus::small::Bounded<Max, 1> mean;
    pelorus::small::Bounded<Max, Max> covariance;
};

/// What is made least by the weight of two estimates.
enum class Criterion { determinant, trace };

namespace detail {

/// out = A^-1 for a symmetric positive definite A.
template <class A> [[nodiscard]] bool invert(const A& a, A& out) noexcept {
    A root(a.rows(), a.cols());
    if (!pelorus::small::cholesky(a, root)) return false;
    out = A::Identity(a.rows(), a.cols());
    pelorus::small::cholesky_solve(root, out);
    pelorus::small::symmetrise(out);
    return true;
}

/// Slope of the criterion over the weight of A in P^-1 = w A + (1 - w) B: of ln det P it is -tr[P (A - B)], of tr P it is
/// -tr[P (A - B) P]. Both criteria are convex in w, so that it never falls.
template <class M>
[[nodiscard]] bool slope(const M& a, const M& b, double weight, Criterion criterion, double& out) noexcept {
    M information(a.rows(), a.cols()), p(a.rows(), a.cols()), product(a.rows(), a.cols()), left(a.rows(), a.cols());
    for (Eigen::Index i = 0; i < a.size(); ++i)
        information.data()[i] = weight * a.data()[i] + (1 - weight) * b.data()[i];
    if (!invert(information, p)) return false;
    for (Eigen::Index i = 0; i < a.size(); ++i) left.data()[i] = a.data()[i] - b.data()[i];
    pelorus::small::multiply(p, left, product);
    if (criterion == Criterion::trace) {
        left = product;
        pelorus::small::multiply(left, p, product);
    }
    out = 0;
    for (Eigen::Index i = 0; i < a.rows(); ++i) out -= product(i, i);
    return true;
}

}  // namespace detail

/// Fuses `count` estimates, one at least, by the weights given; an estimate of weight 0 does not matter.
template <int Max>
[[nodiscard]] bool covariance_intersection(const Estimate<Max>* estimates, const double* weights, int count,
                                           Estimate<Max>& out) noexcept {
    const auto n = estimates[0].mean.rows();
    pelorus::small::Bounded<Max, Max> information = pelorus::small::Bounded<Max, Max>::Zero(n, n), inverse(n, n);
    pelorus::small::Bounded<Max, 1> sum = pelorus::small::Bounded<Max, 1>::Zero(n, 1), told(n, 1);
    for (int k = 0; k < count; ++k) {
        if (weights[k] == 0) continue;
        if (!detail::invert(estimates[k].covariance, inverse)) return false;
        pelorus::small::multiply(inverse, estimates[k].mean, told);
        for (Eigen::Index i = 0; i < inverse.size(); ++i) information.data()[i] += weights[k] * inverse.data()[i];
        for (Eigen::Index i = 0; i < n; ++i) sum.data()[i] += weights[k] * told.data()[i];
    }
    out.mean = sum;
    out.covariance = information;
    if (!detail::invert(information, out.covariance)) return false;
    pelorus::small::multiply(out.covariance, sum, out.mean);
    return true;
}

/// Fuses two estimates by the weight that makes the determinant or the trace of P least; `weight` answers that of `a`. The
/// criterion is convex in it: its slope is bisected, to 2^-50, or the better estimate stands alone.
template <int Max>
[[nodiscard]] bool covariance_intersection(const Estimate<Max>& a, const Estimate<Max>& b, Criterion criterion,
                                           double& weight, Estimate<Max>& out) noexcept {
    const auto n = a.mean.rows();
    pelorus::small::Bounded<Max, Max> inverse_a(n, n), inverse_b(n, n);
    if (!detail::invert(a.covariance, inverse_a) || !detail::invert(b.covariance, inverse_b)) return false;
    double at_b = 0, at_a = 0;
    if (!detail::slope(inverse_a, inverse_b, 0.0, criterion, at_b)) return false;
    if (!detail::slope(inverse_a, inverse_b, 1.0, criterion, at_a)) return false;
    double low = 0, high = 1;
    if (at_b >= 0) high = 0;
    if (at_a <= 0) low = 1;
    if (low > high) low = high = 0.5;  // equal covariances: every weight is as good
    for (int step = 0; step < 50 && low < high; ++step) {
        const double middle = 0.5 * (low + high);
        double there = 0;
        if (!detail::slope(inverse_a, inverse_b, middle, criterion, there)) return false;
        (there < 0 ? low : high) = middle;
    }
    weight = 0.5 * (low + high);
    const Estimate<Max> both[] = {a, b};
    const double weights[] = {weight, 1 - weight};
    return covariance_intersection(both, weights, 2, out);
}

}  // namespace fusion
