// The rules of the point filters.
#include "point_rule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <pelorus/small_matrix.hpp>

namespace gaussian {

namespace {

constexpr int max_order = 32;

PointRule star_rule(int n, double scale, double centre, double covariance_centre) {
    PointRule rule;
    rule.size = n;
    rule.is_star = true;
    rule.scale = scale;
    rule.points.assign(static_cast<std::size_t>(n * (2 * n + 1)), 0.0);
    for (int j = 0; j < n; ++j) {
        rule.points[static_cast<std::size_t>((1 + 2 * j) * n + j)] = scale;
        rule.points[static_cast<std::size_t>((2 + 2 * j) * n + j)] = -scale;
    }
    rule.mean_weights.assign(static_cast<std::size_t>(2 * n + 1), 0.5 / (scale * scale));
    rule.covariance_weights = rule.mean_weights;
    rule.mean_weights[0] = centre;
    rule.covariance_weights[0] = covariance_centre;
    return rule;
}

/// The weight of a node: 1 / sum of the squares of the orthonormal Hermite polynomials below `order`, which is exact for the
/// smallest weights too.
double christoffel_number(double x, int order) noexcept {
    double last = 0.0, now = 1.0, sum = 1.0;
    for (int j = 0; j + 1 < order; ++j) {
        const double next = (x * now - std::sqrt(static_cast<double>(j)) * last) / std::sqrt(j + 1.0);
        last = now;
        now = next;
        sum += now * now;
    }
    return 1.0 / sum;
}

}  // namespace

PointRule cubature_rule(int n) { return star_rule(n, std::sqrt(static_cast<double>(n)), 0.0, 0.0); }

PointRule unscented_rule(int n, double alpha, double beta, double kappa) {
    const double spread = alpha * alpha * (n + kappa), lambda = spread - n;
    return star_rule(n, std::sqrt(spread), lambda / spread, lambda / spread + 1.0 - alpha * alpha + beta);
}

double gauss_hermite_count(int n, int order) { return std::pow(order, n); }

PointRule gauss_hermite_rule(int n, int order) {
    using Table = pelorus::small::Bounded<max_order, max_order>;
    Table recurrence = Table::Zero(order, order), vectors(order, order);
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_order, 1> nodes(order);
    for (int k = 1; k < order; ++k) recurrence(k, k - 1) = recurrence(k - 1, k) = std::sqrt(static_cast<double>(k));
    if (!pelorus::small::symmetric_eigen(recurrence, nodes, vectors)) return {};
    std::array<double, max_order> node{}, weight{};
    for (int k = 0; k < order; ++k) {
        const auto here = static_cast<std::size_t>(k);
        node[here] = 0.5 * (nodes(k) - nodes(order - 1 - k));  // symmetric about 0, but for rounding
        weight[here] = christoffel_number(node[here], order);
    }

    PointRule rule;
    rule.size = n;
    rule.points.assign(static_cast<std::size_t>(n), 0.0);
    rule.mean_weights.assign(1, 0.0);
    std::vector<int> digits(static_cast<std::size_t>(n), 0);
    const auto total = static_cast<std::int64_t>(gauss_hermite_count(n, order));
    for (std::int64_t p = 0; p < total; ++p) {
        double product = 1.0;
        bool is_centre = true;
        std::vector<double> point;
        for (int& digit : digits) {
            product *= weight[static_cast<std::size_t>(digit)];
            point.push_back(node[static_cast<std::size_t>(digit)]);
            is_centre = is_centre && point.back() == 0.0;
        }
        for (int& digit : digits) {
            if (++digit < order) break;
            digit = 0;
        }
        if (is_centre) {
            rule.mean_weights[0] = product;
            continue;
        }
        rule.points.insert(rule.points.end(), point.begin(), point.end());
        rule.mean_weights.push_back(product);
    }
    rule.covariance_weights = rule.mean_weights;
    return rule;
}

PointRule leading_rule(const PointRule& rule, std::int64_t leading) {
    PointRule out;
    out.size = leading;
    out.is_star = rule.is_star;
    out.scale = rule.scale;
    std::map<std::vector<double>, std::size_t> known;
    for (std::int64_t p = 0; p < rule.count(); ++p) {
        const std::vector<double> point(rule.point(p), rule.point(p) + leading);
        const auto [place, is_new] = known.emplace(point, known.size());
        if (is_new) {
            out.points.insert(out.points.end(), point.begin(), point.end());
            out.mean_weights.push_back(0.0);
            out.covariance_weights.push_back(0.0);
        }
        out.mean_weights[place->second] += rule.mean_weights[static_cast<std::size_t>(p)];
        out.covariance_weights[place->second] += rule.covariance_weights[static_cast<std::size_t>(p)];
    }
    return out;
}

Points points_of(const PointRule& rule) noexcept {
    Points out{static_cast<int>(rule.size),
               static_cast<int>(rule.count()),
               rule.is_star,
               rule.scale,
               rule.points.data(),
               rule.mean_weights.data(),
               rule.covariance_weights.data(),
               rule.covariance_weights[0],
               false};
    if (!rule.is_star) return out;
    // The sum of the weights in covariances: 1, but for the unscented transform.
    const auto others = static_cast<double>(rule.count() - 1);
    const double sum = rule.size > 0 ? rule.covariance_weights[0] + others * rule.covariance_weights[1] : 1.0;
    out.about_centre = out.centre_weight < 0.0 && sum >= 2.0;
    if (out.about_centre) out.centre_weight = sum - 2.0;
    return out;
}

}  // namespace gaussian
