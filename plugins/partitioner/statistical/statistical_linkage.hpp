/// Single linkage by statistical distance.
#pragma once

#include "../../common/partition/components.hpp"
#include "uncertain_points.hpp"

namespace statistical {

/// Joins points i, j with (z_i - z_j)' (R_i + R_j)^-1 (z_i - z_j) < gate: exactly the components of a look at all pairs.
///
/// Pairs of nodes are passed over that are one component already, or between which no pair can have a link:
///     d' S^-1 d >= |d|^2/lambda_max(S),   d' S^-1 d >= d_k^2/S_kk,   lambda_max(R_i + R_j) <= lambda_max(R_i) + lambda_max(R_j);
/// and joined without a look at their points where all pairs must have one:
///     d' S^-1 d <= |d|^2/lambda_min(S),   lambda_min(R_i + R_j) >= lambda_min(R_i) + lambda_min(R_j).
/// Each node has bounds of its own, so that one huge covariance costs a look at all points, but not all others theirs.
template <int D> class StatisticalLinkage {
public:
    StatisticalLinkage(UncertainPoints<D>& points, double gate, partition::Components& components)
        : points_(points), gate_(gate), components_(components) {}

    void link() { link_within(0); }

private:
    // The quadratic form is that of a matrix which differs by so many roundings of its largest element from R_i + R_j.
    static constexpr double roundings = 1e-13;

    void link_within(std::uint32_t n) {
        const Node<D>& node = points_.node(n);
        if (node.right != 0) {
            link_within(n + 1);
            link_within(node.right);
            link_between(n + 1, node.right);
        } else {
            for (std::uint32_t k = node.first; k < node.last; ++k)
                for (std::uint32_t l = k + 1; l < node.last; ++l) link(points_.point(k), points_.point(l));
        }
        note_whether_one(n);
    }

    void link_between(std::uint32_t a, std::uint32_t b) {
        const Node<D>&one = points_.node(a), &other = points_.node(b);
        if (one.is_one != 0 && other.is_one != 0 && components_.joined(one.first, other.first)) return;
        if (no_pair_is_linked(one, other)) return;
        if (all_pairs_are_linked(one, other)) {
            for (std::uint32_t k = one.first; k < one.last; ++k) components_.join(k, other.first);
            for (std::uint32_t k = other.first; k < other.last; ++k) components_.join(k, one.first);
        } else if (one.right == 0 && other.right == 0) {
            for (std::uint32_t k = one.first; k < one.last; ++k)
                for (std::uint32_t l = other.first; l < other.last; ++l) link(points_.point(k), points_.point(l), k, l);
        } else if (other.right == 0 || (one.right != 0 && one.last - one.first >= other.last - other.first)) {
            link_between(a + 1, b);
            link_between(one.right, b);
        } else {
            link_between(a, b + 1);
            link_between(a, other.right);
        }
        note_whether_one(a);
        note_whether_one(b);
    }

    void link(const UncertainPoint<D>& a, const UncertainPoint<D>& b) {
        link(a, b, static_cast<std::uint32_t>(&a - &points_.point(0)),
             static_cast<std::uint32_t>(&b - &points_.point(0)));
    }
    void link(const UncertainPoint<D>& a, const UncertainPoint<D>& b, std::uint32_t k, std::uint32_t l) {
        const pelorus::Vector<D> error = a.position - b.position;
        const double largest = a.largest + b.largest;
        if (error.squaredNorm() > gate_ * largest * (1 + roundings)) return;
        if (components_.joined(k, l)) return;
        pelorus::Matrix<D> root = a.covariance + b.covariance;
        if (!pelorus::small::cholesky(root, root))
            throw pelorus::NumericError("R of points " + std::to_string(a.point) + " and " + std::to_string(b.point) +
                                        " added is not positive definite");
        if (pelorus::small::inverse_quadratic(root, error) < gate_) components_.join(k, l);
    }

    bool no_pair_is_linked(const Node<D>& a, const Node<D>& b) const noexcept {
        const double largest = a.largest + b.largest;
        double square = 0;
        for (std::size_t axis = 0; axis < D; ++axis) {
            const double gap = std::max({0.0, b.low[axis] - a.high[axis], a.low[axis] - b.high[axis]});
            const double variance = a.variance[axis] + b.variance[axis] + roundings * largest;
            if (gap * gap > gate_ * variance * (1 + roundings)) return true;
            square += gap * gap;
        }
        return square > gate_ * largest * (1 + roundings);
    }
    bool all_pairs_are_linked(const Node<D>& a, const Node<D>& b) const noexcept {
        double square = 0;
        for (std::size_t axis = 0; axis < D; ++axis) {
            const double across = std::max(a.high[axis] - b.low[axis], b.high[axis] - a.low[axis]);
            square += across * across;
        }
        return square < gate_ * (a.smallest + b.smallest - roundings * (a.largest + b.largest)) * (1 - roundings);
    }

    void note_whether_one(std::uint32_t n) noexcept {
        Node<D>& node = points_.node(n);
        if (node.is_one != 0) return;
        if (node.right != 0) {
            const Node<D>&one = points_.node(n + 1), &other = points_.node(node.right);
            node.is_one = one.is_one != 0 && other.is_one != 0 && components_.joined(one.first, other.first) ? 1 : 0;
        } else {
            node.is_one = 1;
            for (std::uint32_t k = node.first + 1; k < node.last && node.is_one != 0; ++k)
                node.is_one = components_.joined(node.first, k) ? 1 : 0;
        }
    }

    UncertainPoints<D>& points_;
    double gate_;
    partition::Components& components_;
};

}  // namespace statistical
