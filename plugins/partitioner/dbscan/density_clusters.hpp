/// Clusters by density (DBSCAN), exactly, on a grid.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "../../common/partition/groups.hpp"
#include "../../common/partition/single_linkage.hpp"

namespace dbscan {

using partition::Components;
using partition::Grid;
using partition::Groups;
using partition::Memory;
using partition::Need;

/// Which cluster a border point is given to that is within reach of several.
enum class Border { nearest, first };

/// Core points have at least `min_points` points within epsilon, themselves counted; clusters are the core points that a chain
/// of steps of at most epsilon joins, and border points, which are within epsilon of one of them. The rest is noise.
///
/// A cell of the grid with min_points points has only core points, and all core points of a cell are of one cluster
/// (A. Gunawan, A Faster Algorithm for DBSCAN, Technische Universiteit Eindhoven 2013). O(points min_points) but for points that
/// border on crowded cells, which are looked at from outside.
template <int D> class DensityClusters {
public:
    static constexpr Need need() noexcept {
        using partition::array;
        return Grid<3>::need() + Components::need() + array<std::uint32_t>() + array<std::uint32_t>() +
               array<std::uint32_t>() + array<std::uint32_t>() + array<double>() + array<std::uint32_t>();
    }

    DensityClusters(Memory& memory, const plr_const_view& points, double epsilon, std::uint32_t min_points,
                    Border border, const plr_parallel* parallel, plr_error* error)
        : grid_(memory, points, epsilon),
          square_(epsilon * epsilon),
          min_points_(min_points),
          border_(border),
          clusters_(memory, grid_.cell_count()),
          neighbours_(memory.take<std::uint32_t>(grid_.size())),
          core_end_(memory.take<std::uint32_t>(grid_.cell_count())),
          first_core_(memory.take<std::uint32_t>(grid_.cell_count())),
          cluster_(memory.take<std::uint32_t>(grid_.size())),
          nearest_(memory.take<double>(grid_.size())),
          nearest_core_(memory.take<std::uint32_t>(grid_.size())) {
        count_neighbours();
        move_core_points_to_front();
        // A step of exactly epsilon counts: links are strictly shorter than the next number.
        partition::SingleLinkage<D>(grid_, std::nextafter(square_, std::numeric_limits<double>::infinity()), clusters_,
                                    core_end_)
            .link(parallel, error);
        find_first_core_points();
        give_border_points();
    }

    /// By point of the scan: a number less than the number of points, the same for all of a cluster; noise has its own each.
    void labels(std::uint32_t* label) const noexcept {
        for (std::uint32_t cell = 0; cell < grid_.cell_count(); ++cell)
            for (std::uint32_t k = grid_.begin(cell); k < grid_.end(cell); ++k) {
                const std::uint32_t cluster = k < core_end_[cell] ? clusters_.root(cell) : cluster_[k];
                label[grid_.point(k)] = cluster == none ? grid_.point(k) : first_core_[cluster];
            }
    }

private:
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    bool is_near(std::uint32_t k, std::uint32_t l) const noexcept {
        return partition::squared_distance<D>(grid_.at(k), grid_.at(l)) <= square_;
    }
    bool is_crowded(std::uint32_t cell) const noexcept { return grid_.points_in(cell) >= min_points_; }

    /// Up to min_points of them: more make no difference.
    void count_neighbours() noexcept {
        for (std::uint32_t cell = 0; cell < grid_.cell_count(); ++cell)
            for (std::uint32_t k = grid_.begin(cell); k < grid_.end(cell); ++k) neighbours_[k] = grid_.points_in(cell);
        grid_.for_near_cells(0, grid_.cell_count(), [this](std::uint32_t a, std::uint32_t b) {
            if (is_crowded(a) && is_crowded(b)) return;
            if (is_crowded(a)) std::swap(a, b);
            for (std::uint32_t k = grid_.begin(a); k < grid_.end(a); ++k)
                for (std::uint32_t l = grid_.begin(b); l < grid_.end(b); ++l) {
                    if (is_crowded(b) && neighbours_[k] >= min_points_) break;
                    if (!is_near(k, l)) continue;
                    ++neighbours_[k];
                    ++neighbours_[l];
                }
        });
    }

    void move_core_points_to_front() noexcept {
        for (std::uint32_t cell = 0; cell < grid_.cell_count(); ++cell) {
            std::uint32_t end = grid_.begin(cell);
            for (std::uint32_t k = grid_.begin(cell); k < grid_.end(cell); ++k) {
                if (neighbours_[k] < min_points_) continue;
                grid_.swap(k, end);
                std::swap(neighbours_[k], neighbours_[end]);
                ++end;
            }
            core_end_[cell] = end;
        }
    }

    /// Of each cluster (the cell that is its root) the core point with the smallest number.
    void find_first_core_points() noexcept {
        for (std::uint32_t cell = 0; cell < grid_.cell_count(); ++cell) first_core_[cell] = none;
        for (std::uint32_t cell = 0; cell < grid_.cell_count(); ++cell) {
            std::uint32_t& first = first_core_[clusters_.root(cell)];
            for (std::uint32_t k = grid_.begin(cell); k < core_end_[cell]; ++k) first = std::min(first, grid_.point(k));
        }
    }

    void give_border_points() noexcept {
        for (std::uint32_t cell = 0; cell < grid_.cell_count(); ++cell)
            for (std::uint32_t k = core_end_[cell]; k < grid_.end(cell); ++k) {
                cluster_[k] = none;
                nearest_[k] = std::numeric_limits<double>::infinity();
                for (std::uint32_t core = grid_.begin(cell); core < core_end_[cell]; ++core) consider(k, core, cell);
            }
        grid_.for_near_cells(0, grid_.cell_count(), [this](std::uint32_t a, std::uint32_t b) {
            give_border_points(a, b);
            give_border_points(b, a);
        });
    }
    void give_border_points(std::uint32_t cell, std::uint32_t core_cell) noexcept {
        for (std::uint32_t k = core_end_[cell]; k < grid_.end(cell); ++k)
            for (std::uint32_t core = grid_.begin(core_cell); core < core_end_[core_cell]; ++core)
                consider(k, core, core_cell);
    }
    void consider(std::uint32_t k, std::uint32_t core, std::uint32_t core_cell) noexcept {
        const double square = partition::squared_distance<D>(grid_.at(k), grid_.at(core));
        if (square > square_) return;
        const std::uint32_t cluster = clusters_.root(core_cell);
        const bool is_better =
            cluster_[k] == none ||
            (border_ == Border::first ? first_core_[cluster] < first_core_[cluster_[k]] : is_nearer(square, core, k));
        if (!is_better) return;
        cluster_[k] = cluster;
        nearest_[k] = square;
        nearest_core_[k] = core;
    }
    /// Of core points equally near, the one whose coordinates come first: it does not depend on the order of the points.
    bool is_nearer(double square, std::uint32_t core, std::uint32_t k) const noexcept {
        if (square != nearest_[k]) return square < nearest_[k];
        return std::lexicographical_compare(grid_.at(core), grid_.at(core) + D, grid_.at(nearest_core_[k]),
                                            grid_.at(nearest_core_[k]) + D);
    }

    Grid<D> grid_;
    double square_;
    std::uint32_t min_points_;
    Border border_;
    Components clusters_;        ///< of cells, joined where core points are
    std::uint32_t* neighbours_;  ///< by place in the grid
    std::uint32_t* core_end_;    ///< by cell: core points come first
    std::uint32_t* first_core_;  ///< by cell that is a root
    std::uint32_t* cluster_;     ///< of points that are not core points, by place
    double* nearest_;            ///< squared distance to the core point it was given by
    std::uint32_t* nearest_core_;
};

}  // namespace dbscan
