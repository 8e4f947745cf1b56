#include "csv_source.hpp"

#include <catch2/catch.hpp>
#include <GeographicLib/LocalCartesian.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "../../../tests/fixtures/temporary_folder.hpp"

namespace {

using namespace pelorus::test;
using source_csv::CsvSource;

constexpr std::int64_t second = 1'000'000'000;
constexpr double degree = 3.14159265358979323846 / 180;

const std::string plane_columns = "columns: [{column: x, component: position.x}, {column: y, component: position.y}]";

/// A recording, and the source that plays it.
struct Played {
    TemporaryFolder folder;
    Bench bench;
    std::unique_ptr<StageUnderTest> stage;

    Played(const std::string& text, const std::string& with, const std::string& frame = "") {
        const std::string path = folder.write("recording.csv", text);
        open(path, with, frame);
    }
    void open(const std::string& path, const std::string& with, const std::string& frame = "") {
        stage = std::make_unique<StageUnderTest>(bench, plugin_of<CsvSource>("source.csv"),
                                                 "{file: " + path + ", " + with + "}", std::vector<Instance::Part>{},
                                                 frame);
    }
    std::vector<Published> all(std::uint32_t port) {
        if (bench.published.empty()) stage->run();
        std::vector<Published> out;
        for (const Published& p : bench.published)
            if (p.port == port) out.push_back(p);
        return out;
    }
    std::vector<Published> scans() { return all(CsvSource::scans); }
    std::vector<Published> truths() { return all(CsvSource::truth); }
};

double value(const Published& p, std::int64_t item, std::int64_t component) {
    const plr_const_view& v = p.scan().measurements;
    return v.data[item * v.item_stride + component * v.row_stride];
}

}  // namespace

TEST_CASE("source.csv makes a scan of the rows of each time", "[source.csv]") {
    Played played("time,x,y\n10,1,2\n10,3,4\n10.5,5,6\n", plane_columns + ", sensor: radar");
    const auto scans = played.scans();
    REQUIRE(scans.size() == 2);
    CHECK(scans[0].message->time == 0);
    CHECK(scans[1].message->time == second / 2);
    REQUIRE(scans[0].scan().measurements.count == 2);
    CHECK(std::string(scans[0].scan().sensor) == "radar");
    CHECK(value(scans[0], 1, 0) == 3);
    CHECK(value(scans[0], 1, 1) == 4);
    CHECK(scans[0].scan().times == nullptr);
    CHECK(scans[0].scan().covariances.data == nullptr);
    CHECK(scans[0].scan().ids[0] == 2);  // the line of the file
    CHECK(scans[1].scan().ids[0] == 4);
    CHECK(played.truths().empty());
    CHECK(played.bench.counters["rows"] == 3);
}

TEST_CASE("source.csv converts units and publishes the deviations as covariances", "[source.csv]") {
    Played played(
        "time,r,b,e\n0,12,30,-1\n",
        "columns: [{column: e, component: elevation, unit: deg, deviation: 0.5}, {column: r, component: range, unit: "
        "km, deviation: 0.02}, {column: b, component: bearing, unit: deg, deviation: 0.1}]");
    const auto scan = played.scans().at(0);
    const plr_space& space = *scan.scan().space;
    REQUIRE(space.size == 3);
    CHECK(std::string(space.components[0].name) == "range");
    CHECK(std::string(space.components[1].name) == "azimuth");
    CHECK(std::string(space.components[2].name) == "elevation");
    CHECK(space.components[1].flags == PLR_COMPONENT_ANGLE);
    CHECK(value(scan, 0, 0) == Approx(12000));
    CHECK(value(scan, 0, 1) == Approx(60 * degree));
    CHECK(value(scan, 0, 2) == Approx(-degree));
    const auto covariance = pelorus::item(scan.scan().covariances, 0);
    CHECK(covariance(0, 0) == Approx(400));
    CHECK(covariance(1, 1) == Approx(0.1 * degree * 0.1 * degree));
    CHECK(covariance(2, 2) == Approx(0.5 * degree * 0.5 * degree));
    CHECK(covariance(0, 1) == 0);
}

TEST_CASE("source.csv wraps azimuths and bearings into one turn about 0", "[source.csv]") {
    Played played("time,r,a\n0,1,270\n1,1,180\n",
                  "columns: [{column: r, component: range}, {column: a, component: azimuth, unit: deg}]");
    CHECK(value(played.scans().at(0), 0, 1) == Approx(-90 * degree));
    CHECK(value(played.scans().at(1), 0, 1) == Approx(180 * degree));
}

