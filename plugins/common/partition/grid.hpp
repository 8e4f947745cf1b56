/// Points in a grid of cells so small that all points of a cell are within a distance of each other.
#pragma once

#include <array>
#include <cstdint>

#include <pelorus/abi/parallel.h>

#include "cell_index.hpp"
#include "memory.hpp"

namespace partition {

/// The occupied cells of a set of points, in order, with their points behind one another. Nothing else is kept: there is no
/// array of all cells, however far apart the points are. Making one is O(points), whatever their range.
///
/// A cell is half open and its diagonal just under `distance`: any two of its points are closer than that, and points that are
/// closer than it are in cells at most `reach` apart on each axis. Two cells on each axis make a block, and cells are ordered
/// by blocks: points that are closer than `distance` are in the same block or in neighbouring ones, of which there are few rows
/// to walk along. [worker, exclusive], afterwards reading is concurrent.
template <int D> class Grid {
public:
    /// `row`: number of its block on all axes but the first; `column`: that on the first axis, and in D bits the cell's place
    /// within the block; `point`: the place of the first of its points, the next cell's is their end.
    using Cell = Keyed;

    static constexpr Need need() noexcept {
        Need coordinates = array<double>();
        coordinates.per_point *= D;
        return array<Keyed>(1) + array<Keyed>(1) + coordinates + CellIndex<D>::need();
    }

    Grid(Memory& memory, const plr_const_view& points, double distance)
        : size_(static_cast<std::uint32_t>(points.count)) {
        Keyed* first = memory.take<Keyed>(size_ + std::size_t{1});
        Keyed* second = memory.take<Keyed>(size_ + std::size_t{1});
        coordinates_ = memory.take<double>(std::size_t{D} * size_);
        const CellIndex<D> index(memory, points, distance, first, second);
        points_ = sorted(index, first, second);
        for (std::uint32_t k = 0; k < size_; ++k)
            for (int axis = 0; axis < D; ++axis)
                coordinates_[std::size_t{D} * k + static_cast<std::size_t>(axis)] =
                    coordinate(points, points_[k].point, axis);
        collect_cells(points_ == first ? second : first);
    }

    std::uint32_t size() const noexcept { return size_; }  ///< points
    std::uint32_t cell_count() const noexcept { return cell_count_; }
    std::uint32_t begin(std::uint32_t cell) const noexcept { return cells_[cell].point; }
    std::uint32_t end(std::uint32_t cell) const noexcept { return cells_[cell + 1].point; }
    std::uint32_t points_in(std::uint32_t cell) const noexcept { return end(cell) - begin(cell); }
    /// The point of the scan that stands at place k.
    std::uint32_t point(std::uint32_t k) const noexcept { return points_[k].point; }
    const double* at(std::uint32_t k) const noexcept { return coordinates_ + std::size_t{D} * k; }

    /// Swaps two points of one cell.
    void swap(std::uint32_t a, std::uint32_t b) noexcept {
        std::swap(points_[a].point, points_[b].point);
        for (int axis = 0; axis < D; ++axis)
            std::swap(coordinates_[std::size_t{D} * a + static_cast<std::size_t>(axis)],
                      coordinates_[std::size_t{D} * b + static_cast<std::size_t>(axis)]);
    }

    /// Calls visit(cell, other) for each pair of cells within reach of each other (and some pairs of cells of one point beyond
    /// it) that is of the blocks which begin in [first, last).
    template <class Visit> void for_near_cells(std::uint32_t first, std::uint32_t last, Visit&& visit) const {
        while (first > 0 && first < last && same_block(first - 1, first)) ++first;
        if (first >= last) return;
        for (const RowStep& step : row_steps) {
            const std::uint64_t up = step.rows(row_bits_);
            std::uint32_t near = up == 0 ? first : lower_bound(cells_[first].row + up, before(cells_[first].column));
            for (std::uint32_t begin = first, end = first; begin < last; begin = end) {
                while (end < cell_count_ && same_block(begin, end)) ++end;
                if (up == 0) visit_within(begin, end, visit);
                const std::uint64_t row = cells_[begin].row + up;
                const std::uint32_t from = before(cells_[begin].column), to = behind_next(cells_[begin].column);
                if (up == 0)
                    near = end;
                else
                    while (cells_[near].row < row || (cells_[near].row == row && cells_[near].column < from)) ++near;
                for (std::uint32_t other = near; cells_[other].row == row && cells_[other].column < to; ++other)
                    for (std::uint32_t cell = begin; cell < end; ++cell) visit_if_near(cell, other, step, visit);
            }
        }
    }

private:
    /// A step to a row of blocks that comes later: so many along the second and the third axis.
    struct RowStep {
        int along_second, along_third;
        std::uint64_t rows(unsigned bits) const noexcept {
            return (static_cast<std::uint64_t>(static_cast<std::int64_t>(along_third)) << bits) +
                   static_cast<std::uint64_t>(static_cast<std::int64_t>(along_second));
        }
    };
    static constexpr std::size_t row_step_count = D == 1 ? 1 : D == 2 ? 2 : 5;
    static constexpr std::array<RowStep, 5> all_row_steps{{{0, 0}, {1, 0}, {0, 1}, {-1, 1}, {1, 1}}};
    static constexpr std::array<RowStep, row_step_count> row_steps = [] {
        std::array<RowStep, row_step_count> steps{};
        for (std::size_t k = 0; k < row_step_count; ++k) steps[k] = all_row_steps[k];
        return steps;
    }();

    bool same_block(std::uint32_t a, std::uint32_t b) const noexcept {
        return cells_[a].row == cells_[b].row && cells_[a].column >> D == cells_[b].column >> D;
    }
    /// Where the columns of the block before, and those behind the next block, begin.
    static std::uint32_t before(std::uint32_t column) noexcept { return ((column >> D) - 1) << D; }
    static std::uint32_t behind_next(std::uint32_t column) noexcept { return ((column >> D) + 2) << D; }

    template <class Visit> void visit_within(std::uint32_t begin, std::uint32_t end, Visit&& visit) const {
        for (std::uint32_t other = begin + 1; other < end; ++other)
            for (std::uint32_t cell = begin; cell < other; ++cell) visit(cell, other);
    }
    template <class Visit>
    void visit_if_near(std::uint32_t cell, std::uint32_t other, const RowStep& step, Visit&& visit) const {
        // Of cells of one point the distance says the same, sooner.
        if (end(other) - begin(other) + end(cell) - begin(cell) > 2) {
            const std::uint32_t a = cells_[cell].column, b = cells_[other].column;
            const auto is_far = [&](int blocks, int axis) {
                const int cells = 2 * blocks + static_cast<int>(b >> axis & 1) - static_cast<int>(a >> axis & 1);
                return cells > static_cast<int>(reach) || cells < -static_cast<int>(reach);
            };
            if (is_far(static_cast<int>(b >> D) - static_cast<int>(a >> D), 0)) return;
            if (D >= 2 && is_far(step.along_second, 1)) return;
            if (D >= 3 && is_far(step.along_third, 2)) return;
        }
        visit(cell, other);
    }

    Keyed* sorted(const CellIndex<D>& index, Keyed* first, Keyed* second) {
        row_bits_ = D < 3 ? 0 : detail::bits_of(index.most(1) / 2);
        std::uint64_t most_row = 0;
        if constexpr (D >= 2) most_row = index.most(1) / 2;
        if constexpr (D >= 3) most_row += std::uint64_t{index.most(2) / 2} << row_bits_;
        for (std::uint32_t i = 0; i < size_; ++i) {
            std::uint64_t row = 0;
            std::uint32_t number = index(i, 0), column = number / 2 << D | (number & 1);
            if constexpr (D >= 2) {
                number = index(i, 1);
                row = number / 2;
                column |= (number & 1) << 1;
            }
            if constexpr (D >= 3) {
                number = index(i, 2);
                row += std::uint64_t{number / 2} << row_bits_;
                column |= (number & 1) << 2;
            }
            first[i] = {row, column, i};
        }
        return radix_sort(first, second, size_, most_row, (index.most(0) / 2 << D) + (1u << D) - 1);
    }

    void collect_cells(Cell* cells) {
        for (std::uint32_t k = 0; k < size_; ++k)
            if (k == 0 || points_[k].row != points_[k - 1].row || points_[k].column != points_[k - 1].column)
                cells[cell_count_++] = {points_[k].row, points_[k].column, k};
        cells[cell_count_] = {~std::uint64_t{0}, ~std::uint32_t{0}, size_};  // behind all rows: walks end here
        cells_ = cells;
    }

    std::uint32_t lower_bound(std::uint64_t row, std::uint32_t column) const noexcept {
        std::uint32_t low = 0, high = cell_count_;
        while (low < high) {
            const std::uint32_t middle = low + (high - low) / 2;
            const bool is_before =
                cells_[middle].row < row || (cells_[middle].row == row && cells_[middle].column < column);
            (is_before ? low : high) = is_before ? middle + 1 : middle;
        }
        return low;
    }

    std::uint32_t size_, cell_count_ = 0;
    unsigned row_bits_ = 0;
    double* coordinates_ = nullptr;
    Keyed* points_ = nullptr;
    const Cell* cells_ = nullptr;
};

/// |a - b|^2, summed axis after axis as everything in this folder does: equal on both sides of a comparison.
template <int D> double squared_distance(const double* a, const double* b) noexcept {
    double sum = 0;
    for (int axis = 0; axis < D; ++axis) {
        const double difference = a[axis] - b[axis];
        sum += difference * difference;
    }
    return sum;
}

}  // namespace partition
