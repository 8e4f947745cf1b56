#include "association.hpp"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

using namespace group;

TEST_CASE("group association: the nearest pair comes first and each one is taken once", "[tracker.group]") {
    // The pair of distance 1 takes left 0 from right 1, which then has to be content with left 1.
    const auto taken = nearest_first({{0, 1, 2.0}, {0, 0, 1.0}, {1, 0, 1.5}, {1, 1, 9.0}});
    REQUIRE(taken.size() == 2);
    CHECK(taken[0].left == 0);
    CHECK(taken[0].right == 0);
    CHECK(taken[1].left == 1);
    CHECK(taken[1].right == 1);
    CHECK(nearest_first({}).empty());
}

TEST_CASE("group association: among pairs of one distance the smaller numbers win", "[tracker.group]") {
    const auto taken = nearest_first({{1, 0, 1.0}, {0, 1, 1.0}, {0, 0, 1.0}, {1, 1, 1.0}});
    REQUIRE(taken.size() == 2);
    CHECK((taken[0].left == 0 && taken[0].right == 0));
    CHECK((taken[1].left == 1 && taken[1].right == 1));
}

TEST_CASE("group association: what has no covariance is at no distance", "[tracker.group]") {
    Eigen::Matrix2d covariance;
    covariance << 4, 0, 0, 9;
    CHECK(squared_distance(Eigen::Vector2d(2, 3), covariance) == Approx(2));
    covariance(1, 1) = 0;
    CHECK(squared_distance(Eigen::Vector2d(2, 3), covariance) == std::numeric_limits<double>::infinity());
}

TEST_CASE("group association: the nearest point is that by its own noise, too", "[tracker.group]") {
    extended::Points points;
    points.dimension = 2;
    points.positions = {3, 0, 4, 0};
    points.noise = {1, 0, 0, 1, 9, 0, 0, 9};  // 3 m with S = 2 m2, 4 m with S = 10 m2
    points.ids = {1, 2};
    const Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
    CHECK(nearest_point(Eigen::Vector2d::Zero(), covariance, points, 9.0) == std::optional<std::size_t>(1));
    CHECK(nearest_point(Eigen::Vector2d::Zero(), covariance, points, 1.6) == std::nullopt);
}
