/// Which measurements of several sensors are of one object.
#pragma once

#include <limits>
#include <vector>

#include "../assignment/assignment.hpp"
#include "pieces.hpp"

namespace fusion {

/// The squared Mahalanobis distance of two pieces over the components that both tell, counted in `shared`; infinite where their
/// covariances are none.
inline double distance(const CommonSpace& common, const Piece& a, const Piece& b, int& shared) {
    std::vector<std::pair<Eigen::Index, Eigen::Index>> both;
    for (std::size_t i = 0; i < a.places.size(); ++i)
        for (std::size_t j = 0; j < b.places.size(); ++j)
            if (a.places[i] == b.places[j])
                both.emplace_back(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    const auto n = static_cast<Eigen::Index>(both.size());
    shared = static_cast<int>(n);
    if (n == 0) return 0;
    Square sum(n, n), root(n, n);
    Column difference(n, 1);
    for (Eigen::Index c = 0; c < n; ++c) {
        const auto [ac, bc] = both[static_cast<std::size_t>(c)];
        difference(c, 0) = common.difference(a.places[static_cast<std::size_t>(ac)], a.mean(ac, 0), b.mean(bc, 0));
        for (Eigen::Index r = 0; r < n; ++r) {
            const auto [ar, br] = both[static_cast<std::size_t>(r)];
            sum(r, c) = a.covariance(ar, ac) + b.covariance(br, bc);
        }
    }
    return pelorus::small::cholesky(sum, root) ? pelorus::small::inverse_quadratic(root, difference)
                                               : std::numeric_limits<double>::infinity();
}

/// Rows of the one side for columns of the other, at the least sum of squared distances, none above `gate` (a squared one; infinity:
/// all may pair). Where nothing is shared, a single one pairs with a single one.
inline std::vector<std::int64_t> match(const CommonSpace& common, const std::vector<const Piece*>& rows,
                                       const std::vector<const Piece*>& columns, double gate) {
    std::vector<double> costs;
    double largest = 0;
    int shared = 0;
    for (const Piece* row : rows)
        for (const Piece* column : columns) {
            const double apart = distance(common, *row, *column, shared);
            costs.push_back(apart <= gate ? apart : std::numeric_limits<double>::infinity());
            if (std::isfinite(costs.back())) largest = std::max(largest, costs.back());
        }
    if (shared == 0 && (rows.size() != 1 || columns.size() != 1))
        return std::vector<std::int64_t>(rows.size(), assignment::unassigned);
    // Whoever may pair does: to stay alone costs more than any number of pairs.
    const double alone = (largest + 1) * static_cast<double>(rows.size() + columns.size());
    return assignment::assign(static_cast<std::int64_t>(rows.size()), static_cast<std::int64_t>(columns.size()), costs,
                              alone);
}

}  // namespace fusion
