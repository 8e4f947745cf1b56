#include "../../common/streams/stream_rig.hpp"
#include "least_squares_stage.hpp"

namespace {

using namespace streams_test;
using least_squares::LeastSquares;

struct Rig : StreamRig<LeastSquares> {
    explicit Rig(const std::string& more = "")
        : StreamRig("registration.least_squares", "{sensor: eo, onto: radar" + more + "}") {}
};

/// Range of something that comes nearer.
double range_at(double time) { return 1000 - 7 * time; }

/// Ten frames a second from `first` to `last`, both included.
void frames(Rig& rig, int first, int last) {
    for (int i = first; i <= last; ++i) rig.eo(0.1 * i, range_at(0.1 * i));
}

}  // namespace

TEST_CASE("least squares registration: the stream is told at the other sensor's time, with the published variance",
          "[registration]") {
    Rig rig;
    frames(rig, 1, 19);
    rig.radar(2);
    CHECK(rig.told().empty());  // the frame of this very time may still come
    rig.eo(2, range_at(2));
    CHECK(rig.order() == "radar 2, eo 2");
    const Told told = rig.told("eo").at(0);
    CHECK(told.value(0) == Approx(range_at(2)).epsilon(1e-12));
    CHECK(told.covariance(0, 0) == Approx(25 * 2 * 39 / (20.0 * 21.0)).epsilon(1e-12));
    CHECK(told.covariance(1, 1) == Approx(1e-6 * 2 * 39 / (20.0 * 21.0)).epsilon(1e-12));
    CHECK(told.id == rig.last_id);
}

TEST_CASE("least squares registration: only samples since the last time count", "[registration]") {
    Rig rig;
    for (int i = 1; i <= 20; ++i) rig.eo(0.1 * i, 5000);  // elsewhere
    rig.radar(2);
    frames(rig, 21, 40);
    rig.radar(4);
    CHECK(rig.order() == "radar 2, eo 2, radar 4, eo 4");
    CHECK(rig.told("eo").at(1).value(0) == Approx(range_at(4)).epsilon(1e-12));
}

TEST_CASE("least squares registration: a window leaves older samples out when the other sensor was away",
          "[registration]") {
    Rig rig(", window: 1 s");
    for (int i = 1; i <= 600; ++i) rig.eo(0.1 * i, i <= 590 ? 5000 : range_at(0.1 * i));
    rig.radar(60);
    CHECK(rig.told("eo").at(0).value(0) == Approx(range_at(60)).epsilon(1e-12));
    CHECK(rig.told("eo").at(0).covariance(0, 0) == Approx(25 * 2 * 19 / (10.0 * 11.0)).epsilon(1e-9));
}

TEST_CASE("least squares registration: where samples are too few the other sensor stands alone", "[registration]") {
    Rig rig;
    for (const double t : {0.5, 1.0, 1.5}) rig.eo(t);
    rig.radar(2);
    rig.radar(4);  // its arrival says that nothing more came
    rig.stage.finish();
    CHECK(rig.order() == "radar 2, radar 4");
    CHECK(rig.counted("untold_times") == 2);
}

TEST_CASE("least squares registration: an angle goes on through the turn", "[registration]") {
    const double pi = std::acos(-1.0);
    Rig rig;
    for (int i = 1; i <= 20; ++i) {
        const double azimuth = pi - 0.01 + 0.001 * i;  // crosses after ten frames
        rig.send("eo", 0.1 * i, vector({1000, std::remainder(azimuth, 2 * pi)}));
    }
    rig.radar(2);
    CHECK(rig.told("eo").at(0).value(1) == Approx(-pi + 0.01).epsilon(1e-12));
}

TEST_CASE("least squares registration: a parabola follows what a line cannot", "[registration]") {
    const auto bent = [](double t) { return 1000 + 3 * t + 10 * t * t; };
    Rig line, parabola(", order: 2");
    for (Rig* rig : {&line, &parabola}) {
        for (int i = 1; i <= 20; ++i) rig->eo(0.1 * i, bent(0.1 * i));
        rig->radar(2);
    }
    CHECK(std::abs(line.told("eo").at(0).value(0) - bent(2)) > 1);
    CHECK(parabola.told("eo").at(0).value(0) == Approx(bent(2)).epsilon(1e-12));
}

TEST_CASE("least squares registration: samples in disorder are put in order", "[registration]") {
    Rig tidy(", lateness: 0.5 s"), untidy(", lateness: 0.5 s");
    const std::vector<int> mixed = {2, 1, 3, 5, 7, 4, 6, 8, 10, 9};
    for (int i = 1; i <= 10; ++i) tidy.eo(0.1 * i, range_at(0.1 * i) + i % 3);
    for (const int i : mixed) untidy.send("eo", 0.1 * i, vector({range_at(0.1 * i) + i % 3, 0}), 0.1 * i + 0.3);
    for (Rig* rig : {&tidy, &untidy}) {
        rig->send("radar", 1, vector({1000, 0}), 1.0);
        rig->eo(1.6);
    }
    REQUIRE(tidy.told("eo").size() == 1);
    REQUIRE(untidy.told("eo").size() == 1);
    CHECK(tidy.told("eo")[0].value == untidy.told("eo")[0].value);
    CHECK(tidy.told("eo")[0].covariance == untidy.told("eo")[0].covariance);
    CHECK(untidy.counted("out_of_order") == 4);
}

