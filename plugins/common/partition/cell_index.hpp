/// Coordinates to numbers of grid cells, for any range of doubles.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "memory.hpp"
#include "radix_sort.hpp"
#include "scan.hpp"

namespace partition {

/// The number of a cell along one axis and the margin: cells that are `reach` away from an occupied one have numbers, too.
constexpr std::uint32_t reach = 2;
static_assert(most_points * (reach + 1) < (std::int64_t{1} << 30));

/// How far cells fall short of the largest that a distance allows. The number of a cell is found by a subtraction and a product,
/// each of which rounds, monotonically; with numbers up to 2^30 that moves a border by 1e-6 of a cell at most. So points with
/// the same number are closer than the distance however that went, and those closer than it are at most `reach` cells apart.
constexpr double shortfall = 1.0 / 131072;

constexpr double most_cells = 1073741824.0;  // 2^30

template <int D> class CellIndex {
public:
    static constexpr Need need() noexcept {
        return array<std::uint32_t>() + array<std::uint32_t>() + array<std::uint32_t>();
    }

    /// Numbers for cells in which two points are closer than `distance` (m). `first` and `second` are for count elements each
    /// and hold nothing afterwards.
    CellIndex(Memory& memory, const plr_const_view& points, double distance, Keyed* first, Keyed* second)
        : points_(points), inverse_(1 / (distance / std::sqrt(static_cast<double>(D)) * (1 - shortfall))) {
        for (int axis = 0; axis < D; ++axis) {
            auto& own = axes_[static_cast<std::size_t>(axis)];
            const auto [low, high] = range(axis);
            own.origin = low;
            const double cells = (high - low) * inverse_;
            if (cells < most_cells) {
                own.most = static_cast<std::uint32_t>(cells) + 2 * reach;
            } else {
                auto* const numbers = memory.take<std::uint32_t>(static_cast<std::size_t>(points.count));
                own.most = number_by_order(axis, distance, numbers, first, second) + reach;
                own.numbers = numbers;
            }
        }
    }

    /// From reach up.
    std::uint32_t operator()(std::int64_t point, int axis) const noexcept {
        const Axis& own = axes_[static_cast<std::size_t>(axis)];
        if (own.numbers != nullptr) return own.numbers[point];
        return number(coordinate(points_, point, axis), own.origin) + reach;
    }
    /// The largest number, with the margin.
    std::uint32_t most(int axis) const noexcept { return axes_[static_cast<std::size_t>(axis)].most; }

private:
    struct Axis {
        double origin = 0;
        std::uint32_t most = 0;
        const std::uint32_t* numbers = nullptr;  ///< of each point, where they do not follow from its coordinate
    };

    std::uint32_t number(double value, double origin) const noexcept {
        return static_cast<std::uint32_t>((value - origin) * inverse_);
    }

    std::pair<double, double> range(int axis) const noexcept {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::int64_t i = 0; i < points_.count; ++i) {
            const double value = coordinate(points_, i, axis);
            low = value < low ? value : low;
            high = value > high ? value : high;
        }
        return points_.count == 0 ? std::pair{0.0, 0.0} : std::pair{low, high};
    }

    /// A range of more cells than are counted: cells are numbered from one point to the next, in ascending order, and a gap
    /// of more than the distance, over which no two points meet, is told as just beyond reach. Answers the largest number.
    std::uint32_t number_by_order(int axis, double distance, std::uint32_t* numbers, Keyed* first,
                                  Keyed* second) const {
        const auto count = static_cast<std::size_t>(points_.count);
        for (std::size_t i = 0; i < count; ++i)
            first[i] = {ordered_bits(coordinate(points_, static_cast<std::int64_t>(i), axis)), 0,
                        static_cast<std::uint32_t>(i)};
        const Keyed* const sorted = radix_sort(first, second, count, std::numeric_limits<std::uint64_t>::max(), 0);
        std::uint32_t base = reach, latest = reach;
        double origin = coordinate(points_, sorted[0].point, axis), before = origin;
        for (std::size_t k = 0; k < count; ++k) {
            const double value = coordinate(points_, sorted[k].point, axis);
            if (value - before > distance) {
                base = latest + reach + 1;
                origin = value;
            }
            latest = base + number(value, origin);
            numbers[sorted[k].point] = latest;
            before = value;
        }
        return latest;
    }

    plr_const_view points_;
    double inverse_;
    std::array<Axis, D> axes_;
};

}  // namespace partition
