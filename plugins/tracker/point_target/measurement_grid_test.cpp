#include "measurement_grid.hpp"

#include <catch2/catch.hpp>
#include <random>
#include <set>

using point_target::MeasurementGrid;
using point_target::Point;

TEST_CASE("The grid offers every point within the radius, each once", "[tracker.point_target]") {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(-1000, 1000);
    for (const int axes : {0, 1, 2})
        for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{500}}) {
            std::vector<Point> points(n);
            for (Point& p : points) p = {uniform(random), n == 7 ? 3.0 : uniform(random), uniform(random)};
            MeasurementGrid grid;
            grid.build(points, axes);
            for (int query = 0; query < 50; ++query) {
                const Point place{uniform(random) * 2, uniform(random) * 2, 0};
                const double radius = std::abs(uniform(random)) * (query % 10 == 0 ? 1e6 : 0.3);
                std::multiset<std::size_t> found;
                grid.near(place, radius, [&](std::size_t i) { found.insert(i); });
                for (std::size_t i = 0; i < n; ++i) {
                    const double x = points[i][0] - place[0], y = points[i][1] - place[1];
                    const double squares = (axes > 0 ? x * x : 0) + (axes > 1 ? y * y : 0);
                    REQUIRE(found.count(i) <= 1);
                    if (squares <= radius * radius) REQUIRE(found.count(i) == 1);
                }
            }
        }
}

TEST_CASE("The grid offers few points besides those within the radius", "[tracker.point_target]") {
    std::vector<Point> points;
    for (int x = 0; x < 100; ++x)
        for (int y = 0; y < 100; ++y) points.push_back({x * 10.0, y * 10.0, 0});
    MeasurementGrid grid;
    grid.build(points, 2);
    std::size_t offered = 0;
    for (const Point& p : points) grid.near(p, 15, [&](std::size_t) { ++offered; });
    CHECK(offered < points.size() * 40);  // of 10 000 each
}
