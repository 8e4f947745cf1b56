/// How many groups there are, for those who score groups.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "distance_groups.hpp"

namespace partition {

/// Into how many groups points (m; axes that they lack are 0) fall of which two are linked if they are less than `distance` apart,
/// 1e-9 m to 1e15 m. Points that are nowhere (not finite) are in none.
inline std::int64_t group_count(const std::vector<std::array<double, 3>>& points, double distance) {
    std::vector<double> places;
    for (const auto& point : points)
        if (std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]))
            places.insert(places.end(), point.begin(), point.end());
    const auto count = static_cast<std::int64_t>(places.size() / 3);
    if (count == 0) return 0;
    std::vector<unsigned char> block(distance_groups_need().bytes(count));
    Memory memory(block.data(), block.size());
    return distance_groups<3>(memory, pelorus::const_view(places.data(), 3, 1, count), distance, nullptr, nullptr)
        .count();
}

}  // namespace partition
