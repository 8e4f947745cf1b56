// configs/crossing_clouds.yaml and configs/ais_convoys.yaml: groups that cross, and convoys in a recording, which is found through
// PELORUS_DATA; without it that test says so and passes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;

namespace {

using Row = std::map<std::string, std::string>;

std::vector<Row> rows_of(const std::string& text) {
    std::istringstream lines(text);
    std::vector<std::string> names;
    std::vector<Row> rows;
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string> cells(1);
        for (const char c : line)
            if (c == ',')
                cells.emplace_back();
            else
                cells.back() += c;
        if (names.empty()) {
            names = cells;
            continue;
        }
        rows.emplace_back();
        for (std::size_t i = 0; i < names.size(); ++i) rows.back()[names[i]] = cells.at(i);
    }
    return rows;
}

double number(const Row& row, const std::string& name) { return std::stod(row.at(name)); }

/// Ids of the groups that tracks are in, by time.
std::map<double, std::set<std::string>> groups_by_time(const std::vector<Row>& tracks) {
    std::map<double, std::set<std::string>> groups;
    for (const Row& row : tracks)
        if (row.at("status") != "deleted") groups[number(row, "time")].insert(row.at("group"));
    return groups;
}

}  // namespace

TEST_CASE("Clouds that cross are one group for a while and part as who they were") {
    const TemporaryFolder folder;
    for (const std::string seed : {"1", "2", "3"}) {
        CAPTURE(seed);
        const Ended ended = pelorus_command({"run", std::string(PELORUS_SOURCE_DIR) + "/configs/crossing_clouds.yaml",
                                             "--seed", seed, "--out", folder / seed});
        INFO(ended.err);
        REQUIRE(ended.exit == 0);
        const auto groups = groups_by_time(rows_of(folder.read(seed + "/tracks.csv")));
        const std::set<std::string> both{"1", "2"};
        for (double time = 5; time <= 180; ++time) {
            CAPTURE(time);
            if (time < 60 || time > 125) CHECK(groups.at(time) == both);
            if (time >= 75 && time <= 110) CHECK(groups.at(time).size() == 1);
        }
        std::map<std::string, Row> first, last;
        for (const Row& row : rows_of(folder.read(seed + "/groups.csv"))) {
            CHECK(row.at("status") == "confirmed");
            first.emplace(row.at("id"), row);
            last[row.at("id")] = row;
        }
        REQUIRE(last.size() == 2);
        for (const auto& [id, row] : last) {
            CHECK(number(row, "time") == 180);
            // Straight through the other one: from 450 m on one side to 450 m on the other.
            CHECK(number(row, "position.y") * number(first.at(id), "position.y") < -400 * 400);
        }
        // Who was absorbed is a parent of who was not; no track went over.
        CHECK((last.at("1").at("parents") == "2") != (last.at("2").at("parents") == "1"));
    }
}

TEST_CASE("Clouds that cross as objects go on, or tell who absorbed whom and who came out of it") {
    const TemporaryFolder folder;
    for (const std::string seed : {"1", "2", "3", "4", "5"}) {
        CAPTURE(seed);
        const Ended ended =
            pelorus_command({"run", std::string(PELORUS_SOURCE_DIR) + "/configs/crossing_clouds_group.yaml", "--seed",
                             seed, "--out", folder / seed});
        INFO(ended.err);
        REQUIRE(ended.exit == 0);
        std::map<std::string, Row> first, last;
        for (const Row& row : rows_of(folder.read(seed + "/tracks.csv"))) {
            first.emplace(row.at("id"), row);
            last[row.at("id")] = row;
        }
        const auto crosses = [&](const std::string& id) {
            return number(last.at(id), "position.y") * number(first.at(id), "position.y") < -300 * 300;
        };
        const bool both_go_on = last.size() == 2;
        CHECK(crosses("1"));
        CHECK(last.at("1").at("parents") == (both_go_on ? "" : "2"));
        if (both_go_on) {
            CHECK(crosses("2"));
            CHECK(last.at("2").at("parents").empty());
        } else {
            REQUIRE(last.size() == 3);
            CHECK(last.at("2").at("status") == "deleted");
            CHECK(last.at("3").at("parents") == "1");
        }
    }
}

TEST_CASE("Vessels that move together are found in AIS reports, and no others", "[recording]") {
    const char* data = std::getenv("PELORUS_DATA");
    if (data == nullptr || !std::filesystem::exists(std::filesystem::path(data) / "SolentAIS_20160112_130211.csv")) {
        WARN("skipped: PELORUS_DATA names no folder with SolentAIS_20160112_130211.csv");
        return;
    }
    const TemporaryFolder folder;
    const Ended ended = pelorus_command(
        {"run", std::string(PELORUS_SOURCE_DIR) + "/configs/ais_convoys.yaml", "--out", folder / "out"});
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    // Who reported: the truth tells measurements with the MMSI as id.
    std::map<std::string, std::string> vessel_of;
    for (const Row& row : rows_of(folder.read("out/truth.csv"))) vessel_of[row.at("measurements")] = row.at("id");
    std::map<std::string, std::set<std::string>> tracks_of, vessels_of;
    for (const Row& row : rows_of(folder.read("out/tracks.csv"))) {
        const std::string& group = row.at("group");
        if (group.empty() || row.at("status") == "deleted") continue;
        tracks_of[group].insert(row.at("id"));
        if (const auto found = vessel_of.find(row.at("measurements")); found != vessel_of.end())
            vessels_of[group].insert(found->second);
    }
    std::set<std::set<std::string>> convoys;
    for (const auto& [group, tracks] : tracks_of)
        if (tracks.size() > 1) convoys.insert(vessels_of[group]);
    CHECK(convoys.size() <= 6);
    // A ship that two others keep close to, and four that travel as one.
    CHECK(convoys.count({"311855000", "235070762", "235072757"}) == 1);
    CHECK(convoys.count({"232002939", "235070763", "234586000", "235061621"}) == 1);
    const auto summary = nlohmann::json::parse(folder.read("out/summary.json"));
    const auto& lineage = summary["cells"][0]["tables"]["groups.lineage"];
    double largest = 0;
    for (std::size_t c = 0; c < lineage["columns"].size(); ++c)
        if (lineage["columns"][c]["name"] == "most_tracks")
            for (const auto& line : lineage["rows"]) largest = std::max(largest, line[c].get<double>());
    CHECK(largest == 4);
    for (const Row& row : rows_of(folder.read("out/groups.csv")))
        if (row.at("status") == "confirmed")
            CHECK(std::hypot(number(row, "velocity.x"), number(row, "velocity.y")) > 1);
}
