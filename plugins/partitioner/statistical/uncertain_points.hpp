/// Points with covariances, in a tree of boxes that bounds what their statistical distances can be.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "../../common/partition/covariances.hpp"
#include "../../common/partition/memory.hpp"

namespace statistical {

using partition::array;
using partition::Memory;
using partition::Need;

/// A point of the scan; covariance R is positive definite.
template <int D> struct UncertainPoint {
    pelorus::Vector<D> position;
    pelorus::Matrix<D> covariance;
    double largest, smallest;  ///< eigenvalue of R, m^2
    std::uint32_t point;       ///< number in the scan
};

/// Points first .. last - 1 of the tree, and bounds of what they are.
template <int D> struct Node {
    std::array<double, D> low, high;  ///< the box around the positions, m
    std::array<double, D> variance;   ///< the largest R_kk of any, m^2
    double largest, smallest;         ///< the largest and the smallest eigenvalue of any R, m^2
    std::uint32_t first, last;
    std::uint32_t right;   ///< the second half; the first one is the next node. 0: not halved
    std::uint32_t is_one;  ///< all its points are known to be in one component
};

/// A balanced tree: nodes are halved at the median of their longest side until few points are left.
template <int D> class UncertainPoints {
public:
    static constexpr std::uint32_t leaf = 8;

    static constexpr Need need() noexcept {
        // A leaf has more than half of `leaf` points, or is the root: fewer nodes than half the points, and one.
        Need nodes = array<Node<D>>(1);
        nodes.per_point = (nodes.per_point + 1) / 2;
        return array<UncertainPoint<D>>() + nodes;
    }

    UncertainPoints(Memory& memory, const plr_const_view& points, const plr_const_view& covariance)
        : size_(static_cast<std::uint32_t>(points.count)),
          points_(memory.take<UncertainPoint<D>>(size_)),
          nodes_(memory.take<Node<D>>(size_ / 2 + 1)) {
        for (std::uint32_t i = 0; i < size_; ++i) {
            UncertainPoint<D>& own = points_[i];
            own.position = pelorus::load<D, 1>(points, i);
            own.covariance = pelorus::load<D, D>(covariance, i);
            own.point = i;
            pelorus::Vector<D> values;
            pelorus::Matrix<D> vectors;
            if (!pelorus::small::symmetric_eigen(own.covariance, values, vectors) || !(values(0) > 0))
                throw pelorus::NumericError("covariance of point " + std::to_string(i) + " is not positive definite");
            own.smallest = values(0);
            own.largest = values(D - 1);
        }
        make_node(0, size_);
    }

    const Node<D>& node(std::uint32_t n) const noexcept { return nodes_[n]; }
    Node<D>& node(std::uint32_t n) noexcept { return nodes_[n]; }
    const UncertainPoint<D>& point(std::uint32_t k) const noexcept { return points_[k]; }
    std::uint32_t size() const noexcept { return size_; }

private:
    void make_node(std::uint32_t first, std::uint32_t last) {
        const std::uint32_t n = node_count_++;
        Node<D>& own = nodes_[n];
        bound(own, first, last);
        if (last - first <= leaf) return;
        std::size_t axis = 0;
        for (std::size_t k = 1; k < D; ++k)
            if (own.high[k] - own.low[k] > own.high[axis] - own.low[axis]) axis = k;
        const std::uint32_t middle = first + (last - first) / 2;
        const auto k = static_cast<Eigen::Index>(axis);
        std::nth_element(points_ + first, points_ + middle, points_ + last,
                         [k](const auto& a, const auto& b) { return a.position(k) < b.position(k); });
        make_node(first, middle);
        nodes_[n].right = node_count_;
        make_node(middle, last);
    }

    void bound(Node<D>& node, std::uint32_t first, std::uint32_t last) const noexcept {
        node = {};
        node.first = first;
        node.last = last;
        node.low.fill(std::numeric_limits<double>::infinity());
        node.high.fill(-std::numeric_limits<double>::infinity());
        node.smallest = std::numeric_limits<double>::infinity();
        for (std::uint32_t k = first; k < last; ++k) {
            const UncertainPoint<D>& point = points_[k];
            for (int axis = 0; axis < D; ++axis) {
                const auto at = static_cast<std::size_t>(axis);
                node.low[at] = std::min(node.low[at], point.position(axis));
                node.high[at] = std::max(node.high[at], point.position(axis));
                node.variance[at] = std::max(node.variance[at], point.covariance(axis, axis));
            }
            node.largest = std::max(node.largest, point.largest);
            node.smallest = std::min(node.smallest, point.smallest);
        }
        node.is_one = last - first == 1 ? 1 : 0;
    }

    std::uint32_t size_, node_count_ = 0;
    UncertainPoint<D>* points_;
    Node<D>* nodes_;
};

}  // namespace statistical
