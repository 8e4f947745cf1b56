#include "polynomial.hpp"

#include <Eigen/Cholesky>

namespace least_squares {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// An inverse covariance for each sample, of values counted in `deviations`. False where a covariance has none.
bool invert(const std::vector<const MatrixXd*>& covariances, const VectorXd& deviations,
            std::vector<MatrixXd>& inverses) {
    const VectorXd scale = deviations.cwiseInverse();
    if (!scale.allFinite()) return false;
    for (const MatrixXd* each : covariances) {
        const Eigen::LLT<MatrixXd> factor(scale.asDiagonal() * *each * scale.asDiagonal());
        if (factor.info() != Eigen::Success) return false;
        inverses.push_back(factor.solve(MatrixXd::Identity(each->rows(), each->cols())));
        if (!inverses.back().allFinite()) return false;
    }
    return true;
}

/// The fit by inverse covariances: the normal equations of all coefficients of all components. False where they have no answer.
bool fit_weighted(const VectorXd& times, const MatrixXd& values, const std::vector<const MatrixXd*>& covariances,
                  int order, streams::Estimate& out) {
    const Index m = values.rows(), n = values.cols(), k = std::min<Index>(order + 1, n);
    const VectorXd deviations = covariances.front()->diagonal().cwiseSqrt();
    std::vector<MatrixXd> inverses;
    if (!invert(covariances, deviations, inverses)) return false;
    // Times from the middle of the samples, in units of their span, and values from the last: small numbers, well apart.
    const double middle = times.mean(), span = n > 1 ? times.maxCoeff() - times.minCoeff() : 1.0;
    const auto powers = [&](double time) {
        VectorXd p(k);
        for (Index j = 0; j < k; ++j) p(j) = j == 0 ? 1.0 : p(j - 1) * (time - middle) / span;
        return p;
    };
    const VectorXd last = values.col(n - 1);
    MatrixXd normal = MatrixXd::Zero(k * m, k * m);
    VectorXd right = VectorXd::Zero(k * m);
    for (Index i = 0; i < n; ++i) {
        const VectorXd p = powers(times(i));
        const MatrixXd& inverse = inverses[static_cast<std::size_t>(i)];
        const VectorXd weighted = inverse * (values.col(i) - last).cwiseQuotient(deviations);
        for (Index a = 0; a < k; ++a) {
            right.segment(a * m, m) += p(a) * weighted;
            for (Index b = 0; b < k; ++b) normal.block(a * m, b * m, m, m) += p(a) * p(b) * inverse;
        }
    }
    const VectorXd now = powers(0.0);
    MatrixXd pick = MatrixXd::Zero(k * m, m);
    for (Index a = 0; a < k; ++a) pick.middleRows(a * m, m).diagonal().setConstant(now(a));
    const Eigen::LDLT<MatrixXd> factor(normal);
    if (factor.info() != Eigen::Success || !factor.isPositive()) return false;
    const VectorXd value = pick.transpose() * factor.solve(right);
    const MatrixXd covariance = pick.transpose() * factor.solve(pick);
    out.value = last + value.cwiseProduct(deviations);
    out.covariance = deviations.asDiagonal() * (0.5 * (covariance + covariance.transpose())) * deviations.asDiagonal();
    return out.value.allFinite() && out.covariance.allFinite() && (out.covariance.diagonal().array() > 0.0).all();
}

}  // namespace

VectorXd weights(const VectorXd& times, int order) {
    const Index n = times.size();
    VectorXd w = VectorXd::Constant(n, 1.0 / static_cast<double>(n));
    if (order < 1 || n < 2) return w;
    const double middle = times.mean(), span = times.maxCoeff() - times.minCoeff();
    const VectorXd first = (times.array() - middle) / span;
    const double first_now = -middle / span, first_square = first.squaredNorm();
    w += first * (first_now / first_square);
    if (order < 2 || n < 3) return w;
    const double lean = first.cwiseAbs2().dot(first) / first_square, level = first_square / static_cast<double>(n);
    const VectorXd second = first.array() * (first.array() - lean) - level;
    return w + second * ((first_now * (first_now - lean) - level) / second.squaredNorm());
}

streams::Estimate fit(const VectorXd& times, const MatrixXd& values, const std::vector<const MatrixXd*>& covariances,
                      int order) {
    streams::Estimate out;
    const MatrixXd& first = *covariances.front();
    const bool differ =
        std::any_of(covariances.begin(), covariances.end(), [&](const MatrixXd* each) { return *each != first; });
    if (differ && fit_weighted(times, values, covariances, order, out)) return out;
    const VectorXd w = weights(times, order);
    const VectorXd last = values.col(values.cols() - 1);
    out.value = last + (values.colwise() - last) * w;
    out.covariance = MatrixXd::Zero(values.rows(), values.rows());
    if (!differ) {
        out.covariance = w.squaredNorm() * first;
    } else {
        for (Index i = 0; i < w.size(); ++i) out.covariance += w(i) * w(i) * *covariances[static_cast<std::size_t>(i)];
    }
    return out;
}

}  // namespace least_squares
