/// Cells by distance, whole: what a partitioner by distance answers, and what others do with the points left to them.
#pragma once

#include "groups.hpp"
#include "single_linkage.hpp"

namespace partition {

/// The memory that distance_groups takes.
constexpr Need distance_groups_need() noexcept {
    return Grid<3>::need() + Components::need() + array<std::uint32_t>() + Groups::need();
}

/// The connected components of the graph of all pairs with |a - b|^2 < threshold^2 (m^2, both sides as doubles round them),
/// a, b among `points`: exactly those, for any finite coordinates. O(points), whatever their number within a threshold.
/// `threshold` is from 1e-9 m to 1e15 m. `parallel` may be null; it makes no difference to the answer.
template <int D>
Groups distance_groups(Memory& memory, const plr_const_view& points, double threshold, const plr_parallel* parallel,
                       plr_error* error) {
    Grid<D> grid(memory, points, threshold);
    Components cells(memory, grid.cell_count());
    SingleLinkage<D>(grid, threshold * threshold, cells).link(parallel, error);
    auto* const label = memory.take<std::uint32_t>(grid.size());
    for (std::uint32_t cell = 0; cell < grid.cell_count(); ++cell) {
        const std::uint32_t root = cells.root(cell);
        for (std::uint32_t k = grid.begin(cell); k < grid.end(cell); ++k) label[grid.point(k)] = root;
    }
    return Groups(memory, grid.size(), [label](std::uint32_t i) { return label[i]; });
}

/// The same for a dimension that is known when it runs.
inline Groups distance_groups(Memory& memory, const plr_const_view& points, double threshold,
                              const plr_parallel* parallel, plr_error* error) {
    return by_dimension(points.rows, [&](auto dimension) {
        return distance_groups<decltype(dimension)::value>(memory, points, threshold, parallel, error);
    });
}

}  // namespace partition
