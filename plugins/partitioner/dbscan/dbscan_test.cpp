#include <deque>
#include <tuple>

#include "../../common/partition/partition_rig.hpp"

using namespace partition;
using Eigen::MatrixXd;

namespace {

using Surroundings = std::vector<std::vector<Eigen::Index>>;

/// The points within epsilon of each point, itself included, by a look at all pairs.
Surroundings surroundings(const MatrixXd& points, double epsilon) {
    Surroundings out(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        for (Eigen::Index j = 0; j < points.cols(); ++j)
            if (squared_distance(points, i, j) <= epsilon * epsilon) out[static_cast<std::size_t>(i)].push_back(j);
    return out;
}

/// The algorithm of the paper: points in their order; an unclassified core point begins a cluster, which is expanded by the
/// surroundings of its core points. Noise has a number of its own each.
std::vector<std::int64_t> as_published(const Surroundings& near, std::size_t min_points) {
    constexpr std::int64_t unclassified = -1, noise = -2;
    std::vector<std::int64_t> cluster(near.size(), unclassified);
    for (std::size_t i = 0; i < near.size(); ++i) {
        if (cluster[i] != unclassified) continue;
        if (near[i].size() < min_points) {
            cluster[i] = noise;
            continue;
        }
        const auto id = static_cast<std::int64_t>(i);
        std::deque<std::size_t> seeds{i};
        cluster[i] = id;
        while (!seeds.empty()) {
            const std::size_t current = seeds.front();
            seeds.pop_front();
            if (near[current].size() < min_points) continue;
            for (const Eigen::Index j : near[current]) {
                const auto index = static_cast<std::size_t>(j);
                if (cluster[index] == unclassified) seeds.push_back(index);
                if (cluster[index] < 0) cluster[index] = id;
            }
        }
    }
    for (std::size_t i = 0; i < cluster.size(); ++i)
        if (cluster[i] == noise) cluster[i] = static_cast<std::int64_t>(i);
    return cluster;
}

/// The same with border points given to their nearest core point.
std::vector<std::int64_t> with_nearest_core(const MatrixXd& points, const Surroundings& near, std::size_t min_points) {
    std::vector<std::int64_t> cluster = as_published(near, min_points);
    const auto is_core = [&](Eigen::Index i) { return near[static_cast<std::size_t>(i)].size() >= min_points; };
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        if (is_core(i)) continue;
        std::tuple<double, std::vector<double>> best{1e300, {}};
        for (const Eigen::Index j : near[static_cast<std::size_t>(i)]) {
            if (!is_core(j)) continue;
            const std::tuple<double, std::vector<double>> one{
                squared_distance(points, i, j), {points.col(j).data(), points.col(j).data() + points.rows()}};
            if (!(one < best)) continue;
            best = one;
            cluster[static_cast<std::size_t>(i)] = cluster[static_cast<std::size_t>(j)];
        }
    }
    return cluster;
}

/// Whether both say of the same points that they are together.
bool same_partition(const std::vector<std::int64_t>& one, const std::vector<std::int64_t>& other) {
    for (std::size_t i = 0; i < one.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if ((one[i] == one[j]) != (other[i] == other[j])) return false;
    return true;
}

}  // namespace

TEST_CASE("dbscan: the cells are those of the published algorithm", "[partition]") {
    std::mt19937_64 random(11);
    for (const int min_points : {1, 2, 4, 9}) {
        const std::string with = "{epsilon: 1, min_points: " + std::to_string(min_points);
        PartitionerUnderTest first("dbscan", with + ", border: first}"), nearest("dbscan", with + "}");
        for (int d = 1; d <= 3; ++d)
            for (const Pattern which : all_patterns)
                for (const Eigen::Index count : {1, 7, 300}) {
                    INFO(min_points << " points, " << d << " dimensions, pattern " << static_cast<int>(which) << ", "
                                    << count << " points");
                    const MatrixXd points = pattern(which, d, count, 1, random);
                    const Surroundings near = surroundings(points, 1);
                    const auto least = static_cast<std::size_t>(min_points);
                    CHECK(same_partition(first_members(first.split({points, {}, {}, {}, {}}), count),
                                         as_published(near, least)));
                    CHECK(same_partition(first_members(nearest.split({points, {}, {}, {}, {}}), count),
                                         with_nearest_core(points, near, least)));
                }
    }
}

TEST_CASE("dbscan: crowded cells are counted and joined as all pairs say", "[partition]") {
    std::mt19937_64 random(12);
    PartitionerUnderTest dbscan("dbscan", "{epsilon: 1, min_points: 20, border: first}");
    for (const Pattern which : {Pattern::clumps, Pattern::ball, Pattern::facing_clouds, Pattern::facing_lines}) {
        INFO("pattern " << static_cast<int>(which));
        const MatrixXd points = pattern(which, 2, 1500, 1, random);
        CHECK(same_partition(first_members(dbscan.split({points, {}, {}, {}, {}}), 1500),
                             as_published(surroundings(points, 1), 20)));
    }
}

TEST_CASE("dbscan: a point between two clusters goes to the nearer one, or to the one that comes first",
          "[partition]") {
    // Two clusters of four on a line; 2.0 is 0.9 from the one and 0.95 from the other.
    Scene far_first, near_first;
    far_first.points.resize(1, 9);
    near_first.points.resize(1, 9);
    far_first.points << 0.45, 0.65, 0.85, 1.05, 2.9, 3.1, 3.3, 3.5, 2.0;
    near_first.points << 2.9, 3.1, 3.3, 3.5, 0.45, 0.65, 0.85, 1.05, 2.0;
    const std::vector<std::int64_t> with_border{0, 1, 2, 3, 8}, without{0, 1, 2, 3};
    PartitionerUnderTest nearest("dbscan", "{epsilon: 1}"), first("dbscan", "{epsilon: 1, border: first}");
    CHECK(nearest.split(near_first)[0].points == with_border);
    CHECK(nearest.split(far_first)[0].points == without);
    CHECK(first.split(near_first)[0].points == with_border);
    CHECK(first.split(far_first)[0].points == with_border);
}

TEST_CASE("dbscan: a step of exactly epsilon counts, however far away other points are", "[partition]") {
    // Beyond 2^30 cells these are numbered from one point to the next.
    PartitionerUnderTest dbscan("dbscan", "{epsilon: 1, min_points: 2}");
    for (const double far : {10.0, 1e12, 1e300}) {
        INFO("another point at " << far);
        MatrixXd points(1, 4);
        points << 0, 1, 2, far;
        CHECK(first_members(dbscan.split({points, {}, {}, {}, {}}), 4) == std::vector<std::int64_t>{0, 0, 0, 3});
    }
}
