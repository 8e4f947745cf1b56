#include "association.hpp"

#include <catch2/catch.hpp>
#include <random>
#include <set>

using point_target::associate;
using point_target::GatedPair;

namespace {

using Chosen = std::vector<std::pair<std::size_t, std::size_t>>;  // track, detection

Chosen chosen(const std::vector<GatedPair>& pairs, double gate) {
    Chosen out;
    for (const std::size_t i : associate(pairs, gate)) out.emplace_back(pairs[i].track, pairs[i].detection);
    return out;
}
GatedPair pair(std::size_t track, std::size_t detection, double distance, double log_determinant = 0) {
    return {track, detection, 0, distance, log_determinant};
}

}  // namespace

TEST_CASE("Association takes the globally nearest, not each track's own", "[tracker.point_target]") {
    // Track 0 is nearest to 0, but track 1 can have nothing else.
    CHECK(chosen({pair(0, 0, 1), pair(0, 1, 2), pair(1, 0, 1.5)}, 10) == Chosen{{0, 1}, {1, 0}});
}

TEST_CASE("Association leaves a track without a detection rather than stretch two", "[tracker.point_target]") {
    CHECK(chosen({pair(0, 0, 0.1), pair(0, 1, 15), pair(1, 0, 14)}, 16) == Chosen{{0, 0}});
}

TEST_CASE("Association prefers the more certain track among equally distant ones", "[tracker.point_target]") {
    CHECK(chosen({pair(0, 0, 2, 8), pair(1, 0, 2.5, 3)}, 10) == Chosen{{1, 0}});
    CHECK(chosen({pair(0, 0, 2, 3), pair(1, 0, 2, 3)}, 10) == Chosen{{0, 0}});  // a tie: the older one
}

TEST_CASE("Association takes every pair that is alone, up to the gate", "[tracker.point_target]") {
    CHECK(chosen({pair(3, 7, 10), pair(5, 2, 0, 50)}, 10) == Chosen{{3, 7}, {5, 2}});
    CHECK(chosen({}, 10).empty());
}

TEST_CASE("Association of clusters is as good as that of the whole", "[tracker.point_target]") {
    std::mt19937 random(3);
    for (int trial = 0; trial < 300; ++trial) {
        std::vector<GatedPair> pairs;
        for (std::size_t t = 0; t < 12; ++t)
            for (std::size_t d = 0; d < 12; ++d)
                if (random() % 6 == 0) pairs.push_back(pair(t, d, static_cast<double>(random() % 1000) / 100));
        const auto one = chosen(pairs, 10);
        // Joined into one cluster by a track that is as far from everything as can be: the others choose as before.
        double before = 0, after = 0;
        for (const std::size_t i : associate(pairs, 10)) before += pairs[i].distance - 10;
        for (std::size_t d = 0; d < 12; ++d) pairs.push_back(pair(99, d, 10));
        for (const std::size_t i : associate(pairs, 10)) after += pairs[i].distance - 10;
        REQUIRE(before == Approx(after).margin(1e-9));
        std::set<std::size_t> tracks, detections;
        for (const auto& [t, d] : one) {
            REQUIRE(tracks.insert(t).second);
            REQUIRE(detections.insert(d).second);
        }
    }
}
