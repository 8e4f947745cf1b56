#include <cmath>

#include "../../../framework/host/services.hpp"
#include "../../common/partition/partition_rig.hpp"

using namespace partition;
using Eigen::MatrixXd;

namespace {

std::string threshold(double metres) { return "{threshold: " + std::to_string(metres) + "}"; }

MatrixXd points_of(std::initializer_list<std::initializer_list<double>> columns) {
    MatrixXd out(static_cast<Eigen::Index>(columns.begin()->size()), static_cast<Eigen::Index>(columns.size()));
    Eigen::Index c = 0;
    for (const auto& column : columns) {
        Eigen::Index r = 0;
        for (const double x : column) out(r++, c) = x;
        ++c;
    }
    return out;
}

/// The procedure of the paper: all pairs in a list, the nearest pair taken out again and again, and the cells of its two points
/// made one, until the nearest pair is not closer than the threshold.
std::vector<std::int64_t> published_procedure(const MatrixXd& points, double d0) {
    struct Pair {
        double square;
        Eigen::Index a, b;
    };
    std::vector<Pair> pairs;
    for (Eigen::Index a = 0; a < points.cols(); ++a)
        for (Eigen::Index b = a + 1; b < points.cols(); ++b) pairs.push_back({squared_distance(points, a, b), a, b});
    std::vector<std::int64_t> cell(static_cast<std::size_t>(points.cols()));
    std::iota(cell.begin(), cell.end(), 0);
    while (!pairs.empty()) {
        const auto nearest = std::min_element(pairs.begin(), pairs.end(),
                                              [](const Pair& x, const Pair& y) { return x.square < y.square; });
        if (!(nearest->square < d0 * d0)) break;
        const std::int64_t one = cell[static_cast<std::size_t>(nearest->a)],
                           other = cell[static_cast<std::size_t>(nearest->b)];
        for (std::int64_t& c : cell)
            if (c == std::max(one, other)) c = std::min(one, other);
        *nearest = pairs.back();
        pairs.pop_back();
    }
    return cell;
}

}  // namespace

TEST_CASE("distance partition: the cells are those of all pairs, for points of every kind", "[partition]") {
    std::mt19937_64 random(1);
    for (const double d0 : {1.0, 0.1, 37.0}) {
        PartitionerUnderTest distance("distance", threshold(d0));
        for (int d = 1; d <= 3; ++d)
            for (const Pattern which : all_patterns)
                for (const Eigen::Index count : {1, 2, 3, 30, 500}) {
                    INFO("threshold " << d0 << ", " << d << " dimensions, pattern " << static_cast<int>(which) << ", "
                                      << count << " points");
                    const MatrixXd points = pattern(which, d, count, d0, random);
                    const auto expected = components_by_pairs(count, [&](Eigen::Index i, Eigen::Index j) {
                        return squared_distance(points, i, j) < d0 * d0;
                    });
                    REQUIRE(first_members(distance.split({points, {}, {}, {}, {}}), count) == expected);
                }
    }
}

TEST_CASE("distance partition: thousands of points are split as all pairs say", "[partition]") {
    std::mt19937_64 random(2);
    PartitionerUnderTest distance("distance", threshold(1));
    for (const Pattern which : all_patterns) {
        INFO("pattern " << static_cast<int>(which));
        const MatrixXd points = pattern(which, 3, 4000, 1, random);
        const auto expected = components_by_pairs(
            4000, [&](Eigen::Index i, Eigen::Index j) { return squared_distance(points, i, j) < 1; });
        CHECK(first_members(distance.split({points, {}, {}, {}, {}}), 4000) == expected);
    }
}

TEST_CASE("distance partition: the published procedure gives the same cells", "[partition]") {
    std::mt19937_64 random(3);
    PartitionerUnderTest distance("distance", threshold(500));
    for (const Pattern which : {Pattern::uniform, Pattern::clumps, Pattern::half_lattice, Pattern::lattice}) {
        const MatrixXd points = pattern(which, 3, 90, 500, random);
        CHECK(first_members(distance.split({points, {}, {}, {}, {}}), 90) == published_procedure(points, 500));
    }
}

TEST_CASE("distance partition: a pair at the threshold is apart, one just below it together", "[partition]") {
    PartitionerUnderTest distance("distance", threshold(5));
    const auto cells = [&](double x, double y) {
        return distance.split({points_of({{0, 0}, {x, y}}), {}, {}, {}, {}}).size();
    };
    CHECK(cells(3, 4) == 2);
    CHECK(cells(3, std::nextafter(4, 0)) == 1);
    CHECK(cells(5, 0) == 2);
    CHECK(cells(std::nextafter(5, 0), 0) == 1);
    CHECK(cells(-5, 0) == 2);
}

TEST_CASE("distance partition: coordinates at the ends of the doubles are points like others", "[partition]") {
    PartitionerUnderTest distance("distance", threshold(1));
    const double huge = 1.7e308;
    const auto cells = distance.split(
        {points_of({{huge, 0}, {-huge, 0}, {huge, 0.5}, {0, 0}, {5e-324, 0}, {0, -huge}, {1e16, 3}, {1e16, 3.5}}),
         {},
         {},
         {},
         {}});
    REQUIRE(cells.size() == 5);
    CHECK(cells[0].points == std::vector<std::int64_t>{0, 2});
    CHECK(cells[2].points == std::vector<std::int64_t>{3, 4});
    CHECK(cells[4].points == std::vector<std::int64_t>{6, 7});
}

TEST_CASE("distance partition: members of a cell weigh alike, cells are of no prediction", "[partition]") {
    PartitionerUnderTest distance("distance", threshold(2));
    const auto cells = distance.split({points_of({{0}, {10}, {1}, {11}, {2}, {20}}), {}, {}, {}, {}});
    REQUIRE(cells.size() == 3);
    CHECK(cells[0].points == std::vector<std::int64_t>{0, 2, 4});
    CHECK(cells[0].weights == std::vector<double>(3, 1.0 / 3));
    CHECK(cells[1].points == std::vector<std::int64_t>{1, 3});
    CHECK(cells[2].points == std::vector<std::int64_t>{5});
    for (const auto& cell : cells) CHECK(cell.prediction == -1);
    CHECK(distance.weight(0) == 1);
    CHECK(distance.split({MatrixXd(2, 0), {}, {}, {}, {}}).empty());
}

TEST_CASE("distance partition: many threads answer what one does", "[partition]") {
    std::mt19937_64 random(4);
    PartitionerUnderTest distance("distance", threshold(1));
    pelorus::host::ThreadPool pool(4);
    for (const Pattern which : {Pattern::uniform, Pattern::clumps}) {
        const MatrixXd points = pattern(which, 2, 60000, 1, random);
        const auto alone = distance.split({points, {}, {}, {}, {}});
        for (int repeat = 0; repeat < 5; ++repeat) {
            const auto together = distance.split({points, {}, {}, {}, {}}, &pool.service());
            REQUIRE(first_members(together, 60000) == first_members(alone, 60000));
        }
    }
}

TEST_CASE("distance partition: a point that is not finite is refused by its number", "[partition]") {
    PartitionerUnderTest distance("distance", threshold(1));
    CHECK(distance.try_split({points_of({{0, 0}, {0, INFINITY}}), {}, {}, {}, {}}) == PLR_E_NUMERIC);
    CHECK(distance.message() == "point 1 is not finite");
}
