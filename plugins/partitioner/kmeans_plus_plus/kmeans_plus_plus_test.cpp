#include <cmath>
#include <map>
#include <set>

#include "../../common/partition/partition_rig.hpp"

using namespace partition;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double sum_of_squares(const MatrixXd& points, const CellsSeen& cells) {
    double sum = 0;
    for (const CellSeen& cell : cells) {
        VectorXd mean = VectorXd::Zero(points.rows());
        for (const std::int64_t i : cell.points) mean += points.col(i) / static_cast<double>(cell.points.size());
        for (const std::int64_t i : cell.points) sum += (points.col(i) - mean).squaredNorm();
    }
    return sum;
}

/// The least sum of squares of all partitions into at most k cells, by trying them.
double least_sum_of_squares(const MatrixXd& points, std::size_t k) {
    std::vector<std::size_t> cell(static_cast<std::size_t>(points.cols()), 0);
    double least = 1e300;
    while (true) {
        CellsSeen cells(k);
        for (std::size_t i = 0; i < cell.size(); ++i) cells[cell[i]].points.push_back(static_cast<std::int64_t>(i));
        least = std::min(least, sum_of_squares(points, cells));
        std::size_t digit = 0;
        while (digit < cell.size() && ++cell[digit] == k) cell[digit++] = 0;
        if (digit == cell.size()) return least;
    }
}

/// Groups on a circle, far from each other.
MatrixXd groups(int count, int each, double deviation, std::mt19937_64& random) {
    std::normal_distribution<double> normal(0, deviation);
    MatrixXd points(2, count * each);
    for (int i = 0; i < count * each; ++i) {
        const double angle = 2 * std::acos(-1.0) * (i % count) / count;
        points.col(i) << 1000 * std::cos(angle) + normal(random), 1000 * std::sin(angle) + normal(random);
    }
    return points;
}

std::string cells_of(int least, int most, const std::string& more = "") {
    return "{least_cells: " + std::to_string(least) + ", most_cells: " + std::to_string(most) + more + "}";
}

}  // namespace

TEST_CASE("k-means++: of many tries one finds the best partition that there is", "[partition]") {
    std::mt19937_64 random(14);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int d = 1; d <= 3; ++d)
        for (int k = 1; k <= 3; ++k) {
            PartitionerUnderTest kmeans("kmeans_plus_plus", cells_of(k, k, ", tries: 200"));
            MatrixXd points(d, 9);
            for (double& x : points.reshaped()) x = uniform(random);
            const auto cells = kmeans.split({points, {}, {}, {}, {}});
            CHECK(cells.size() == static_cast<std::size_t>(k));
            CHECK(sum_of_squares(points, cells) ==
                  Approx(least_sum_of_squares(points, static_cast<std::size_t>(k))).epsilon(1e-12));
        }
}

TEST_CASE("k-means++: each point is with its nearest mean", "[partition]") {
    std::mt19937_64 random(15);
    const MatrixXd points = pattern(Pattern::uniform, 3, 500, 1, random);
    const auto cells =
        PartitionerUnderTest("kmeans_plus_plus", cells_of(12, 12, ", passes: 10000")).split({points, {}, {}, {}, {}});
    REQUIRE(cells.size() == 12);
    MatrixXd means = MatrixXd::Zero(3, 12);
    for (std::size_t c = 0; c < 12; ++c)
        for (const std::int64_t i : cells[c].points)
            means.col(static_cast<Eigen::Index>(c)) += points.col(i) / static_cast<double>(cells[c].points.size());
    for (std::size_t c = 0; c < 12; ++c)
        for (const std::int64_t i : cells[c].points) {
            const double own = (points.col(i) - means.col(static_cast<Eigen::Index>(c))).norm();
            CHECK(own <= (means.colwise() - points.col(i)).colwise().norm().minCoeff() + 1e-9);
        }
}

