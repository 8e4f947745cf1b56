#include "lineage.hpp"

#include <catch2/catch.hpp>
#include <pelorus/archive.hpp>

namespace {

using track_then_group::Ids;
using track_then_group::Lineage;

/// Answers of a lineage that is told components, one step each second.
struct Family {
    Lineage lineage;
    std::int64_t time = 0;
    explicit Family(std::int64_t memory = Lineage::always) { lineage.setup(memory); }
    Ids step(const std::vector<Ids>& components) { return lineage.update(++time, components); }
};

}  // namespace

TEST_CASE("The larger part of a split keeps the group's id, the other one is its child", "[track_then_group]") {
    Family family;
    CHECK(family.step({{1, 2, 3, 4, 5}}) == Ids{1});
    CHECK(family.step({{1, 2}, {3, 4, 5}}) == Ids{2, 1});
    CHECK(family.lineage.parents(1).empty());
    CHECK(family.lineage.parents(2) == Ids{1});
    CHECK(family.step({{1}, {2}, {3, 4, 5}}) == Ids{2, 3, 1});
    CHECK(family.lineage.parents(3) == Ids{2});
    CHECK(family.lineage.ended().empty());
}

TEST_CASE("Of equal parts that with the eldest track keeps the id", "[track_then_group]") {
    Family family;
    family.step({{1, 2, 3, 4}});
    CHECK(family.step({{1, 4}, {2, 3}}) == Ids{1, 2});
}

TEST_CASE("A merger keeps the id of the larger group, which says whom it absorbed", "[track_then_group]") {
    Family family;
    CHECK(family.step({{1, 2}, {3, 4, 5}}) == Ids{1, 2});
    CHECK(family.step({{1, 2, 3, 4, 5}}) == Ids{2});
    CHECK(family.lineage.parents(2) == Ids{1});
    CHECK(family.lineage.ended().empty());
}

TEST_CASE("Groups that merge and part again are who they were", "[track_then_group]") {
    Family family;
    const std::vector<Ids> apart{{1, 2}, {3, 4, 5}};
    family.step(apart);
    for (int times = 0; times < 3; ++times) {
        CHECK(family.step({{1, 2, 3, 4, 5}}) == Ids{2});
        CHECK(family.step(apart) == Ids{1, 2});
    }
    CHECK(family.lineage.parents(1).empty());
    CHECK(family.lineage.parents(2) == Ids{1});
}

TEST_CASE("Groups absorbed one in the other come out of each other", "[track_then_group]") {
    Family family;
    family.step({{1, 2}, {3, 4, 5}, {6, 7, 8, 9}});
    CHECK(family.step({{1, 2, 3, 4, 5}, {6, 7, 8, 9}}) == Ids{2, 3});
    CHECK(family.step({{1, 2, 3, 4, 5, 6, 7, 8, 9}}) == Ids{3});
    CHECK(family.lineage.parents(3) == Ids{2});
    CHECK(family.step({{1, 2, 3, 4, 5}, {6, 7, 8, 9}}) == Ids{2, 3});
    CHECK(family.step({{1, 2}, {3, 4, 5}, {6, 7, 8, 9}}) == Ids{1, 2, 3});
}

TEST_CASE("Groups that exchanged members while they were one say so", "[track_then_group]") {
    Family family;
    family.step({{1, 2, 3}, {4, 5, 6}});
    CHECK(family.step({{1, 2, 3, 4, 5, 6}}) == Ids{1});
    CHECK(family.step({{1, 2, 4}, {3, 5, 6}}) == Ids{1, 2});
    CHECK(family.lineage.parents(1) == Ids{2});
    CHECK(family.lineage.parents(2) == Ids{1});
}

TEST_CASE("A part in which no group is at home by half is a new group", "[track_then_group]") {
    Family family;
    family.step({{1, 2, 3, 4, 5}, {6, 7}, {8, 9}});
    CHECK(family.step({{1, 2, 3, 4, 5, 6, 7, 8, 9}}) == Ids{1});
    CHECK(family.step({{1, 2, 3}, {4, 6, 8}, {5, 7, 9}}) == Ids{1, 4, 5});
    CHECK(family.lineage.parents(4) == Ids{1});
    CHECK(family.lineage.ended() == Ids{2, 3});  // nobody is left who could bring them back
}

TEST_CASE("A group goes on while a track of it lives", "[track_then_group]") {
    Family family;
    family.step({{1, 2, 3}});
    CHECK(family.step({{3, 4}}) == Ids{1});
    CHECK(family.step({{4}}) == Ids{1});
    CHECK(family.step({{5}}) == Ids{2});
    CHECK(family.lineage.ended() == Ids{1});
    CHECK(family.step({}) == Ids{});
    CHECK(family.lineage.ended() == Ids{2});
}

TEST_CASE("What was absorbed comes back when all others of the merger are gone", "[track_then_group]") {
    Family family;
    family.step({{1, 2}, {3, 4, 5}});
    family.step({{1, 2, 3, 4, 5}});
    CHECK(family.step({{1, 2}}) == Ids{1});
    CHECK(family.lineage.ended() == Ids{2});
}

TEST_CASE("Tracks that are less than the absorbed ones do not lose the group to them", "[track_then_group]") {
    Family family;
    family.step({{1, 2}, {3, 4, 5}});
    family.step({{1, 2, 3, 4, 5}});
    CHECK(family.step({{1, 2, 5}}) == Ids{2});
}

TEST_CASE("An absorbed group is remembered for a time", "[track_then_group]") {
    Family family(2);
    family.step({{1, 2}, {3, 4, 5}});
    family.step({{1, 2, 3, 4, 5}});
    CHECK(family.lineage.ended().empty());
    family.step({{1, 2, 3, 4, 5}});
    CHECK(family.lineage.ended().empty());
    family.step({{1, 2, 3, 4, 5}});
    CHECK(family.lineage.ended() == Ids{1});
    CHECK(family.step({{1, 2}, {3, 4, 5}}) == Ids{3, 2});
    CHECK(family.lineage.parents(3) == Ids{2});
}

TEST_CASE("A lineage that was saved goes on as it would have", "[track_then_group]") {
    Family family;
    family.step({{1, 2}, {3, 4, 5}});
    family.step({{1, 2, 3, 4, 5}});
    pelorus::StateWriter writer;
    family.lineage.state(writer);
    Family other;
    pelorus::StateReader reader(writer.bytes().data(), writer.bytes().size());
    other.lineage.state(reader);
    other.time = family.time;
    const std::vector<Ids> next{{1}, {2}, {3, 4, 5, 6}};
    CHECK(other.step(next) == family.step(next));
    CHECK(other.lineage.parents(3) == family.lineage.parents(3));
    CHECK(other.lineage.parents(3) == Ids{2});
}
