/// A scan to split, as a partitioner is handed it: checked once, then read without looking.
#pragma once

#include <cstdint>
#include <string>

#include <pelorus/batch_model.hpp>

namespace partition {

/// As many points as the numbers of a grid's cells have room for, were each point far from the next.
constexpr std::int64_t most_points = std::int64_t{1} << 28;

/// Coordinate `axis` of a point.
inline double coordinate(const plr_const_view& points, std::int64_t point, std::int64_t axis) noexcept {
    return points.data[point * points.item_stride + axis * points.row_stride];
}

/// Whether every number of every item is finite.
inline void expect_finite(const plr_const_view& view, const char* what) {
    const std::int64_t items = view.item_stride == 0 ? (view.count > 0 ? 1 : 0) : view.count;
    for (std::int64_t i = 0; i < items; ++i) {
        double check = 0;  // stays 0 unless a number is infinite or NaN
        for (std::int64_t c = 0; c < view.cols; ++c)
            for (std::int64_t r = 0; r < view.rows; ++r)
                check += 0.0 * view.data[i * view.item_stride + c * view.col_stride + r * view.row_stride];
        if (!(check == 0.0))
            throw pelorus::NumericError(std::string(what) + " " + std::to_string(i) + " is not finite");
    }
}

/// Throws ArgumentError for a scan of a shape that info does not promise, NumericError for points that are not finite.
inline void expect_points(const plr_partitioner_info& info, const plr_partitioner_split& args) {
    const std::int64_t dimension = args.points.rows;
    if (dimension < info.dimension_min || dimension > info.dimension_max)
        throw pelorus::ArgumentError("points: are of " + std::to_string(dimension) + " dimensions, expected " +
                                     std::to_string(info.dimension_min) + " to " + std::to_string(info.dimension_max));
    if (args.points.count > most_points)
        throw pelorus::ArgumentError("points: are more than " + std::to_string(most_points));
    pelorus::expect(args.points, dimension, 1, args.points.count, "points");
    expect_finite(args.points, "point");
}

/// Calls body.template operator()<D>() for D = dimension (1 to 3).
template <class Body> auto by_dimension(std::int64_t dimension, Body&& body) {
    using std::integral_constant;
    switch (dimension) {
        case 1:
            return body(integral_constant<int, 1>());
        case 2:
            return body(integral_constant<int, 2>());
        default:
            return body(integral_constant<int, 3>());
    }
}

}  // namespace partition
