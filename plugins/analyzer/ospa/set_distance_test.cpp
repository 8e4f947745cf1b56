#include "set_distance.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace {

using ospa::Point;
using ospa::set_distance;

std::vector<Point> random_points(std::mt19937& random, std::size_t count, double spread) {
    std::uniform_real_distribution<double> place(-spread, spread);
    std::vector<Point> out(count);
    for (Point& point : out)
        for (double& x : point) x = place(random);
    return out;
}

double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// The definition of Schuhmacher, Vo and Vo, over all permutations of the larger set.
double ospa_by_definition(std::vector<Point> fewer, std::vector<Point> more, double c, double p) {
    if (fewer.size() > more.size()) std::swap(fewer, more);
    if (more.empty()) return 0;
    std::vector<std::size_t> order(more.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    double best = std::numeric_limits<double>::infinity();
    do {
        double sum = 0;
        for (std::size_t i = 0; i < fewer.size(); ++i)
            sum += std::pow(std::min(c, distance(fewer[i], more[order[i]])), p);
        best = std::min(best, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    const double n = static_cast<double>(more.size()), m = static_cast<double>(fewer.size());
    return std::pow((best + std::pow(c, p) * (n - m)) / n, 1 / p);
}

/// GOSPA as a choice of pairs, whatever their number: each object with one of the free estimates, or with none.
double gospa_power(const std::vector<Point>& objects, const std::vector<Point>& estimates, double c, double p,
                   std::size_t object, std::vector<char>& used) {
    const double half = std::pow(c, p) / 2;
    if (object == objects.size()) return half * static_cast<double>(std::count(used.begin(), used.end(), 0));
    double best = half + gospa_power(objects, estimates, c, p, object + 1, used);
    for (std::size_t j = 0; j < estimates.size(); ++j) {
        if (used[j] != 0) continue;
        used[j] = 1;
        best = std::min(best, std::pow(distance(objects[object], estimates[j]), p) +
                                  gospa_power(objects, estimates, c, p, object + 1, used));
        used[j] = 0;
    }
    return best;
}

}  // namespace

TEST_CASE("set distance: OSPA and GOSPA are those of the best of all assignments", "[ospa]") {
    std::mt19937 random(11);
    for (int problem = 0; problem < 400; ++problem) {
        const auto objects = random_points(random, random() % 7, 60),
                   estimates = random_points(random, random() % 7, 60);
        const double cutoff = problem % 2 == 0 ? 50 : 500, order = problem % 3 == 0 ? 1 : problem % 3 == 1 ? 2 : 3.5;
        const auto found = set_distance(objects, estimates, cutoff, order);
        REQUIRE(found.ospa == Approx(ospa_by_definition(objects, estimates, cutoff, order)).margin(1e-9));
        std::vector<char> used(estimates.size(), 0);
        const double power = gospa_power(objects, estimates, cutoff, order, 0, used);
        REQUIRE(found.gospa == Approx(std::pow(power, 1 / order)).margin(1e-9));
    }
}

TEST_CASE("set distance: the parts' powers add up, and roles change with the sides", "[ospa]") {
    std::mt19937 random(12);
    for (int problem = 0; problem < 100; ++problem) {
        const auto objects = random_points(random, random() % 9, 60),
                   estimates = random_points(random, random() % 9, 60);
        const double p = 1 + problem % 3;
        const auto d = set_distance(objects, estimates, 40, p), back = set_distance(estimates, objects, 40, p);
        CHECK(std::pow(d.ospa, p) ==
              Approx(std::pow(d.ospa_localisation, p) + std::pow(d.ospa_cardinality, p)).margin(1e-9));
        CHECK(std::pow(d.gospa, p) ==
              Approx(std::pow(d.gospa_localisation, p) + std::pow(d.gospa_missed, p) + std::pow(d.gospa_false, p))
                  .margin(1e-9));
        CHECK(std::pow(d.gospa_missed, p) == Approx(std::pow(40, p) / 2 * static_cast<double>(d.missed)).margin(1e-9));
        CHECK(back.ospa == Approx(d.ospa));
        CHECK(back.gospa == Approx(d.gospa));
        CHECK(back.missed == d.false_ones);
    }
}

TEST_CASE("set distance: one object missed, one far off, one false", "[ospa]") {
    const std::vector<Point> objects{{0, 0, 0}, {100, 0, 0}, {200, 0, 0}};
    const auto d = set_distance(objects, {{3, 4, 0}, {100, 30, 0}}, 10, 1);
    CHECK(d.missed == 2);
    CHECK(d.false_ones == 1);
    CHECK(d.ospa == Approx((5 + 10 + 10) / 3.0));
    CHECK(d.ospa_cardinality == Approx(10 / 3.0));
    CHECK(d.gospa == Approx(5 + 3 * 5));
    CHECK(d.gospa_localisation == Approx(5));
    CHECK(d.gospa_missed == Approx(10));
    CHECK(d.gospa_false == Approx(5));
}

TEST_CASE("set distance: empty sets", "[ospa]") {
    CHECK(set_distance({}, {}, 10, 2).ospa == 0);
    CHECK(set_distance({}, {}, 10, 2).gospa == 0);
    const auto none = set_distance({{0, 0, 0}, {1, 1, 1}}, {}, 10, 2);
    CHECK(none.ospa == 10);
    CHECK(none.gospa == Approx(10));  // (2 * 100 / 2)^(1/2)
    CHECK(none.missed == 2);
}

TEST_CASE("set distance: nearest first is not best, and is not taken", "[ospa]") {
    // 0 with 1 leaves 7 m for the others; crossed, it is 3 m twice.
    const auto d = set_distance({{0, 0, 0}, {4, 0, 0}}, {{1, 0, 0}, {-3, 0, 0}}, 100, 1);
    CHECK(d.ospa == Approx((3 + 3) / 2.0));
}

TEST_CASE("set distance: a thousand against a thousand", "[ospa]") {
    std::mt19937 random(13);
    auto objects = random_points(random, 1000, 1e4);
    auto estimates = objects;
    for (Point& point : estimates) point[0] += 1;
    std::shuffle(estimates.begin(), estimates.end(), random);
    CHECK(set_distance(objects, estimates, 1000, 2).ospa == Approx(1));
}