TEST_CASE("source.csv turns latitudes and longitudes into local coordinates like GeographicLib does", "[source.csv]") {
    const std::string text = "time,lat,lon,h\n0,50.77301,-1.092935,12\n1,50.5172,-1.39,0\n";
    const std::string columns =
        "columns: [{column: lat, component: latitude, unit: deg, deviation: 5}, {column: lon, component: longitude, "
        "unit: "
        "deg, deviation: 7}, {column: h, component: height, deviation: 9}]";
    const GeographicLib::LocalCartesian local(50.8, -1.1, 3);
    double expected[3];
    local.Forward(50.77301, -1.092935, 12, expected[0], expected[1], expected[2]);

    Played by_origin(text, columns + ", origin: [50.8 deg, -1.1 deg, 3 m]");
    Played by_frame(text, columns.substr(0, 0) + columns + ", origin: [50.8 deg, -1.1 deg, 3 m]");
    by_frame.bench.frames.add_geodetic("harbour", 50.8 * degree, -1.1 * degree, 3);
    by_frame.open(by_frame.folder / "recording.csv", columns, "harbour");
    for (Played* played : {&by_origin, &by_frame}) {
        const auto scan = played->scans().at(0);
        for (std::int64_t i = 0; i < 3; ++i)
            CHECK(value(scan, 0, i) == Approx(expected[i]).margin(1e-6));      // both chains cancel numbers of 6.4e6 m
        CHECK(pelorus::item(scan.scan().covariances, 0)(0, 0) == Approx(49));  // east: that of the longitude
        CHECK(pelorus::item(scan.scan().covariances, 0)(1, 1) == Approx(25));
        CHECK(pelorus::item(scan.scan().covariances, 0)(2, 2) == Approx(81));
    }
    CHECK(std::string(by_frame.scans().at(0).scan().frame) == "harbour");
}

TEST_CASE("source.csv without heights puts reports at the height of the origin", "[source.csv]") {
    Played played(
        "time,lat,lon\n0,50.81,-1.11\n",
        "columns: [{column: lat, component: latitude, unit: deg}, {column: lon, component: longitude, unit: deg}], "
        "origin: [50.8 deg, -1.1 deg, 100 m]");
    double expected[3];
    GeographicLib::LocalCartesian(50.8, -1.1, 100).Forward(50.81, -1.11, 100, expected[0], expected[1], expected[2]);
    REQUIRE(played.scans().at(0).scan().space->size == 2);
    CHECK(value(played.scans().at(0), 0, 0) == Approx(expected[0]).margin(1e-9));
    CHECK(value(played.scans().at(0), 0, 1) == Approx(expected[1]).margin(1e-9));
}

TEST_CASE("source.csv tells the truth by identity: who, where, which measurements", "[source.csv]") {
    Played played(
        "time,x,y,who\n"
        "0,1,2,235070762\n"
        "0,1.5,2,235070762\n"
        "0,9,9,\n"
        "0,5,6,18446744073709551615\n"
        "1,2,2,235070762\n",
        plane_columns + ", identity: who");
    const auto truths = played.truths();
    REQUIRE(truths.size() == 2);
    const plr_truth& truth = truths[0].truth();
    REQUIRE(truth.count == 2);
    CHECK(truth.ids[0] == 235070762);
    CHECK(truth.ids[1] == 18446744073709551615u);
    REQUIRE(truth.measurement_offsets[1] == 2);  // two reports at once are one entry
    CHECK(truth.measurements[0] == 2);
    CHECK(truth.measurements[1] == 3);
    CHECK(pelorus::item(truth.state, 0)(0, 0) == 1);
    CHECK(truths[1].truth().births[0] == 0);
    CHECK(played.scans().at(0).scan().measurements.count == 4);  // the false alarm is measured, but nobody's
    CHECK(played.bench.published[0].port == CsvSource::truth);   // before the scan of the same time
}

