#include <catch2/catch.hpp>

#include "report/lineage.hpp"

using pelorus::report::lineage_json;
using pelorus::report::Sighting;
using Json = nlohmann::ordered_json;

TEST_CASE("Where nobody has a parent there is no lineage") {
    CHECK(lineage_json({}).is_null());
    CHECK(lineage_json({{0, "1", ""}, {1, "1", ""}}).is_null());
}

TEST_CASE("Children stand below their parents, with the time when they came") {
    const Json lineage = lineage_json(
        {{0, "1", ""}, {0, "9", ""}, {5, "1", ""}, {5, "2", "1"}, {6, "3", "1"}, {7, "4", "2"}, {8, "2", "1"}});
    CHECK(lineage == Json::parse(R"([
        {"id": "1", "spans": [[0, 5]], "parents": []},
        {"id": "2", "spans": [[5, 8]], "parents": [["1", 5]]},
        {"id": "4", "spans": [[7, 7]], "parents": [["2", 7]]},
        {"id": "3", "spans": [[6, 6]], "parents": [["1", 6]]},
        {"id": "9", "spans": [[0, 0]], "parents": []}])"));
}

TEST_CASE("Who is absorbed and comes back has a gap, and stays where it was in the tree") {
    const Json lineage = lineage_json(
        {{0, "1", ""}, {0, "2", ""}, {1, "2", ""}, {2, "1", "2"}, {4, "1", "2"}, {5, "2", ""}, {6, "2", ""}});
    CHECK(lineage == Json::parse(R"([
        {"id": "1", "spans": [[0, 4]], "parents": [["2", 2]]},
        {"id": "2", "spans": [[0, 1], [5, 6]], "parents": []}])"));
}

TEST_CASE("Groups that are each other's parents, and parents that were never told, are no trouble") {
    const Json lineage = lineage_json({{0, "1", ""}, {0, "2", ""}, {1, "1", "2 7"}, {2, "1", "2 7"}, {2, "2", "1"}});
    REQUIRE(lineage.size() == 2);
    CHECK(lineage[0]["parents"] == Json::parse(R"([["2", 1], ["7", 1]])"));
    CHECK(lineage[1]["parents"] == Json::parse(R"([["1", 2]])"));
}

TEST_CASE("Of a large family those first seen are told") {
    std::vector<Sighting> sightings{{0, "0", ""}};
    for (int i = 1; i < 1000; ++i) sightings.push_back({1.0 * i, std::to_string(i), std::to_string(i - 1)});
    const Json lineage = lineage_json(sightings);
    CHECK(lineage.size() == pelorus::report::most_relatives);
    CHECK(lineage.back()["id"] == "299");
}
