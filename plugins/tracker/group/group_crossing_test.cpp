/// Two clouds that cross: who is who afterwards, and what is told of it.
#include <algorithm>
#include <map>

#include <catch2/catch.hpp>

#include "group_rig.hpp"

using namespace group;
using Ids = std::vector<std::uint64_t>;

namespace {

/// Two squares with 10 m/s along x that pass each other at `speed` along y, in the same place at second 20. The first four
/// measurements of a scan are those of the square that goes up.
std::vector<Place> crossing(int k, double speed) {
    return both(square(10 * k, speed * (k - 20)), square(10 * k, -speed * (k - 20)));
}

/// Whether the members of an entry are the square that goes up (1), the other one (2) or some of both (3).
int square_of(const Entry& entry) {
    int found = 0;
    for (const std::uint64_t id : entry.measurements) found |= (id - 1) % 8 < 4 ? 1 : 2;
    return found;
}

}  // namespace

TEST_CASE("tracker.group: groups that cross quickly are themselves afterwards", "[tracker.group]") {
    Rig rig;
    rig.variance = 100;
    std::vector<Entry> told;
    std::map<std::uint64_t, int> before;
    for (int k = 0; k < 40; ++k) {
        told = rig.scan(k, crossing(k, 25));  // within the partitioner's 50 m of each other for about 4 s
        if (k == 10)
            for (const Entry& entry : told) before[entry.id] = square_of(entry);
    }
    REQUIRE(before.size() == 2);
    REQUIRE(told.size() == 2);
    for (const Entry& entry : told) {
        CHECK(square_of(entry) == before.at(entry.id));
        CHECK(entry.parents.empty());
    }
}

TEST_CASE("tracker.group: of groups that cross slowly the lineage says that they were one", "[tracker.group]") {
    Rig rig;
    rig.variance = 100;
    std::vector<Entry> told;
    Ids ended;
    for (int k = 0; k < 60; ++k) {
        told = rig.scan(k, crossing(k, 3));  // one cell for 20 s: longer than a group coasts
        for (const Entry& entry : told)
            if (entry.status == PLR_TRACK_DELETED) ended.push_back(entry.id);
    }
    REQUIRE(ended.size() == 1);
    REQUIRE(told.size() == 2);
    const Entry &survivor = told[0], &separated = told[1];
    CHECK(survivor.parents == ended);  // it has absorbed the other one
    CHECK(separated.parents ==
          Ids{survivor.id});  // and the part that left it came from both, as its parent's parents say
    CHECK(separated.id == 3);
}