TEST_CASE("source.csv reads true states beside measurements, and rows of objects that were not seen", "[source.csv]") {
    Played played(
        "time,r,a,who,tx,ty,speed,course\n"
        "0,100,0,7,99,1,10,90\n"
        "0,,,8,-50,2,4,180\n"
        "0,300,45,,,,,\n",
        "columns: [{column: r, component: range}, {column: a, component: azimuth, unit: deg}, {column: tx, component: "
        "true.position.x}, {column: ty, component: true.position.y}, {column: speed, component: true.speed, unit: "
        "km/h}, "
        "{column: course, component: true.course, unit: deg}], identity: who");
    const auto scan = played.scans().at(0);
    const plr_truth truth = played.truths().at(0).truth();
    CHECK(scan.scan().measurements.count == 2);
    REQUIRE(truth.count == 2);
    REQUIRE(truth.space->size == 4);
    CHECK(pelorus::item(truth.state, 0)(0, 0) == 99);
    CHECK(pelorus::item(truth.state, 0)(2, 0) == Approx(10 / 3.6));  // course 90: to the east
    CHECK(pelorus::item(truth.state, 0)(3, 0) == Approx(0).margin(1e-12));
    CHECK(pelorus::item(truth.state, 1)(3, 0) == Approx(-4 / 3.6));
    CHECK(truth.measurement_offsets[1] == 1);
    CHECK(truth.measurement_offsets[2] == 1);
}

TEST_CASE("source.csv groups rows by windows and keeps their times", "[source.csv]") {
    Played played("time,x,y\n0,0,0\n1.5,1,0\n3.9,2,0\n4,3,0\n11,4,0\n", plane_columns + ", window: 4 s");
    const auto scans = played.scans();
    REQUIRE(scans.size() == 3);
    REQUIRE(scans[0].scan().measurements.count == 3);
    CHECK(scans[0].message->time == 3900000000);  // known when its last row is
    CHECK(scans[0].scan().times[1] == 1500000000);
    CHECK(scans[1].scan().measurements.count == 1);
    CHECK(scans[2].scan().times[0] == 11 * second);
}

TEST_CASE("source.csv starts at the first row or at a given time, and stops after a duration", "[source.csv]") {
    const std::string text = "Time,x,y\n2016-01-12 13:02:11.5,1,1\n2016-01-12 13:02:12,2,2\n2016-01-12 13:02:20,3,3\n";
    const std::string with = plane_columns + ", time: Time, time_format: iso8601";
    CHECK(Played(text, with).scans().at(1).message->time == second / 2);

    Played later(text, with + ", start: 2016-01-12T13:02:12Z, duration: 5 s");
    REQUIRE(later.scans().size() == 1);
    CHECK(later.scans()[0].message->time == 0);
    CHECK(value(later.scans()[0], 0, 0) == 2);
    CHECK(later.bench.counters["rows_before_start"] == 1);

    Played early(text, with + ", start: 2016-01-12 13:00:00");
    CHECK(early.scans().at(0).message->time == 131 * second + second / 2);
}

TEST_CASE("source.csv reads columns by number where there is no header", "[source.csv]") {
    Played played(
        "# k i x y\n0 1 10 20\n1 1 11 21\n",
        "header: false, delimiter: space, comment: '#', time: 1, columns: [{column: 3, component: position.x}, "
        "{column: 4, component: position.y}]");
    REQUIRE(played.scans().size() == 2);
    CHECK(value(played.scans()[1], 0, 1) == 21);
}

TEST_CASE("source.csv selects rows by the text of columns", "[source.csv]") {
    Played played(
        "time,kind,run,x,y\n0,Z,1,1,1\n1,T,1,2,2\n2,Z,2,3,3\n3,W,1,4,4\n",
        plane_columns + ", select: [{column: kind, value: Z}, {column: kind, value: W}, {column: run, value: 1}]");
    REQUIRE(played.scans().size() == 2);
    CHECK(value(played.scans()[1], 0, 0) == 4);
}

TEST_CASE("source.csv treats rows that run backward in time as told", "[source.csv]") {
    const std::string text = "time,x,y\n0,0,0\n5,1,1\n3,2,2\n6,3,3\n";
    CHECK_THROWS_WITH(Played(text, plane_columns).scans(),
                      Catch::Contains("recording.csv:4: column 'time': time runs backward by 2.000 s"));

    Played skipped(text, plane_columns + ", out_of_order: skip");
    CHECK(skipped.scans().size() == 3);
    CHECK(skipped.bench.counters["out_of_order"] == 1);

    Played kept(text, plane_columns + ", out_of_order: keep");
    std::vector<std::pair<std::int64_t, std::int64_t>> events;  // arrival, stamp
    for (plr_next n = kept.stage->next(); n.what == PLR_NEXT_DATA; n = kept.stage->next()) {
        events.emplace_back(n.arrival / second, n.time / second);
        kept.stage->emit(n.arrival);
    }
    CHECK(events == std::vector<std::pair<std::int64_t, std::int64_t>>{{0, 0}, {5, 5}, {5, 3}, {6, 6}});
}

