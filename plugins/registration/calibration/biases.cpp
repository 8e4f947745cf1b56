#include "biases.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace calibration {

Biases::Biases(const BiasVector& deviations, double presence) : deviations_(deviations), presence_(presence) {
    for (int bias = 0; bias < bias_count; ++bias)
        if (deviations(bias) > 0) active_.push_back(bias);
    const auto n = static_cast<Eigen::Index>(active_.size());
    mean_ = Vector::Zero(n);
    root_ = covariance_ = Matrix::Identity(n, n);
    average();
}

BiasVector Biases::spread(const Vector& whitened) const {
    BiasVector out = BiasVector::Zero();
    for (std::size_t k = 0; k < active_.size(); ++k)
        out(active_[k]) = whitened(static_cast<Eigen::Index>(k)) * deviations_(active_[k]);
    return out;
}

BiasMatrix Biases::covariance() const {
    BiasMatrix out = BiasMatrix::Zero();
    for (std::size_t i = 0; i < active_.size(); ++i)
        for (std::size_t j = 0; j < active_.size(); ++j)
            out(active_[i], active_[j]) = covariance_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) *
                                          deviations_(active_[i]) * deviations_(active_[j]);
    return out;
}

double Biases::ratio(int bias) const {
    for (std::size_t k = 0; k < active_.size(); ++k)
        if (active_[k] == bias)
            return std::sqrt(covariance_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)));
    return 1;
}

std::vector<Direction> Biases::directions() const {
    std::vector<Direction> out;
    if (active_.empty()) return out;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(covariance_)};
    for (auto k = static_cast<Eigen::Index>(active_.size()) - 1; k >= 0; --k) {
        Direction direction{std::sqrt(std::max(solver.eigenvalues()(k), 0.0)), BiasVector::Zero()};
        for (std::size_t i = 0; i < active_.size(); ++i)
            direction.share(active_[i]) = solver.eigenvectors()(static_cast<Eigen::Index>(i), k);
        Eigen::Index largest = 0;  // of either sign the one whose largest share is positive
        direction.share.cwiseAbs().maxCoeff(&largest);
        if (direction.share(largest) < 0) direction.share = -direction.share;
        out.push_back(direction);
    }
    return out;
}

/// Rows are added to a triangle, and turned into it: the covariance stays positive definite however small the noise is.
/// (G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, Academic Press 1977, chapter IV)
void Biases::update(const Eigen::VectorXd& residual, const BiasSlope& slope, const Eigen::MatrixXd& noise) {
    const auto n = static_cast<Eigen::Index>(active_.size()), m = residual.size();
    Eigen::MatrixXd h(m, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const int bias = active_[static_cast<std::size_t>(k)];
        h.col(k) = slope.col(bias) * deviations_(bias);
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(noise);
    if (factor.info() != Eigen::Success || !residual.allFinite() || !h.allFinite())
        throw pelorus::NumericError("the difference of two sensors has no finite value or no noise");
    Eigen::MatrixXd rows(n + m, n + 1);
    rows.topLeftCorner(n, n) = root_;
    rows.topRightCorner(n, 1) = root_ * mean_;
    rows.bottomLeftCorner(m, n) = h;
    rows.bottomRightCorner(m, 1) = residual + h * mean_;
    factor.matrixL().solveInPlace(rows.bottomRows(m));
    const Eigen::HouseholderQR<Eigen::MatrixXd> turned(rows);
    const Matrix root = turned.matrixQR().topLeftCorner(n, n).triangularView<Eigen::Upper>();
    const Vector mean = root.triangularView<Eigen::Upper>().solve(turned.matrixQR().col(n).head(n));
    const Matrix covariance = covariance_of(root);
    if (!mean.allFinite() || !covariance.allFinite()) throw pelorus::NumericError("an update is not finite");
    root_ = root;
    mean_ = mean;
    covariance_ = covariance;
    average();
}

Biases::Matrix Biases::covariance_of(const Matrix& root) {
    const Matrix inverse =
        root.triangularView<Eigen::Upper>().solve(Matrix(Matrix::Identity(root.rows(), root.cols())));
    return inverse * inverse.transpose();
}

/// The sum over the sets of biases that are 0.
void Biases::average() {
    estimate_ = Estimate{};
    const auto n = static_cast<unsigned>(active_.size());
    if (n == 0) return;
    if (presence_ >= 1) {
        estimate_ = {mean(), covariance(), BiasVector::Zero()};
        for (const int bias : active_) estimate_.presence(bias) = 1;
        return;
    }
    const double is_zero = std::log1p(-presence_), is_not = std::log(presence_);
    Vector first = Vector::Zero(n), present = Vector::Zero(n);
    Matrix second = Matrix::Zero(n, n);
    double total = 0, largest = -std::numeric_limits<double>::infinity();
    for (unsigned set = 0; set < (1u << n); ++set) {  // bit k: bias k is not 0
        // Condition on zeros one after the other; the densities multiply.
        Vector given = mean_;
        Matrix spread_given = covariance_;
        double weight = 0;
        for (unsigned k = 0; k < n; ++k) {
            const auto at = static_cast<Eigen::Index>(k);
            if ((set >> k & 1u) != 0) {
                weight += is_not;
                continue;
            }
            const double variance = spread_given(at, at), value = given(at);
            weight += is_zero - 0.5 * (value * value / variance + std::log(variance));
            const Vector column = spread_given.col(at) / variance;
            given -= column * value;
            spread_given -= column * (column.transpose() * variance);
            given(at) = 0;
            spread_given.row(at).setZero();
            spread_given.col(at).setZero();
        }
        if (weight > largest) {  // weights are kept relative to the largest one so far
            const double fade = std::exp(largest - weight);
            total *= fade;
            first *= fade;
            second *= fade;
            present *= fade;
            largest = weight;
        }
        const double share = std::exp(weight - largest);
        total += share;
        first += share * given;
        second += share * (spread_given + given * given.transpose());
        for (unsigned k = 0; k < n; ++k)
            if ((set >> k & 1u) != 0) present(static_cast<Eigen::Index>(k)) += share;
    }
    first /= total;
    second = second / total - first * first.transpose();
    estimate_.value = spread(first);
    for (unsigned i = 0; i < n; ++i) {
        const auto r = static_cast<Eigen::Index>(i);
        estimate_.presence(active_[i]) = present(r) / total;
        for (unsigned j = 0; j < n; ++j)
            estimate_.covariance(active_[i], active_[j]) =
                second(r, static_cast<Eigen::Index>(j)) * deviations_(active_[i]) * deviations_(active_[j]);
    }
}

}  // namespace calibration
