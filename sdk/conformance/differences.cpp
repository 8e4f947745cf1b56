#include "differences.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "machine/check.hpp"

namespace pelorus::conformance {

namespace {

constexpr double two_pi = 6.28318530717958647692;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

double difference(double one, double other, bool is_angle) {
    return is_angle ? std::remainder(one - other, two_pi) : one - other;
}

/// What might explain `said` where differences say `found`.
std::string guess(double said, double found, double tolerance, bool is_mirrored) {
    if (is_mirrored) return "; the mirrored element fits: are rows and columns swapped?";
    if (std::fabs(said + found) <= tolerance) return "; the sign is turned";
    if (said == 0) return "; it is left out";
    if (std::fabs(found) <= tolerance) return "; it should vanish";
    for (const double factor : {0.5, 2.0, 3.0, 1.0 / 3.0})
        if (std::fabs(said - factor * found) <= tolerance * std::max(1.0, factor))
            return fmt::format("; it is {:.3g} times as large", factor);
    return {};
}

}  // namespace

Differences::Differences(const Eigen::VectorXd& x, const Eigen::VectorXd& scales)
    : x_(x), scales_(scales), points_(x.size(), x.size() * steps * 2) {
    for (Eigen::Index c = 0; c < x.size(); ++c)
        for (int k = 0; k < steps; ++k)
            for (int side = 0; side < 2; ++side) {
                points_.col(column(c, k, side)) = x;
                points_(c, column(c, k, side)) += (side == 0 ? 1.0 : -1.0) * std::ldexp(scales(c), -3 - k);
            }
}

DerivativeEstimate Differences::estimate(const Eigen::MatrixXd& values, const Space& space) const {
    DerivativeEstimate best{Eigen::MatrixXd::Zero(values.rows(), x_.size()),
                            Eigen::MatrixXd::Constant(values.rows(), x_.size(), HUGE_VAL)};
    for (Eigen::Index r = 0; r < values.rows(); ++r)
        for (Eigen::Index c = 0; c < x_.size(); ++c) {
            double last[4] = {NAN, NAN, NAN, NAN};  // of this step and the three longer ones
            for (int k = 0; k < steps; ++k) {
                const Eigen::Index up = column(c, k, 0), down = column(c, k, 1);
                const double span = points_(c, up) - points_(c, down);
                std::copy_backward(last, last + 3, last + 4);
                last[0] = difference(values(r, up), values(r, down), space[static_cast<int>(r)].angle) / span;
                // Truncation falls by four with each halving. Three differences, because one may vanish by chance.
                const double truncation = std::max({std::fabs(last[0] - last[1]), std::fabs(last[1] - last[2]) / 4,
                                                    std::fabs(last[2] - last[3]) / 16});
                const double magnitude = std::fabs(values(r, up)) + std::fabs(values(r, down)) +
                                         std::fabs(last[0]) * (std::fabs(x_(c)) + scales_(c));
                const double uncertainty = truncation + 16 * epsilon * magnitude / span;
                const bool is_known = !std::isnan(last[0] + last[1] + last[2] + last[3]);
                if (!is_known || !(uncertainty < best.uncertainty(r, c))) continue;
                best.value(r, c) = last[0];
                best.uncertainty(r, c) = uncertainty;
            }
        }
    return best;
}

std::string disagreement(const Eigen::MatrixXd& jacobian, const DerivativeEstimate& differences, const Space& of,
                         const Space& by, const Eigen::VectorXd& scales_of, const Eigen::VectorXd& scales_by) {
    double worst = 1;
    std::string text, unknown;
    const auto tolerance = [&](Eigen::Index r, Eigen::Index c) {
        return 3 * differences.uncertainty(r, c) + 1e-6 * std::fabs(differences.value(r, c)) +
               1e-8 * scales_of(r) / scales_by(c);
    };
    for (Eigen::Index r = 0; r < jacobian.rows(); ++r)
        for (Eigen::Index c = 0; c < jacobian.cols(); ++c) {
            const double said = jacobian(r, c), found = differences.value(r, c), allowed = tolerance(r, c);
            if (!std::isfinite(said))
                return fmt::format("element ({}, {}) is {}", of[static_cast<int>(r)].name, by[static_cast<int>(c)].name,
                                   said);
            if (!std::isfinite(allowed)) {
                unknown = fmt::format("element ({}, {})", of[static_cast<int>(r)].name, by[static_cast<int>(c)].name);
                continue;
            }
            const double excess = std::fabs(said - found) / allowed;
            if (!(excess > worst)) continue;
            worst = excess;
            const bool has_mirror = r != c && r < jacobian.cols() && c < jacobian.rows();
            const bool is_mirrored = has_mirror && std::fabs(said - differences.value(c, r)) <= tolerance(c, r) &&
                                     std::fabs(jacobian(c, r) - found) <= allowed;
            text = fmt::format("element ({}, {}) is {:.9g}, differences say {:.9g} (within {:.1g}){}",
                               of[static_cast<int>(r)].name, by[static_cast<int>(c)].name, said, found, allowed,
                               guess(said, found, allowed, is_mirrored));
        }
    if (!unknown.empty())
        note(unknown + " of a Jacobian was compared with nothing: the function answers at too few places around one");
    return text;
}

std::string text_of(const Eigen::VectorXd& vector) {
    std::string text = "[";
    for (Eigen::Index i = 0; i < vector.size(); ++i) text += fmt::format("{}{:.6g}", i == 0 ? "" : ", ", vector(i));
    return text + "]";
}

Eigen::VectorXd difference_in(const Space& space, const Eigen::VectorXd& one, const Eigen::VectorXd& other) {
    Eigen::VectorXd result(one.size());
    for (Eigen::Index i = 0; i < one.size(); ++i)
        result(i) = difference(one(i), other(i), space[static_cast<int>(i)].angle);
    return result;
}

}  // namespace pelorus::conformance