TEST_CASE("least squares registration: a time stays open for as long as samples may be late", "[registration]") {
    Rig rig(", lateness: 0.3 s");
    rig.radar(2);
    for (int i = 1; i <= 20; ++i) rig.send("eo", 0.1 * i, vector({range_at(0.1 * i), 0}), 2 + 0.01 * i);
    CHECK(rig.told().empty());
    rig.send("eo", 2.1, vector({range_at(2.1), 0}), 2.31);  // 0.3 s after the radar's arrival nothing is waited for
    CHECK(rig.order() == "radar 2, eo 2");
    CHECK(rig.told("eo").at(0).covariance(0, 0) == Approx(25 * 2 * 39 / (20.0 * 21.0)).epsilon(1e-12));
}

TEST_CASE("least squares registration: a sample whose time was told is dropped or refused", "[registration]") {
    const bool is_refused = GENERATE(true, false);
    Rig rig(is_refused ? ", late: refuse" : "");
    frames(rig, 1, 19);
    rig.radar(2);
    rig.send("eo", 2.1, vector({0, 0}), 2.1);
    REQUIRE(rig.order() == "radar 2, eo 2");
    const auto late = [&] { rig.send("eo", 2.0, vector({0, 0}), 2.2); };
    if (is_refused) {
        CHECK_THROWS_WITH(late(), "a sample of eo came after its time had been told");
    } else {
        late();
        CHECK(rig.counted("late") == 1);
    }
    CHECK(rig.told().size() == 2);
}

TEST_CASE("least squares registration: a stamp counts once", "[registration]") {
    Rig once, twice;
    frames(once, 1, 20);
    for (int i = 1; i <= 20; ++i)
        for (int k = 0; k < 2; ++k) twice.eo(0.1 * i, range_at(0.1 * i));
    once.radar(2);
    twice.radar(2);
    CHECK(once.told("eo").at(0).covariance == twice.told("eo").at(0).covariance);
    CHECK(twice.counted("duplicates") == 20);
}

TEST_CASE("least squares registration: the other sensor's scans in disorder leave in order, belated ones alone",
          "[registration]") {
    Rig rig(", lateness: 3 s");
    rig.send("radar", 4, vector({1, 0}), 4.0);
    rig.send("radar", 2, vector({1, 0}), 4.1);
    for (int i = 1; i <= 80; ++i) rig.send("eo", 0.1 * i, vector({range_at(0.1 * i), 0}), 4.1 + 0.02 * i);
    rig.send("radar", 3, vector({1, 0}), 7.3);
    CHECK(rig.order() == "radar 2, eo 2, radar 4, eo 4, radar 3");
    CHECK(rig.counted("late_times") == 1);
}

TEST_CASE("least squares registration: scans of one time leave together, and those of other sensors at once",
          "[registration]") {
    Rig rig;
    frames(rig, 1, 19);
    rig.radar(2);
    rig.radar(2);
    rig.send("lidar", 2, vector({1, 0}));
    rig.eo(2);
    CHECK(rig.order() == "lidar 2, radar 2, radar 2, eo 2");
}

TEST_CASE("least squares registration: no more than capacity is kept", "[registration]") {
    Rig rig(", capacity: 10");
    frames(rig, 1, 100);
    CHECK(rig.counted("overflows") == 90);
    rig.radar(10);
    CHECK(rig.told("eo").at(0).covariance(0, 0) == Approx(25 * 2 * 19 / (10.0 * 11.0)).epsilon(1e-9));

    Rig waiting(", capacity: 10, lateness: 1000 s");
    for (int k = 1; k <= 15; ++k) waiting.radar(k);
    CHECK(waiting.told("radar").size() == 5);
    CHECK(waiting.counted("closed_early") == 5);
}

TEST_CASE("least squares registration: one stamp from the future closes nothing, a clock that was set does",
          "[registration]") {
    Rig rig;
    const std::string wrong = GENERATE("eo", "radar");
    frames(rig, 1, 30);
    rig.send(wrong, 3600, vector({0, 0}), 3.05);
    frames(rig, 31, 39);
    rig.radar(4);
    frames(rig, 40, 40);
    CHECK(rig.counted("leaps") == 1);
    CHECK(rig.counted("late") == 0);
    CHECK(rig.order() == (wrong == "eo" ? "radar 4, eo 4" : "radar 3600, radar 4, eo 4"));
    CHECK(rig.told("eo").at(0).covariance(0, 0) == Approx(25 * 2 * 79 / (40.0 * 41.0)).epsilon(1e-12));
    // From here on both clocks are an hour ahead.
    for (int i = 41; i <= 60; ++i) rig.send("eo", 3600 + 0.1 * i, vector({1, 0}), 0.1 * i);
    for (const double t : {6.0, 8.0}) {
        rig.send("radar", 3600 + t, vector({1, 0}), t);
        for (int i = 1; i <= 20; ++i) rig.send("eo", 3600 + t + 0.1 * i, vector({1, 0}), t + 0.1 * i);
    }
    CHECK(rig.told("eo").back().time == ns(3608));
}

