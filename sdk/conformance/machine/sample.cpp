#include "sample.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

namespace pelorus::conformance {

namespace {
constexpr double pi = 3.14159265358979323846;

const plr_component& component(const plr_space& space, std::uint32_t index) noexcept {
    const auto* at = reinterpret_cast<const unsigned char*>(space.components);
    return *reinterpret_cast<const plr_component*>(at + std::size_t{index} * space.components->struct_size);
}
}  // namespace

double Sample::uniform(double from, double to) {
    double number = 0;
    random_->uniform(key_, used_++, 1, &number);
    return from + (to - from) * number;
}

double Sample::normal(double mean, double deviation) {
    double number = 0;
    random_->normal(key_, used_++, 1, &number);
    return mean + deviation * number;
}

std::uint64_t Sample::below(std::uint64_t below) {
    return std::min(below - 1, static_cast<std::uint64_t>(uniform() * static_cast<double>(below)));
}

std::vector<std::int64_t> Sample::permutation(std::int64_t count) {
    std::vector<std::int64_t> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[below(i)]);
    return order;
}

double scale_of(const plr_component& c) noexcept {
    if ((c.flags & PLR_COMPONENT_ANGLE) != 0) return 1.0;
    if (std::strcmp(c.unit, "m") == 0) return 1e4;
    if (std::strcmp(c.unit, "m/s") == 0) return 100.0;
    if (std::strcmp(c.unit, "m/s2") == 0) return 10.0;
    if (std::strcmp(c.unit, "m/s3") == 0) return 1.0;
    if (std::strcmp(c.unit, "rad") == 0) return 0.5;
    if (std::strcmp(c.unit, "rad/s") == 0) return 0.1;
    if (c.prior_deviation > 0 && std::isfinite(c.prior_deviation)) return std::min(c.prior_deviation, 1e3);
    return 1.0;
}

Eigen::VectorXd scales_of(const plr_space& space) {
    Eigen::VectorXd scales(space.size);
    for (std::uint32_t i = 0; i < space.size; ++i) scales(i) = scale_of(component(space, i));
    return scales;
}

Eigen::VectorXd Sample::state(const plr_space& space) {
    Eigen::VectorXd x(space.size);
    for (std::uint32_t i = 0; i < space.size; ++i) {
        const plr_component& c = component(space, i);
        const bool is_angle = (c.flags & PLR_COMPONENT_ANGLE) != 0;
        const double mean = std::strcmp(c.unit, "m") == 0 || !std::isfinite(c.prior_mean) ? 0.0 : c.prior_mean;
        x(i) = is_angle ? uniform(-pi, pi) : mean + uniform(-2.0, 2.0) * scale_of(c);
    }
    return x;
}

Eigen::MatrixXd Sample::covariance(const plr_space& space) { return covariance(0.01 * scales_of(space)); }

Eigen::MatrixXd Sample::covariance(const Eigen::VectorXd& deviations) {
    const Eigen::Index n = deviations.size();
    Eigen::MatrixXd factor(n, n);
    for (Eigen::Index c = 0; c < n; ++c)
        for (Eigen::Index r = 0; r < n; ++r) factor(r, c) = normal(0.0, 0.5);
    factor.diagonal().array() += 1.0;
    const Eigen::MatrixXd scaled = deviations.asDiagonal() * factor;
    const Eigen::MatrixXd product = scaled * scaled.transpose();
    return 0.5 * (product + product.transpose());
}

Eigen::VectorXd Sample::normal(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
    Eigen::VectorXd white(mean.size());
    for (Eigen::Index i = 0; i < white.size(); ++i) white(i) = normal();
    // LDL' also where the covariance is singular.
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(covariance);
    const Eigen::VectorXd scaled = ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().cwiseProduct(white);
    const Eigen::VectorXd shifted = ldlt.matrixL() * scaled;
    return mean + ldlt.transpositionsP().transpose() * shifted;
}

Eigen::MatrixXd Sample::rotation(int dimension) {
    Eigen::MatrixXd random(dimension, dimension);
    for (int c = 0; c < dimension; ++c)
        for (int r = 0; r < dimension; ++r) random(r, c) = normal();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(random);
    Eigen::MatrixXd q = qr.householderQ();
    if (q.determinant() < 0) q.col(0) = -q.col(0);
    return q;
}

}  // namespace pelorus::conformance
