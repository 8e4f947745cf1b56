/// Rules that make one estimate of pieces: inverse variances, sums of information, covariance intersection.
///
///     A_i = H_i' R_i^-1 H_i    b_i = H_i' R_i^-1 (z_i - x0)    H_i: the rows of the identity that piece i tells
///     P^-1 = sum w_i A_i       x = x0 + P sum w_i b_i
///
/// All functions are pure. False where a covariance is not positive definite, or where the pieces do not tell every component.
#pragma once

#include <vector>

#include "covariance_intersection.hpp"
#include "pieces.hpp"

namespace fusion {

/// A and b of one piece, in the common space.
struct Information {
    Square matrix;
    Column vector;
};

/// Of each piece, with x0 = reference.
[[nodiscard]] inline bool information_of(const CommonSpace& common, const std::vector<Piece>& pieces,
                                         const Column& reference, std::vector<Information>& out) {
    out.clear();
    for (const Piece& piece : pieces) {
        const auto p = static_cast<Eigen::Index>(piece.places.size());
        Square inverse(p, p);
        if (!detail::invert(piece.covariance, inverse)) return false;
        Column difference(p, 1), weighted(p, 1);
        for (Eigen::Index i = 0; i < p; ++i) {
            const int place = piece.places[static_cast<std::size_t>(i)];
            difference(i, 0) = common.difference(place, piece.mean(i, 0), reference(place, 0));
        }
        pelorus::small::multiply(inverse, difference, weighted);
        const int n = common.size();
        Information told{Square::Zero(n, n), Column::Zero(n, 1)};
        for (Eigen::Index c = 0; c < p; ++c) {
            const int column = piece.places[static_cast<std::size_t>(c)];
            told.vector(column, 0) = weighted(c, 0);
            for (Eigen::Index r = 0; r < p; ++r)
                told.matrix(piece.places[static_cast<std::size_t>(r)], column) = inverse(r, c);
        }
        out.push_back(told);
    }
    return true;
}

/// x and P of a weighted sum of information.
[[nodiscard]] inline bool estimate_of(const CommonSpace& common, const std::vector<Information>& told,
                                      const std::vector<double>& weights, const Column& reference, Fused& out) {
    const int n = common.size();
    Information sum{Square::Zero(n, n), Column::Zero(n, 1)};
    for (std::size_t k = 0; k < told.size(); ++k) {
        if (weights[k] == 0) continue;
        for (Eigen::Index i = 0; i < sum.matrix.size(); ++i)
            sum.matrix.data()[i] += weights[k] * told[k].matrix.data()[i];
        for (Eigen::Index i = 0; i < n; ++i) sum.vector(i, 0) += weights[k] * told[k].vector(i, 0);
    }
    out.covariance = sum.matrix;
    if (!detail::invert(sum.matrix, out.covariance)) return false;
    Column step(n, 1);
    pelorus::small::multiply(out.covariance, sum.vector, step);
    common.advance(reference, step, out.mean);
    return pelorus::small::all_finite(out.mean) && pelorus::small::all_finite(out.covariance);
}

/// Each component by itself, weighted by the reciprocal of its variance; covariances between components are left out:
///     x_c = sum (z_ic / s_ic^2) / sum (1 / s_ic^2)      P = diag(1 / sum (1 / s_ic^2))
[[nodiscard]] inline bool weigh_components(const CommonSpace& common, const std::vector<Piece>& pieces, Fused& out) {
    const int n = common.size();
    Column reference(n, 1), information = Column::Zero(n, 1), sum = information;
    if (!common.reference(pieces, reference)) return false;
    for (const Piece& piece : pieces)
        for (std::size_t i = 0; i < piece.places.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            const int place = piece.places[i];
            if (!(piece.covariance(row, row) > 0)) return false;
            const double weight = 1 / piece.covariance(row, row);
            information(place, 0) += weight;
            sum(place, 0) += weight * common.difference(place, piece.mean(row, 0), reference(place, 0));
        }
    out.covariance = Square::Zero(n, n);
    for (int c = 0; c < n; ++c) {
        out.covariance(c, c) = 1 / information(c, 0);
        sum(c, 0) /= information(c, 0);
    }
    common.advance(reference, sum, out.mean);
    return pelorus::small::all_finite(out.mean) && pelorus::small::all_finite(out.covariance);
}

/// The best linear estimate from pieces with independent errors: sum of information.
[[nodiscard]] inline bool add_information(const CommonSpace& common, const std::vector<Piece>& pieces, Fused& out) {
    Column reference(common.size(), 1);
    std::vector<Information> told;
    return common.reference(pieces, reference) && information_of(common, pieces, reference, told) &&
           estimate_of(common, told, std::vector<double>(told.size(), 1.0), reference, out);
}

namespace detail {

/// What weight moved from piece j to piece i does to the criterion: -tr[P (A_i - A_j)], or -tr[P (A_i - A_j) P]. False where P does
/// not exist.
[[nodiscard]] inline bool exchange(const std::vector<Information>& told, const std::vector<double>& weights,
                                   std::size_t i, std::size_t j, Criterion criterion, double& out) {
    const Eigen::Index n = told[i].matrix.rows();
    Square sum = Square::Zero(n, n), p(n, n), difference(n, n), product(n, n);
    for (std::size_t k = 0; k < told.size(); ++k)
        for (Eigen::Index e = 0; e < sum.size(); ++e) sum.data()[e] += weights[k] * told[k].matrix.data()[e];
    if (!invert(sum, p)) return false;
    for (Eigen::Index e = 0; e < sum.size(); ++e)
        difference.data()[e] = told[i].matrix.data()[e] - told[j].matrix.data()[e];
    pelorus::small::multiply(p, difference, product);
    if (criterion == Criterion::trace) {
        difference = product;
        pelorus::small::multiply(difference, p, product);
    }
    out = 0;
    for (Eigen::Index d = 0; d < n; ++d) out -= product(d, d);
    return true;
}

/// Shares what pieces i and j weigh together so that the criterion is least: its slope never falls over the share, and is bisected to
/// 2^-50. Where an end leaves no P, the criterion is infinite there.
[[nodiscard]] inline bool share(const std::vector<Information>& told, std::vector<double>& weights, std::size_t i,
                                std::size_t j, Criterion criterion) {
    const double together = weights[i] + weights[j];
    const auto put = [&](double part) {
        weights[i] = part * together;
        weights[j] = together - weights[i];
    };
    const double before = together > 0 ? weights[i] / together : 0;
    double low = 0, high = 1, slope = 0;
    put(0);
    const bool least_at_0 = exchange(told, weights, i, j, criterion, slope) && slope >= 0;
    put(1);
    const bool least_at_1 = exchange(told, weights, i, j, criterion, slope) && slope <= 0;
    if (least_at_0 && least_at_1) return put(before), true;  // every share is as good
    if (least_at_0) high = 0;
    if (least_at_1) low = 1;
    for (int step = 0; step < 50 && low < high; ++step) {
        const double middle = 0.5 * (low + high);
        put(middle);
        if (!exchange(told, weights, i, j, criterion, slope)) return false;
        (slope < 0 ? low : high) = middle;
    }
    return put(0.5 * (low + high)), true;
}

}  // namespace detail

/// Weights of pieces, >= 0 with sum 1, that make the determinant or the trace of P least; weight is shared out between two pieces at
/// a time until nothing moves: the criterion is convex and smooth, so that this ends at its minimum.
[[nodiscard]] inline bool best_weights(const std::vector<Information>& told, Criterion criterion,
                                       std::vector<double>& weights) {
    weights.assign(told.size(), 1.0 / static_cast<double>(told.size()));
    const int rounds = told.size() < 3 ? 1 : 100;
    for (int round = 0; round < rounds; ++round) {
        const std::vector<double> before = weights;
        for (std::size_t i = 0; i < told.size(); ++i)
            for (std::size_t j = i + 1; j < told.size(); ++j)
                if (!detail::share(told, weights, i, j, criterion)) return false;
        double moved = 0;
        for (std::size_t k = 0; k < told.size(); ++k) moved = std::max(moved, std::abs(weights[k] - before[k]));
        if (moved < 1e-12) break;
    }
    return true;
}

/// Covariance intersection of pieces that each tell some components; consistent whatever the correlation of their errors.
[[nodiscard]] inline bool intersect(const CommonSpace& common, const std::vector<Piece>& pieces, Criterion criterion,
                                    std::vector<double>& weights, Fused& out) {
    Column reference(common.size(), 1);
    std::vector<Information> told;
    return common.reference(pieces, reference) && information_of(common, pieces, reference, told) &&
           best_weights(told, criterion, weights) && estimate_of(common, told, weights, reference, out);
}

/// Two estimates of all components whose errors have the covariance C = E e_1 e_2':
///     x = x_1 + K (x_2 - x_1)    P = P_1 - K (P_1 - C)'    K = (P_1 - C) (P_1 + P_2 - C - C')^-1
/// Source: Y. Bar-Shalom, L. Campo, The effect of the common process noise on the two-sensor fused-track covariance, IEEE Transactions
/// on Aerospace and Electronic Systems 22(6), 803-805, 1986.
[[nodiscard]] inline bool fuse_correlated(const CommonSpace& common, const Piece& first, const Piece& second,
                                          const Square& cross, Fused& out) {
    const Eigen::Index n = common.size();
    Square gain(n, n), total(n, n), root(n, n), excess(n, n);
    Column difference(n, 1), step(n, 1);
    for (Eigen::Index c = 0; c < n; ++c) {
        difference(c, 0) = common.difference(static_cast<int>(c), second.mean(c, 0), first.mean(c, 0));
        for (Eigen::Index r = 0; r < n; ++r) {
            excess(r, c) = first.covariance(r, c) - cross(r, c);
            total(r, c) = excess(r, c) + second.covariance(r, c) - cross(c, r);
        }
    }
    if (!pelorus::small::cholesky(total, root)) return false;
    gain = excess.transpose();
    pelorus::small::cholesky_solve(root, gain);  // K'
    gain.transposeInPlace();
    pelorus::small::multiply(gain, difference, step);
    common.advance(first.mean, step, out.mean);
    out.covariance = Square(n, n);
    pelorus::small::multiply_transposed(gain, excess, out.covariance);
    for (Eigen::Index e = 0; e < out.covariance.size(); ++e)
        out.covariance.data()[e] = first.covariance.data()[e] - out.covariance.data()[e];
    pelorus::small::symmetrise(out.covariance);
    return pelorus::small::cholesky(out.covariance, root) && pelorus::small::all_finite(out.mean);
}

/// rho P_1^1/2 P_2^1/2, symmetric roots: the covariance of errors whose normalised components have the correlation rho.
[[nodiscard]] inline bool cross_covariance(const Piece& first, const Piece& second, double correlation, Square& out) {
    const Eigen::Index n = first.covariance.rows();
    Square one(n, n), other(n, n);
    out = Square(n, n);
    if (!pelorus::small::square_root(first.covariance, one) || !pelorus::small::square_root(second.covariance, other))
        return false;
    for (Eigen::Index e = 0; e < one.size(); ++e) one.data()[e] *= correlation;
    pelorus::small::multiply(one, other, out);
    return true;
}

/// Two estimates that share a third one, each having added information of its own: what is common counts once.
///     P^-1 = P_1^-1 + P_2^-1 - P_c^-1    P^-1 x = P_1^-1 x_1 + P_2^-1 x_2 - P_c^-1 x_c
/// Source: C. Y. Chong, S. Mori, K. C. Chang, Distributed multitarget multisensor tracking, in: Y. Bar-Shalom (ed.), Multitarget-
/// Multisensor Tracking: Advanced Applications, Artech House, 1990, chapter 8.
[[nodiscard]] inline bool fuse_without(const CommonSpace& common, const Piece& first, const Piece& second,
                                       const Piece& shared, Fused& out) {
    const std::vector<Piece> pieces{first, second, shared};
    Column reference(common.size(), 1);
    std::vector<Information> told;
    return common.reference(pieces, reference) && information_of(common, pieces, reference, told) &&
           estimate_of(common, told, {1, 1, -1}, reference, out);
}

}  // namespace fusion