TEST_CASE("least squares registration: frames that saw nothing still tell how far the stream is", "[registration]") {
    Rig rig;
    frames(rig, 1, 18);
    rig.radar(2);
    rig.send_empty("eo", 2);
    CHECK(rig.order() == "radar 2, eo 2");
    CHECK(rig.told("eo").at(0).value(0) == Approx(range_at(2)).epsilon(1e-12));
}

TEST_CASE("least squares registration: what is held passes whole", "[registration]") {
    Rig rig;
    frames(rig, 1, 19);
    pelorus::ScanBuilder scan("radar", "", rig.space);
    const pelorus::Space waveform(std::vector<pelorus::Component>{{"length", "s"}});
    for (int k = 0; k < 3; ++k) {
        const VectorXd value = vector({100.0 + k, 0.1 * k});
        const MatrixXd covariance = vector({1.0 + k, 2.0}).asDiagonal();
        scan.add(static_cast<std::uint64_t>(70 + k), value.data(), covariance.data());
        scan.set_time(ns(1.9 + 0.01 * k));
        scan.set_snr(5 + k);
    }
    scan.set_waveform(waveform, {2e-6});
    const pelorus::runtime::MessageRef sent = [&] {
        static pelorus::runtime::MessagePool pool;
        return pelorus::runtime::copy_message(pool, scan.message(ns(2)));
    }();
    rig.stage.receive(0, *sent);
    rig.eo(2.0, range_at(2));
    const plr_scan &got = rig.bench.published.at(0).scan(), &given = *sent->body.scan;
    REQUIRE(got.measurements.count == 3);
    for (int k = 0; k < 3; ++k) {
        CHECK(pelorus::item(got.measurements, k) == pelorus::item(given.measurements, k));
        CHECK(pelorus::item(got.covariances, k) == pelorus::item(given.covariances, k));
        CHECK(got.ids[k] == given.ids[k]);
        CHECK(got.times[k] == given.times[k]);
        CHECK(got.snr.data[k] == given.snr.data[k]);
    }
    CHECK(std::string(got.frame).empty());
    CHECK(pelorus::Space(*got.waveform_space).same(waveform));
    CHECK(got.waveform.data[0] == 2e-6);
}

TEST_CASE("least squares registration: a saved one goes on bit for bit", "[registration]") {
    const auto play = [](Rig& rig, int first, int last) {
        for (int i = first; i <= last; ++i) {
            rig.eo(0.1 * i, range_at(0.1 * i) + std::sin(i));
            if (i % 20 == 15) rig.radar(0.1 * i + 0.3);
        }
    };
    const std::string with = ", lateness: 0.2 s, order: 2";
    Rig whole(with), first(with), rest(with);
    play(whole, 1, 100);
    play(first, 1, 36);  // a time is open
    rest.stage.load(first.stage.save());
    rest.last_id = first.last_id;
    play(rest, 37, 100);
    std::vector<Told> halves = first.told(), later = rest.told();
    halves.insert(halves.end(), later.begin(), later.end());
    CHECK(halves == whole.told());
    CHECK(rest.stage.save() == whole.stage.save());
}

TEST_CASE("least squares registration: what it cannot use is refused by name", "[registration]") {
    CHECK_THROWS_WITH(StreamRig<LeastSquares>("registration.least_squares", "{sensor: eo, onto: eo}"),
                      "onto: is the sensor itself, eo");
    Rig rig;
    pelorus::ScanBuilder two("eo", "site", rig.space);
    const VectorXd value = vector({1, 0});
    for (const std::uint64_t id : {1, 2}) two.add(id, value.data(), rig.covariance.data());
    CHECK_THROWS_WITH(rig.stage.receive(0, two.message(0)),
                      "a scan of eo has 2 measurements; those of one object, one a scan, can be put onto other times");
    pelorus::ScanBuilder bare("eo", "site", rig.space);
    bare.add(1, value.data());
    CHECK_THROWS_WITH(rig.stage.receive(0, bare.message(0)), "a scan of eo carries no covariances");
    rig.eo(1);
    pelorus::ScanBuilder moved("eo", "elsewhere", rig.space);
    moved.add(3, value.data(), rig.covariance.data());
    CHECK_THROWS_WITH(rig.stage.receive(0, moved.message(ns(2))), Catch::Contains("changed from frame 'site'"));
}