TEST_CASE("source.csv leaves out duplicate reports on request", "[source.csv]") {
    const std::string text = "time,x,y,who\n0,1,1,7\n0,1,1,7\n0,2,2,8\n1,1,1,7\n";
    Played kept(text, plane_columns + ", identity: who"),
        skipped(text, plane_columns + ", identity: who, duplicates: skip");
    CHECK(kept.scans()[0].scan().measurements.count == 3);
    CHECK(skipped.scans()[0].scan().measurements.count == 2);
    CHECK(skipped.scans().size() == 2);
    CHECK(skipped.bench.counters["duplicates"] == 1);
}

TEST_CASE("source.csv goes on exactly where its saved state left off", "[source.csv]") {
    std::string text = "time,x,y,who\n";
    for (int i = 0; i < 3000; ++i)
        text += (i % 50 == 7 ? "oops" : std::to_string(i / 3)) + "," + std::to_string(i) + ",1," +
                std::to_string(i % 5) + "\n";
    const std::string with = plane_columns + ", identity: who, bad_rows: skip, window: 2 s, duplicates: skip";
    Played whole(text, with);
    whole.stage->run();
    for (const bool packed : {false, true}) {
        Played first("", "header: false, time: 1, columns: [{column: 2, component: position.x}]");
        const std::string path = packed ? first.folder.write_gzip("r.gz", text) : first.folder.write("r.csv", text);
        first.open(path, with);
        first.stage->run(123);
        first.stage->next();  // reading ahead changes nothing
        const auto state = first.stage->save();
        Played second("", "header: false, time: 1, columns: [{column: 2, component: position.x}]");
        second.open(path, with);
        second.stage->load(state);
        second.stage->run();
        const std::size_t done = first.bench.published.size();
        REQUIRE(done + second.bench.published.size() == whole.bench.published.size());
        for (std::size_t i = 0; i < second.bench.published.size(); ++i) {
            const Published &a = second.bench.published[i], &b = whole.bench.published[done + i];
            REQUIRE(a.message->time == b.message->time);
            REQUIRE(a.port == b.port);
            if (a.port == CsvSource::scans) {
                REQUIRE(a.scan().measurements.count == b.scan().measurements.count);
                REQUIRE(value(a, 0, 0) == value(b, 0, 0));
                REQUIRE(a.scan().ids[0] == b.scan().ids[0]);
            } else {
                REQUIRE(a.truth().births[0] == b.truth().births[0]);
            }
        }
        // Bad rows are told once, not again by whoever resumes.
        CHECK(first.bench.counters["bad_rows"] + second.bench.counters["bad_rows"] == 60);
        CHECK(second.bench.log.back() == whole.bench.log.back().replace(0, whole.bench.log.back().find(':'), path));
    }
}

TEST_CASE("source.csv plays a file of two sensors of one object by a node for each, on one clock", "[source.csv]") {
    // x y time truth, or range azimuth time truth: the same columns mean other things.
    const std::string text = "P 1 2 10 5 6\nA 9 0.5 11 5 7\nP 3 4 12 5 8\n";
    const std::string common = "header: false, delimiter: space, object: 4, time: 4, start: 10, ";
    const std::string truth = "{column: 5, component: true.position.x}, {column: 6, component: true.position.y}]";
    Played places(text, common +
                            "select: [{column: 1, value: P}], columns: [{column: 2, component: position.x}, "
                            "{column: 3, component: position.y}, " +
                            truth);
    Played angles(text, common +
                            "select: [{column: 1, value: A}], columns: [{column: 2, component: range}, "
                            "{column: 3, component: azimuth}, " +
                            truth);
    REQUIRE(places.scans().size() == 2);
    REQUIRE(angles.scans().size() == 1);
    CHECK(places.scans()[1].message->time == 2 * second);
    CHECK(angles.scans()[0].message->time == second);
    CHECK(angles.scans()[0].scan().ids[0] == 2);
    CHECK(value(angles.scans()[0], 0, 1) == 0.5);
    REQUIRE(angles.truths().size() == 1);
    CHECK(angles.truths()[0].truth().ids[0] == 4);
    CHECK(pelorus::item(angles.truths()[0].truth().state, 0)(1, 0) == 7);
    CHECK(places.truths()[1].truth().ids[0] == 4);
}
