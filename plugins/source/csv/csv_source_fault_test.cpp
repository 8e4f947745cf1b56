#include <catch2/catch.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "../../../tests/fixtures/temporary_folder.hpp"
#include "csv_source.hpp"

namespace {

using namespace pelorus::test;

const std::string plane = "columns: [{column: x, component: position.x}, {column: y, component: position.y}]";

/// Creates the source; answers what it refuses.
std::string refusal(const std::string& text, const std::string& with) {
    const TemporaryFolder folder;
    Bench bench;
    const std::string path = folder.write("r.csv", text);
    try {
        StageUnderTest stage(bench, plugin_of<source_csv::CsvSource>("source.csv"),
                             "{file: " + path + ", " + with + "}");
    } catch (const CallFailed& failed) {
        const std::string what = failed.what();
        const auto at = what.find(path);
        return at == std::string::npos ? what : std::string(what).replace(at, path.size(), "FILE");
    }
    return "";
}

/// Runs the source; answers how the run ended and what it logged, without the folder.
std::vector<std::string> told(const std::string& text, const std::string& with) {
    const TemporaryFolder folder;
    Bench bench;
    const std::string path = folder.write("r.csv", text);
    try {
        StageUnderTest stage(bench, plugin_of<source_csv::CsvSource>("source.csv"),
                             "{file: " + path + ", " + with + "}");
        stage.run();
    } catch (const CallFailed& failed) {
        bench.log.emplace_back(failed.what());
    }
    for (std::string& line : bench.log)
        for (auto at = line.find(path); at != std::string::npos; at = line.find(path))
            line.replace(at, path.size(), "FILE");
    return bench.log;
}

}  // namespace

TEST_CASE("source.csv refuses a missing, empty or unreadable file by name when it is created", "[source.csv]") {
    Bench bench;
    const TemporaryFolder folder;
    const auto make = [&](const std::string& path) {
        StageUnderTest stage(bench, plugin_of<source_csv::CsvSource>("source.csv"),
                             "{file: " + path + ", " + plane + "}");
    };
    CHECK_THROWS_WITH(make("/nowhere/at/all.csv"), "file: cannot read /nowhere/at/all.csv: No such file or directory");
    CHECK_THROWS_WITH(make(folder.path().string()), "file: cannot read " + folder.path().string() + ": it is a folder");
    CHECK(refusal("", plane) == "file: cannot read FILE: it is empty");
    CHECK(refusal("\"a", plane) == "file: cannot read FILE, its header: ends within a quoted field");
}

TEST_CASE("source.csv refuses columns that are not there and names those that are", "[source.csv]") {
    CHECK(refusal("time,x,z\n", plane) == "columns: the file has no column 'y'; it has time, x, z");
    CHECK(refusal("t,x,y\n", plane) == "time: the file has no column 'time'; it has t, x, y");
    CHECK(refusal("time,x,y,y\n", plane) == "columns: the file has several columns 'y'");
    CHECK(refusal("time,x,y\n", plane + ", identity: mmsi") ==
          "identity: the file has no column 'mmsi'; it has time, x, y");
    CHECK(refusal("0,1,2\n", "header: false, " + plane + ", time: 1") ==
          "columns: without a header, columns are numbers from 1, got 'x'");
}

TEST_CASE("source.csv refuses columns that make no measurement", "[source.csv]") {
    const auto columns = [](const std::string& rows) { return "columns: [" + rows + "]"; };
    const std::string x = "{column: x, component: position.x}", y = "{column: y, component: position.y}";
    const std::string head = "time,x,y,a\n";
    CHECK(refusal(head, columns(x + ", {column: a, component: azimuth}")) ==
          "columns: mixes position, spherical and geodetic components; a recording has one kind of measurement");
    CHECK(refusal(head, columns(y)) == "columns: position.y is given, but not position.x");
    CHECK(refusal(head, columns("{column: x, component: latitude}")) == "columns: names latitude, but not longitude");
    CHECK(refusal(head, columns("{column: x, component: position.x, unit: deg}")) ==
          "columns[0].unit: deg is no unit for position.x");
    CHECK(refusal(head, columns(x + ", {column: y, component: position.x}")) ==
          "columns[1]: position.x is given twice");
    CHECK(refusal(head, columns("{column: x, component: position.x, deviation: 1}, " + y)) ==
          "columns: gives a deviation to some measured components, but not to all");
    CHECK(refusal(head, columns("{column: x, component: position.x, deviation: -1}, " + y)) ==
          "columns[0].deviation: must be greater than 0");
    CHECK(refusal(head, columns("{column: a, component: true.speed}") + ", identity: a") ==
          "columns: names no measured component");
    CHECK(refusal(head, columns(x + ", " + y + ", {column: a, component: true.speed}") + ", identity: a") ==
          "columns: true.speed and true.course belong together");
    CHECK(refusal(head, columns(x + ", " + y + ", {column: a, component: true.position.x}")) ==
          "identity: columns name true components, but no column says of which object; name it, or with object: 1 all "
          "rows are of one");
    CHECK_THAT(
        refusal(head, columns("{column: x, component: range}, {column: a, component: azimuth}") + ", identity: a"),
        Catch::StartsWith("columns: with identity, a spherical recording must tell true positions"));
}