TEST_CASE("k-means++: both criteria find how many groups there are", "[partition]") {
    std::mt19937_64 random(16);
    for (const int count : {2, 3, 5, 7}) {
        const MatrixXd points = groups(count, 20, 40, random);
        for (const char* criterion : {"bic", "silhouette"}) {
            INFO(count << " groups by " << criterion);
            const auto cells =
                PartitionerUnderTest("kmeans_plus_plus", std::string("{criterion: ") + criterion + ", tries: 20}")
                    .split({points, {}, {}, {}, {}});
            REQUIRE(cells.size() == static_cast<std::size_t>(count));
            for (const auto& cell : cells)
                for (const std::int64_t i : cell.points) CHECK(i % count == cell.points[0]);
        }
    }
    // One group of known noise is one cell; a silhouette never says one where two halves look better.
    MatrixXd one = groups(1, 40, 30, random);
    CHECK(PartitionerUnderTest("kmeans_plus_plus").split({one, {900 * MatrixXd::Identity(2, 2)}, {}, {}, {}}).size() ==
          1);
}

TEST_CASE("k-means++: the second seed is drawn by squared distance", "[partition]") {
    // Points at 0, 2 and 5, two clusters: from the seeds {0, 2} the middle one stays with the far one, from all others with 0.
    // P(seeds {0, 2}) = (4/(4 + 25) + 4/(4 + 9))/3 = 0.1485; 4000 draws have a deviation of 0.0056.
    MatrixXd points(1, 3);
    points << 0, 2, 5;
    PartitionerUnderTest kmeans("kmeans_plus_plus", cells_of(2, 2, ", tries: 1"));
    constexpr int draws = 4000;
    int with_far = 0;
    for (int draw = 0; draw < draws; ++draw) {
        kmeans.key.word[0] = static_cast<std::uint64_t>(draw);
        const auto first = first_members(kmeans.split({points, {}, {}, {}, {}}), 3);
        with_far += first[1] == first[2] ? 1 : 0;
    }
    CHECK(with_far / double{draws} == Approx((4.0 / 29 + 4.0 / 13) / 3).margin(4 * 0.0056));
}

TEST_CASE("k-means++: alternatives are one for each number, and no more than there are different points",
          "[partition]") {
    MatrixXd points(1, 6);
    points << 0, 0, 10, 10, 30, 30;
    PartitionerUnderTest kmeans("kmeans_plus_plus", cells_of(1, 5, ", criterion: all"));
    const auto all = kmeans.split_all({points, {}, {}, {}, {}});
    REQUIRE(all.size() == 3);
    CHECK(all[0].size() == 1);
    CHECK(all[1].size() == 2);
    CHECK(all[2].size() == 3);
    CHECK(kmeans.weight(0) == Approx(0.2));
    CHECK(kmeans.weight(2) == Approx(0.6));  // 4 and 5 cells come to three, too
}

TEST_CASE("k-means++: the key decides, and nothing else", "[partition]") {
    std::mt19937_64 random(17);
    const MatrixXd points = pattern(Pattern::uniform, 2, 200, 1, random);
    PartitionerUnderTest kmeans("kmeans_plus_plus", cells_of(9, 9, ", tries: 1"));
    const auto once = first_members(kmeans.split({points, {}, {}, {}, {}}), 200);
    CHECK(first_members(kmeans.split({points, {}, {}, {}, {}}), 200) == once);
    std::set<std::vector<std::int64_t>> different;
    for (std::uint64_t draw = 0; draw < 10; ++draw) {
        kmeans.key.word[0] = draw;
        different.insert(first_members(kmeans.split({points, {}, {}, {}, {}}), 200));
    }
    CHECK(different.size() > 1);
}

TEST_CASE("k-means++: fewer cells at most than at least are refused", "[partition]") {
    CHECK_THROWS_WITH(PartitionerUnderTest("kmeans_plus_plus", cells_of(5, 4)), "most_cells: is less than least_cells");
}

TEST_CASE("k-means++: points so far apart that no sum of squares is finite are still each in one cell", "[partition]") {
    MatrixXd points(2, 5);
    points << -1e200, 1e200, 0, 1.7e308, -1.7e308,  //
        0, 0, 1e200, 1.7e308, -1.7e308;
    for (const char* criterion : {"bic", "silhouette"}) {
        const auto cells =
            PartitionerUnderTest("kmeans_plus_plus", cells_of(2, 4, std::string(", criterion: ") + criterion))
                .split({points, {}, {}, {}, {}});
        std::size_t members = 0;
        for (const auto& cell : cells) members += cell.points.size();
        CHECK(members == 5);
    }
}
