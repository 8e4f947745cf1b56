/// Single linkage: which points a chain of links shorter than a distance joins.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "components.hpp"
#include "grid.hpp"

namespace partition {

/// The box around points first .. last - 1 of a grid.
template <int D> struct Box {
    std::array<double, D> low, high;

    Box(const Grid<D>& grid, std::uint32_t first, std::uint32_t last) noexcept {
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
        for (std::uint32_t k = first; k < last; ++k)
            for (std::size_t axis = 0; axis < D; ++axis) {
                low[axis] = std::min(low[axis], grid.at(k)[axis]);
                high[axis] = std::max(high[axis], grid.at(k)[axis]);
            }
    }
    std::size_t longest_axis() const noexcept {
        std::size_t longest = 0;
        for (std::size_t axis = 1; axis < D; ++axis)
            if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
        return longest;
    }
    double length() const noexcept { return high[longest_axis()] - low[longest_axis()]; }
};

/// No pair of points has a smaller squared distance, to the last bit: every operation rounds monotonically.
template <int D> double least_squared_distance(const Box<D>& a, const Box<D>& b) noexcept {
    double sum = 0;
    for (std::size_t axis = 0; axis < D; ++axis) {
        const double gap = std::max({0.0, b.low[axis] - a.high[axis], a.low[axis] - b.high[axis]});
        sum += gap * gap;
    }
    return sum;
}
/// No pair has a larger one.
template <int D> double largest_squared_distance(const Box<D>& a, const Box<D>& b) noexcept {
    double sum = 0;
    for (std::size_t axis = 0; axis < D; ++axis) {
        const double across = std::max(a.high[axis] - b.low[axis], b.high[axis] - a.low[axis]);
        sum += across * across;
    }
    return sum;
}

/// Joins the cells of a grid between which there is a link |a - b|^2 < square. `square` is at least the square of the distance
/// that the grid was made for, rounded.
///
/// Cells that are joined already are passed over. Of others all pairs of points are tried where these are few; where they are
/// many, some pairs at first, which is enough wherever the cells run into each other, and at last boxes of points are halved
/// until they are seen to be near or far. So neither many points in one place nor two dense clouds that just do not touch
/// take time that grows with their pairs.
template <int D> class SingleLinkage {
public:
    /// `ends`: where in each cell the points end that count; none: all do.
    SingleLinkage(Grid<D>& grid, double square, Components& components, const std::uint32_t* ends = nullptr)
        : grid_(grid), square_(square), components_(components), ends_(ends) {}

    void link(const plr_parallel* parallel, plr_error* error) {
        const std::uint32_t cells = grid_.cell_count();
        if (parallel != nullptr && parallel->threads > 1 && cells >= 4 * block) {
            pelorus::require(parallel->run(parallel->context, cells, block, &link_block, this, error));
        } else {
            for (std::uint32_t first = 0; first < cells; first += block)
                link_block(first, std::min<std::int64_t>(first + std::int64_t{block}, cells));
        }
        link_crowded_cells();
    }

private:
    static constexpr std::uint32_t block = 4096;      // cells that are worked on together
    static constexpr std::uint64_t few_pairs = 256;   // so many are all tried
    static constexpr std::uint32_t tried_points = 8;  // of each of two crowded cells

    static plr_status link_block(void* self, std::int64_t first, std::int64_t last, plr_scratch*, plr_error*) noexcept {
        static_cast<SingleLinkage*>(self)->link_block(first, last);
        return PLR_OK;
    }
    void link_block(std::int64_t first, std::int64_t last) noexcept {
        grid_.for_near_cells(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last),
                             [this](std::uint32_t a, std::uint32_t b) {
                                 const std::uint32_t size_a = size(a), size_b = size(b);
                                 if (size_a == 1 && size_b == 1) {
                                     if (are_linked(grid_.begin(a), grid_.begin(b))) components_.join(a, b);
                                     return;
                                 }
                                 if (components_.joined(a, b)) return;
                                 const bool all = std::uint64_t{size_a} * size_b <= few_pairs;
                                 const std::uint32_t step_a = all ? 1 : (size_a + tried_points - 1) / tried_points;
                                 const std::uint32_t step_b = all ? 1 : (size_b + tried_points - 1) / tried_points;
                                 for (std::uint32_t k = grid_.begin(a); k < end(a); k += step_a)
                                     for (std::uint32_t l = grid_.begin(b); l < end(b); l += step_b)
                                         if (are_linked(k, l)) {
                                             components_.join(a, b);
                                             return;
                                         }
                             });
    }

    /// The pairs of cells of which only some points were tried. One thread: it changes the order of points within cells.
    void link_crowded_cells() noexcept {
        std::uint64_t largest = 0;
        for (std::uint32_t cell = 0; cell < grid_.cell_count(); ++cell)
            largest = std::max<std::uint64_t>(largest, size(cell));
        if (largest * largest <= few_pairs) return;
        for (std::uint32_t first = 0; first < grid_.cell_count(); first += block)
            grid_.for_near_cells(first, std::min(first + block, grid_.cell_count()),
                                 [this](std::uint32_t a, std::uint32_t b) {
                                     if (std::uint64_t{size(a)} * size(b) <= few_pairs) return;
                                     if (components_.joined(a, b)) return;
                                     if (are_linked({grid_.begin(a), end(a)}, {grid_.begin(b), end(b)}))
                                         components_.join(a, b);
                                 });
    }

    std::uint32_t end(std::uint32_t cell) const noexcept { return ends_ == nullptr ? grid_.end(cell) : ends_[cell]; }
    std::uint32_t size(std::uint32_t cell) const noexcept { return end(cell) - grid_.begin(cell); }

    bool are_linked(std::uint32_t k, std::uint32_t l) const noexcept {
        return squared_distance<D>(grid_.at(k), grid_.at(l)) < square_;
    }

    struct Range {
        std::uint32_t first, last;
        std::uint64_t size() const noexcept { return last - first; }
    };

    /// Whether a point of one range has a link to one of the other. Each range is within a cell.
    bool are_linked(Range a, Range b) noexcept {
        const Box<D> box_a(grid_, a.first, a.last), box_b(grid_, b.first, b.last);
        if (!(least_squared_distance(box_a, box_b) < square_)) return false;
        if (largest_squared_distance(box_a, box_b) < square_) return true;
        if (a.size() * b.size() <= few_pairs) {
            for (std::uint32_t k = a.first; k < a.last; ++k)
                for (std::uint32_t l = b.first; l < b.last; ++l)
                    if (are_linked(k, l)) return true;
            return false;
        }
        if (box_a.length() < box_b.length()) return are_linked_by_halves(b, box_b, a);
        return are_linked_by_halves(a, box_a, b);
    }
    /// The box is longer than 0: the points of two boxes without a length have one distance, the least and the largest.
    bool are_linked_by_halves(Range split, const Box<D>& box, Range other) noexcept {
        const std::size_t axis = box.longest_axis();
        double middle = box.low[axis] + (box.high[axis] - box.low[axis]) / 2;
        if (!(middle < box.high[axis])) middle = box.low[axis];  // neighbours among the doubles: the sum may round up
        std::uint32_t upper = split.first;
        for (std::uint32_t k = split.first; k < split.last; ++k)
            if (grid_.at(k)[axis] <= middle) grid_.swap(k, upper++);
        return are_linked(Range{split.first, upper}, other) || are_linked(Range{upper, split.last}, other);
    }

    Grid<D>& grid_;
    double square_;
    Components& components_;
    const std::uint32_t* ends_;
};

}  // namespace partition