TEST_CASE("source.csv refuses settings that contradict each other", "[source.csv]") {
    CHECK(refusal("time,x,y,a\n", plane + ", object: 1, identity: a") ==
          "object: names the object of all rows, but so does the column in identity");
    CHECK_THAT(refusal("time,x,y\n", plane + ", duplicates: skip"),
               Catch::StartsWith("duplicates: are told by identity"));
    CHECK_THAT(refusal("time,x,y\n", plane + ", origin: [1 deg, 2 deg, 0 m]"), Catch::StartsWith("origin: belongs to"));
    CHECK_THAT(refusal("time,x,y\n",
                       "columns: [{column: x, component: latitude, unit: deg}, {column: y, component: "
                       "longitude, unit: deg}]"),
               Catch::StartsWith("origin: latitudes and longitudes need an origin"));
    CHECK_THAT(refusal("time,x,y\n", plane + ", start: noon"), Catch::StartsWith("start: 'noon' is no time"));
}

TEST_CASE("source.csv names file, line and column of a bad row and stops, unless told to go on", "[source.csv]") {
    const std::string end = " (bad_rows: skip would go on)";
    CHECK(told("time,x,y\n0,1,2\n1,abc,2\n", plane) ==
          std::vector<std::string>{"FILE:3: column 'x': 'abc' is no number" + end});
    CHECK(told("time,x,y\n0,1,\n", plane) == std::vector<std::string>{"FILE:2: column 'y': is empty" + end});
    CHECK(told("time,x,y\n0,1\n", plane) ==
          std::vector<std::string>{"FILE:2: column 'y': the row has only 2 fields" + end});
    CHECK(told("time,x,y\n0,nan,1\n", plane) ==
          std::vector<std::string>{"FILE:2: column 'x': 'nan' is not finite" + end});
    CHECK(told("time,x,y\n0,1.5m,1\n", plane) ==
          std::vector<std::string>{"FILE:2: column 'x': '1.5m' is no number" + end});
    CHECK(told("time,x,y\nnoon,1,1\n", plane) ==
          std::vector<std::string>{"FILE:2: column 'time': 'noon' is no time: expected a number" + end});
    CHECK(told("time,x,y,w\n0,1,1,-3\n", plane + ", identity: w") ==
          std::vector<std::string>{"FILE:2: column 'w': '-3' is no identity: expected a whole number from 0" + end});
    CHECK(told("time,x,y\n0,\"1\"1,1\n", plane) ==
          std::vector<std::string>{"FILE:2: has text after the closing quote of field 2" + end});
    const std::string geodetic =
        "columns: [{column: x, component: latitude, unit: deg}, {column: y, component: longitude, unit: deg}], origin: "
        "[50 "
        "deg, 0 deg, 0 m]";
    CHECK(told("time,x,y\n0,91,181\n", geodetic) ==
          std::vector<std::string>{"FILE:2: column 'x': '91' is beyond the poles" + end});
}

TEST_CASE("source.csv counts the bad rows that it leaves out, logs the first ones, and sums up", "[source.csv]") {
    std::string text = "time,x,y\n0,1,1\n";
    for (int i = 0; i < 25; ++i) text += "1,?,1\n";
    const auto log = told(text, plane + ", bad_rows: skip");
    REQUIRE(log.size() == 12);
    CHECK(log[0] == "FILE:3: column 'x': '?' is no number; the row is left out");
    CHECK(log[10] == "further bad rows are only counted");
    CHECK(log[11] == "FILE: 1 rows used; left out: 25 bad, 0 out of order, 0 duplicate, 0 before the start");
    CHECK(told("time,x,y\n", plane) == std::vector<std::string>{"FILE: no row was used"});
}

TEST_CASE("source.csv refuses the state of a recording that has changed, and keeps its own", "[source.csv]") {
    const TemporaryFolder folder;
    const std::string with = "{file: " + folder.write("r.csv", "time,x,y\n0,1,1\n1,2,2\n") + ", " + plane + "}";
    Bench bench;
    std::vector<unsigned char> state;
    {
        StageUnderTest before(bench, plugin_of<source_csv::CsvSource>("source.csv"), with);
        before.run(1);
        state = before.save();
    }
    bench.published.clear();
    folder.write("r.csv", "time,x,y\n0,1,1\n1,2,2\n2,3,3\n");
    StageUnderTest after(bench, plugin_of<source_csv::CsvSource>("source.csv"), with);
    CHECK_THROWS_WITH(after.load(state), Catch::EndsWith("has changed since the state was saved"));
    for (std::size_t size = 0; size < state.size(); ++size)
        CHECK_THROWS_AS(after.load({state.begin(), state.begin() + static_cast<std::ptrdiff_t>(size)}), CallFailed);
    after.run();
    CHECK(bench.published.size() == 3);
}
