#include "csv_sink.hpp"

#include <catch2/catch.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "../../../tests/fixtures/temporary_folder.hpp"

namespace {

using namespace pelorus::test;
using sink_csv::CsvSink;

enum Port : std::uint32_t { tracks, truth, scans };

pelorus::TracksBuilder two_tracks() {
    pelorus::TracksBuilder builder("", pelorus::kinematic_space(1, {1, 1}));
    const double mean[] = {1.5, -0.1}, covariance[] = {4, 0.5, 0.5, 9};
    builder.add({7, 1'500'000'000, PLR_TRACK_CONFIRMED, 0, mean, covariance, nullptr, {}, 0, {12, 13}, {1, 2}});
    builder.add({8, -1, PLR_TRACK_DELETED, 3, mean, covariance, nullptr, {7, 5}, 2, {}, {}});
    return builder;
}

}  // namespace

TEST_CASE("sink.csv writes tracks exactly, one row an entry", "[sink.csv]") {
    const TemporaryFolder folder;
    Bench bench;
    bench.folder = folder.path().string();
    StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
    auto builder = two_tracks();
    sink.receive(tracks, builder.message(0));
    CHECK_FALSE(folder.has("tracks.csv"));  // only once it is complete
    sink.finish();
    CHECK(folder.read("tracks.csv") ==
          "time,id,status,misses,position.x,velocity.x,deviation.position.x,deviation.velocity.x,parents,group,"
          "measurements\n"
          "1.5,7,confirmed,0,1.5,-0.1,2,3,,,12 13\n"
          "-0.000000001,8,deleted,3,1.5,-0.1,2,3,7 5,2,\n");
    CHECK_FALSE(folder.has("tracks.csv.part"));
    CHECK_FALSE(folder.has("truth.csv"));
}

TEST_CASE("sink.csv writes no uncertainty or all of it on request", "[sink.csv]") {
    const TemporaryFolder folder;
    Bench bench;
    bench.folder = folder.path().string();
    auto builder = two_tracks();
    for (const char* word : {"none", "covariance"}) {
        StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"),
                            std::string("{tracks: sub/") + word + ".csv, uncertainty: " + word + "}");
        sink.receive(tracks, builder.message(0));
        sink.finish();
    }
    CHECK_THAT(folder.read("sub/none.csv"), Catch::Contains("\n1.5,7,confirmed,0,1.5,-0.1,,,12 13\n"));
    CHECK_THAT(
        folder.read("sub/covariance.csv"),
        Catch::Contains("covariance.position.x.position.x,covariance.position.x.velocity.x,covariance.velocity.x.") &&
            Catch::Contains("\n1.5,7,confirmed,0,1.5,-0.1,4,0.5,9,,,12 13\n"));
}

TEST_CASE("sink.csv writes truth with shapes and lineage, and scans by sensor", "[sink.csv]") {
    const TemporaryFolder folder;
    Bench bench;
    bench.folder = folder.path().string();
    StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
    pelorus::TruthBuilder objects("", pelorus::position_space(2), 2);
    const double state[] = {1, 2}, shape[] = {3, 0.25, 0.25, 4};
    objects.add({1, 0, state, shape, 1, 0, {5}});
    objects.add({2, 0, state, shape, 1, 0, {}});
    sink.receive(truth, objects.message(0));
    pelorus::ScanBuilder radar("radar, \"A\"", "", pelorus::position_space(2)),
        eo("eo/1", "", pelorus::position_space(1));
    radar.add(4, state);
    radar.set_snr(20);
    radar.set_time(7);
    eo.add(5, state);
    sink.receive(scans, radar.message(9));
    sink.receive(scans, eo.message(9));
    sink.finish();
    CHECK(folder.read("truth.csv") ==
          "time,id,position.x,position.y,extent.xx,extent.xy,extent.yy,parent,measurements\n"
          "0,1,1,2,3,0.25,4,,5\n"
          "0,2,1,2,3,0.25,4,1,\n");
    CHECK(folder.read("scans_radar, \"A\".csv") == "time,id,position.x,position.y,snr\n0.000000007,4,1,2,20\n");
    CHECK(folder.read("scans_eo_1.csv") == "time,id,position.x,snr\n0.000000009,5,1,\n");
}

TEST_CASE("sink.csv writes at least the header of what came without entries", "[sink.csv]") {
    const TemporaryFolder folder;
    Bench bench;
    bench.folder = folder.path().string();
    StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"), "{uncertainty: none}");
    pelorus::TracksBuilder nobody("", pelorus::position_space(1));
    sink.receive(tracks, nobody.message(0));
    sink.finish();
    CHECK(folder.read("tracks.csv") == "time,id,status,misses,position.x,parents,group,measurements\n");
}

TEST_CASE("sink.csv refuses messages of other columns and keeps the file as it was", "[sink.csv]") {
    const TemporaryFolder folder;
    Bench bench;
    bench.folder = folder.path().string();
    StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"), "{uncertainty: none}");
    auto builder = two_tracks();
    sink.receive(tracks, builder.message(0));
    pelorus::TracksBuilder other("", pelorus::position_space(1));
    const double mean[] = {1}, covariance[] = {1};
    other.add({1, 0, PLR_TRACK_CONFIRMED, 0, mean, covariance, nullptr, {}, 0, {}, {}});
    try {
        sink.receive(tracks, other.message(0));
        FAIL("taken");
    } catch (const CallFailed& failed) {
        CHECK(failed.status == PLR_E_DATA);
        CHECK_THAT(failed.what(), Catch::StartsWith("the file has the columns time,id,"));
    }
    sink.finish();
    const std::string text = folder.read("tracks.csv");
    CHECK(std::count(text.begin(), text.end(), '\n') == 3);
}

TEST_CASE("sink.csv refuses names that are none and results without a folder", "[sink.csv]") {
    Bench bench;
    const auto make = [&](const std::string& with) {
        StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"), with);
    };
    CHECK_THROWS_WITH(make("{tracks: out/}"), "tracks: 'out/' is not the name of a file");
    CHECK_THROWS_WITH(make("{truth: ''}"), "truth: '' is not the name of a file");
    CHECK_THROWS_WITH(make("{truth: tracks.csv}"), "truth: has the name of the tracks' file");
    StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
    auto builder = two_tracks();
    CHECK_THROWS_WITH(sink.receive(tracks, builder.message(0)),
                      "cannot write tracks.csv: this run has no result folder, and the name is relative");
    bench.folder = "/proc/nothing";
    CHECK_THROWS_WITH(sink.receive(tracks, builder.message(0)),
                      Catch::StartsWith("cannot make the folder of /proc/nothing"));
}

TEST_CASE("sink.csv tells that the disk is full", "[sink.csv]") {
    if (!std::filesystem::exists("/dev/full")) return;
    const TemporaryFolder folder;
    std::filesystem::create_symlink("/dev/full", folder / "tracks.csv.part");
    Bench bench;
    bench.folder = folder.path().string();
    StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
    auto builder = two_tracks();
    const auto write = [&] {
        sink.receive(tracks, builder.message(0));
        sink.finish();
    };
    // A device cannot be cut to a length; either that or the writing fails, and is told.
    CHECK_THROWS_WITH(write(), Catch::StartsWith("cannot write " + (folder / "tracks.csv.part")));
    CHECK_FALSE(folder.has("tracks.csv"));
}

TEST_CASE("sink.csv goes on byte for byte where its saved state left off, here or in another folder", "[sink.csv]") {
    const auto feed = [](StageUnderTest& sink, int first, int last) {
        for (int i = first; i < last; ++i) {
            pelorus::TracksBuilder builder("", pelorus::position_space(1));
            const double mean[] = {i / 3.0}, covariance[] = {1};
            builder.add({1, i, PLR_TRACK_CONFIRMED, 0, mean, covariance, nullptr, {}, 0, {}, {}});
            sink.receive(tracks, builder.message(0));
            pelorus::ScanBuilder scan("radar", "", pelorus::position_space(1));
            scan.add(static_cast<std::uint64_t>(i), mean);
            sink.receive(scans, scan.message(i));
        }
    };
    const TemporaryFolder whole, first_run, elsewhere;
    Bench bench;
    bench.folder = whole.path().string();
    {
        StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
        feed(sink, 0, 5000);
        sink.finish();
    }
    std::vector<unsigned char> state;
    bench.folder = first_run.path().string();
    {
        StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
        feed(sink, 0, 3000);
        state = sink.save();
        feed(sink, 3000, 4000);  // lost when the process ends here
    }
    REQUIRE(first_run.has("tracks.csv.part"));
    for (const bool finished_meanwhile : {false, true}) {
        if (finished_meanwhile) {
            std::filesystem::rename(first_run / "tracks.csv.part", first_run / "tracks.csv");
            std::filesystem::rename(first_run / "scans_radar.csv.part", first_run / "scans_radar.csv");
        }
        bench.folder = elsewhere.path().string();
        StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
        sink.load(state);
        feed(sink, 3000, 5000);
        sink.finish();
        CHECK(elsewhere.read("tracks.csv") == whole.read("tracks.csv"));
        CHECK(elsewhere.read("scans_radar.csv") == whole.read("scans_radar.csv"));
        std::filesystem::remove(elsewhere / "tracks.csv");
        std::filesystem::remove(elsewhere / "scans_radar.csv");
    }
    bench.folder = first_run.path().string();
    {
        StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
        sink.load(state);
        feed(sink, 3000, 5000);
        sink.finish();
    }
    CHECK(first_run.read("tracks.csv") == whole.read("tracks.csv"));

    first_run.write("tracks.csv", "something else");
    StageUnderTest sink(bench, plugin_of<CsvSink>("sink.csv"));
    CHECK_THROWS_WITH(sink.load(state),
                      Catch::StartsWith("cannot resume " + (first_run / "tracks.csv") + ": its first "));
}
