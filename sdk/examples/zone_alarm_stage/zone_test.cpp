// Distances to the edge of an L, where they can be told by looking at it.
#include <cstdio>

#include "zone.hpp"

int main() {
    Corners corners(6, 2);
    corners << 0, 0, 4, 0, 4, 2, 2, 2, 2, 4, 0, 4;
    struct Case {
        double x, y, distance;
    };
    const Case cases[] = {{1, 1, -1}, {1, 3, -1}, {3, 3, 1},    {2.5, 2.25, 0.25},
                          {3, 1, -1}, {-3, 1, 3}, {7, -4, 5.0}, {1.5, 1.5, -std::sqrt(0.5)},
                          {4, 1, 0},  {1, 0, 0},  {1, 9, 5}};
    int failures = 0;
    for (const Case& c : cases) {
        const double distance = distance_outside(corners, c.x, c.y);
        const bool good = std::fabs(distance - c.distance) < 1e-12;
        failures += good ? 0 : 1;
        if (!good) std::printf("(%g, %g): %g, expected %g\n", c.x, c.y, distance, c.distance);
    }
    if (twice_area(corners) != 24) ++failures, std::printf("area %g, expected 12\n", twice_area(corners) / 2);
    if (!std::isnan(distance_outside(corners, std::nan(""), 1))) ++failures, std::printf("nowhere is somewhere\n");
    if (failures == 0) std::printf("all distances as they must be\n");
    return failures == 0 ? 0 : 1;
}
