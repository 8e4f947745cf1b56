#include "campaign/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <pelorus/abi/abi.h>
#include <pelorus/abi/consistency.h>

#include "campaign/totals.hpp"
#include "report/chi_square.hpp"

namespace pelorus::campaign {

namespace {

double student(std::size_t degrees) {
    return boost::math::quantile(boost::math::students_t(static_cast<double>(degrees)), 0.975);
}

double estimate(std::uint32_t reduce, double quantile, const std::vector<double>& finite, double weighted_sum,
                double weight) {
    const auto n = static_cast<double>(finite.size());
    if (reduce == PLR_REDUCE_COUNT) return n;
    if (finite.empty()) return std::numeric_limits<double>::quiet_NaN();
    switch (reduce) {
        case PLR_REDUCE_MEAN:
            return weighted_sum / weight;
        case PLR_REDUCE_ROOT_MEAN_SQUARE:
            return std::sqrt(weighted_sum / n);
        case PLR_REDUCE_SUM:
            return weighted_sum;
        case PLR_REDUCE_CHI_SQUARE:
            return report::chi_square_bound(weighted_sum, quantile);
        case PLR_REDUCE_MIN:
            return *std::min_element(finite.begin(), finite.end());
        case PLR_REDUCE_MAX:
            return *std::max_element(finite.begin(), finite.end());
        case PLR_REDUCE_QUANTILE: {
            std::vector<double> sorted = finite;
            std::sort(sorted.begin(), sorted.end());
            return quantile_of(sorted, quantile);
        }
        default:  // a key, or what run 0 alone tells
            return finite.front();
    }
}

}  // namespace

Estimate estimate_of(std::uint32_t reduce, double quantile, const std::vector<double>& values,
                     const std::vector<double>& weights) {
    const bool is_square = reduce == PLR_REDUCE_ROOT_MEAN_SQUARE, is_count = reduce == PLR_REDUCE_COUNT;
    const auto weight_of = [&](std::size_t i) { return reduce == PLR_REDUCE_MEAN ? weights[i] : 1.0; };
    const auto summand = [&](double x) { return is_square ? x * x : x; };
    Estimate made;
    std::vector<double> finite;
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) continue;
        finite.push_back(values[i]);
        sum += weight_of(i) * summand(values[i]);
        weight += weight_of(i);
    }
    made.finite = finite.size();
    made.value = estimate(reduce, quantile, finite, sum, weight);
    if (!is_square && !is_count && reduce != PLR_REDUCE_MEAN && reduce != PLR_REDUCE_SUM) return made;
    const auto n = static_cast<double>(finite.size()), all = static_cast<double>(values.size());
    double slope = 1;  // of the estimate over the sum
    if (reduce == PLR_REDUCE_MEAN) slope = 1 / weight;
    if (is_square) slope = made.value > 0 ? 1 / (2 * made.value * n) : 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool is_finite = std::isfinite(values[i]);
        double moved = is_finite ? slope * weight_of(i) * (summand(values[i]) - sum / weight) : 0;
        if (is_count) moved = (is_finite ? 1 : 0) - n / all;
        made.contributions.push_back(moved);
    }
    return made;
}

std::optional<double> ci95_of(const Contributions& contributions, std::size_t runs) {
    if (runs < 2 || contributions.empty()) return std::nullopt;
    double squares = 0;
    for (const double x : contributions) squares += x * x;
    const auto n = static_cast<double>(runs);
    return student(runs - 1) * std::sqrt(squares * n / (n - 1));
}

std::optional<double> quantile_ci95(const std::vector<double>& sorted, double probability) {
    if (sorted.size() < 2 || probability <= 0 || probability >= 1) return std::nullopt;
    const auto n = static_cast<double>(sorted.size());
    const boost::math::binomial below(n, probability);
    // Order statistics l and u, counted from 1: P(x_l <= quantile < x_u) = P(l <= B < u).
    const double lower = boost::math::quantile(below, 0.025);
    const double upper = boost::math::quantile(below, 0.975) + 1;
    if (lower < 1 || upper > n) return std::nullopt;  // too few values for that much confidence
    if (boost::math::cdf(below, upper - 1) - boost::math::cdf(below, lower - 1) < 0.95) return std::nullopt;
    return (sorted[static_cast<std::size_t>(upper) - 1] - sorted[static_cast<std::size_t>(lower) - 1]) / 2;
}

std::optional<double> jackknife_ci95(double estimate, const Jackknife& jackknife) {
    double n = 0;
    std::size_t groups = 0;
    for (std::size_t g = 0; g < jackknife.counts.size(); ++g) {
        if (jackknife.counts[g] == 0) continue;
        if (!std::isfinite(jackknife.without[g])) return std::nullopt;
        n += static_cast<double>(jackknife.counts[g]);
        ++groups;
    }
    if (groups < 2 || !std::isfinite(estimate)) return std::nullopt;
    const auto count = static_cast<double>(groups);
    double corrected = count * estimate;
    for (std::size_t g = 0; g < jackknife.counts.size(); ++g)
        if (jackknife.counts[g] > 0)
            corrected -= (1 - static_cast<double>(jackknife.counts[g]) / n) * jackknife.without[g];
    double variance = 0;
    for (std::size_t g = 0; g < jackknife.counts.size(); ++g) {
        if (jackknife.counts[g] == 0) continue;
        const double share = n / static_cast<double>(jackknife.counts[g]);
        const double deviation = share * estimate - (share - 1) * jackknife.without[g] - corrected;
        variance += deviation * deviation / (share - 1) / count;
    }
    return student(groups - 1) * std::sqrt(variance);
}

}  // namespace pelorus::campaign
