/// The assignment problem: rows to columns at the least total cost.
#pragma once

#include <cstdint>
#include <vector>

namespace assignment {

constexpr std::int64_t unassigned = -1;

/// Assigns each row to at most one column and each column to at most one row, or leaves a row unassigned at the cost
/// `cost_of_none`, such that the sum of costs is the least. costs[row * columns + column]; infinity: forbidden. Answers the
/// column of each row, or `unassigned`. Among equally good answers it is always the same one.
///
/// Successive shortest augmenting paths with dual prices, O(rows^2 columns).
/// Source: R. Jonker, A. Volgenant, A Shortest Augmenting Path Algorithm for Dense and Sparse Linear Assignment Problems,
/// Computing 38, 325-340, 1987 (the augmentation step); a row's private column of cost `cost_of_none` stands for none.
std::vector<std::int64_t> assign(std::int64_t rows, std::int64_t columns, const std::vector<double>& costs,
                                 double cost_of_none);

}  // namespace assignment
