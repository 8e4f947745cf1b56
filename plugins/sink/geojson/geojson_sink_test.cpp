#include "geojson_sink.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "../../../tests/fixtures/temporary_folder.hpp"

namespace {

using namespace pelorus::test;
using sink_geojson::GeoJsonSink;

constexpr double degree = 3.14159265358979323846 / 180;
const std::string origin = "{origin: [50.8 deg, -1.1 deg, 10 m]}";

/// One entry of a track in the plane.
void feed(StageUnderTest& sink, std::uint64_t id, std::int64_t time, double x, double y,
          std::int32_t status = PLR_TRACK_CONFIRMED, const std::string& frame = "") {
    pelorus::TracksBuilder builder(frame, pelorus::kinematic_space(2, {1, 1}));
    const double mean[] = {x, y, 0, 0}, covariance[16] = {};
    builder.add({id, time, status, 0, mean, covariance, nullptr, {}, 0, {}, {}});
    sink.receive(0, builder.message(time));
}

}  // namespace

TEST_CASE("sink.geojson writes lines on the map, as GeographicLib places them", "[sink.geojson]") {
    const TemporaryFolder folder;
    Bench bench;
    bench.folder = folder.path().string();
    StageUnderTest sink(bench, plugin_of<GeoJsonSink>("sink.geojson"), origin);
    feed(sink, 7, 0, 0, 0);
    feed(sink, 9, 500'000'000, -2000, 100, PLR_TRACK_TENTATIVE);
    feed(sink, 8, 1'000'000'000, 5, 5);
    feed(sink, 7, 2'500'000'000, 3000, 4000, PLR_TRACK_COASTING);
    feed(sink, 8, 3'000'000'000, 9, 9, PLR_TRACK_DELETED);
    sink.finish();
    const auto json = nlohmann::json::parse(folder.read("tracks.geojson"));
    CHECK(json["type"] == "FeatureCollection");
    REQUIRE(json["features"].size() == 2);
    const auto &ended = json["features"][0], &alive = json["features"][1];
    CHECK(ended["id"] == 8);  // ended first
    CHECK(ended["geometry"]["type"] == "Point");
    CHECK(alive["properties"]["id"] == 7);
    CHECK(alive["properties"]["start"] == 0);
    CHECK(alive["properties"]["end"] == 2.5);
    CHECK(alive["properties"]["times"] == nlohmann::json{0, 2.5});
    CHECK(alive["geometry"]["type"] == "LineString");
    const auto& line = alive["geometry"]["coordinates"];
    REQUIRE(line.size() == 2);
    CHECK(line[0][0].get<double>() == Approx(-1.1).margin(1e-7));
    CHECK(line[0][1].get<double>() == Approx(50.8).margin(1e-7));
    CHECK(line[0][2].get<double>() == Approx(10).margin(0.01));
    double latitude = 0, longitude = 0, height = 0;
    GeographicLib::LocalCartesian(50.8, -1.1, 10).Reverse(3000, 4000, 0, latitude, longitude, height);
    CHECK(line[1][0].get<double>() == Approx(longitude).margin(1e-7));
    CHECK(line[1][1].get<double>() == Approx(latitude).margin(1e-7));
}

TEST_CASE("sink.geojson takes the place of the tracks' frame, and refuses a frame without one", "[sink.geojson]") {
    const TemporaryFolder folder;
    Bench bench;
    bench.folder = folder.path().string();
    bench.frames.add_geodetic("harbour", 50.8 * degree, -1.1 * degree, 0);
    StageUnderTest sink(bench, plugin_of<GeoJsonSink>("sink.geojson"));
    feed(sink, 1, 0, 0, 0, PLR_TRACK_CONFIRMED, "harbour");
    CHECK_THROWS_WITH(feed(sink, 1, 0, 0, 0),
                      Catch::Contains("tracks come onto the map with a frame that stands on Earth, or with `origin`"));
    sink.finish();
    const auto json = nlohmann::json::parse(folder.read("tracks.geojson"));
    CHECK(json["features"][0]["geometry"]["coordinates"][1].get<double>() == Approx(50.8).margin(1e-7));
}

TEST_CASE("sink.geojson writes an empty collection where no track was confirmed", "[sink.geojson]") {
    const TemporaryFolder folder;
    Bench bench;
    bench.folder = folder.path().string();
    StageUnderTest sink(bench, plugin_of<GeoJsonSink>("sink.geojson"), origin);
    feed(sink, 1, 0, 0, 0, PLR_TRACK_TENTATIVE);
    sink.finish();
    CHECK(nlohmann::json::parse(folder.read("tracks.geojson"))["features"].empty());
}

TEST_CASE("sink.geojson goes on byte for byte where its saved state left off", "[sink.geojson]") {
    const auto play = [](StageUnderTest& sink, int first, int last) {
        for (int i = first; i < last; ++i)
            feed(sink, static_cast<std::uint64_t>(1 + i / 7 + i % 3), i, i, -i,
                 i % 11 == 10 ? PLR_TRACK_DELETED : PLR_TRACK_CONFIRMED);
    };
    const TemporaryFolder whole, halves;
    Bench bench;
    bench.folder = whole.path().string();
    StageUnderTest one(bench, plugin_of<GeoJsonSink>("sink.geojson"), origin);
    play(one, 0, 500);
    one.finish();
    bench.folder = halves.path().string();
    std::vector<unsigned char> state;
    {
        StageUnderTest first(bench, plugin_of<GeoJsonSink>("sink.geojson"), origin);
        play(first, 0, 200);
        state = first.save();
        play(first, 200, 300);
    }
    StageUnderTest second(bench, plugin_of<GeoJsonSink>("sink.geojson"), origin);
    second.load(state);
    play(second, 200, 500);
    second.finish();
    CHECK(halves.read("tracks.geojson") == whole.read("tracks.geojson"));
}
