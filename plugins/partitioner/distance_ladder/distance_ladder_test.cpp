#include <set>

#include "../../common/partition/partition_rig.hpp"

using namespace partition;
using Eigen::MatrixXd;

TEST_CASE("distance ladder: the alternatives are the different partitions of its steps, by all pairs", "[partition]") {
    std::mt19937_64 random(13);
    const std::vector<double> thresholds{0.2, 0.5, 0.8, 1, 1.5, 3, 20};
    PartitionerUnderTest ladder("distance_ladder", "{thresholds: [0.2, 0.5, 0.8, 1, 1.5, 3, 20]}");
    for (int d = 1; d <= 3; ++d)
        for (const Pattern which : {Pattern::uniform, Pattern::clumps, Pattern::half_lattice, Pattern::lattice}) {
            INFO(d << " dimensions, pattern " << static_cast<int>(which));
            const MatrixXd points = pattern(which, d, 80, 1, random);
            std::vector<std::vector<std::int64_t>> expected;
            std::vector<double> shares;
            for (const double threshold : thresholds) {
                const auto one = components_by_pairs(80, [&](Eigen::Index i, Eigen::Index j) {
                    return squared_distance(points, i, j) < threshold * threshold;
                });
                if (expected.empty() || expected.back() != one) {
                    expected.push_back(one);
                    shares.push_back(0);
                }
                shares.back() += 1.0 / 7;
            }
            const auto all = ladder.split_all({points, {}, {}, {}, {}});
            REQUIRE(all.size() == expected.size());
            for (std::size_t a = 0; a < all.size(); ++a) {
                CHECK(first_members(all[a], 80) == expected[a]);
                CHECK(ladder.weight(static_cast<std::int64_t>(a)) == Approx(shares[a]));
            }
        }
}

TEST_CASE("distance ladder: steps that do not ascend are refused by their number", "[partition]") {
    CHECK_THROWS_WITH(PartitionerUnderTest("distance_ladder", "{thresholds: [1, 2, 2]}"),
                      "thresholds[2]: is not greater than the one before it");
}
