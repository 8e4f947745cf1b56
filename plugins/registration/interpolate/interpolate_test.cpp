#include "../../common/streams/stream_rig.hpp"
#include "interpolate_stage.hpp"
#include "interpolation.hpp"

namespace {

using namespace streams_test;
using interpolate::Interpolate;

struct Rig : StreamRig<Interpolate> {
    explicit Rig(const std::string& more = "")
        : StreamRig("registration.interpolate", "{sensor: eo, onto: radar" + more + "}") {}
};

/// Range, its rate, and azimuth without one.
pelorus::Space with_rate() {
    return pelorus::Space({{"range", "m"}, {"range_rate", "m/s"}, {"azimuth", "rad", 0, 0, true}});
}

struct RateRig : Rig {
    explicit RateRig(const std::string& more = "") : Rig(", rule: hermite" + more) {
        space = with_rate();
        covariance = vector({4, 0.25, 1e-6}).asDiagonal();
    }
};

double cubic(double t) { return 1000 - 30 * t + 4 * t * t - 2 * t * t * t; }
double cubic_rate(double t) { return -30 + 8 * t - 6 * t * t; }

}  // namespace

TEST_CASE("interpolation: between two samples the stream lies on their line", "[registration]") {
    Rig rig;
    rig.eo(1.0, 100);
    rig.radar(1.1);
    CHECK(rig.told().empty());  // the sample after it is to come
    rig.eo(1.4, 108);
    CHECK(rig.order() == "radar 1.1, eo 1.1");
    const Told told = rig.told("eo").at(0);
    CHECK(told.value(0) == Approx(102));
    CHECK(told.covariance(0, 0) == Approx(25 * (0.75 * 0.75 + 0.25 * 0.25)));
    CHECK(told.covariance(1, 1) == Approx(1e-6 * (0.75 * 0.75 + 0.25 * 0.25)));
}

TEST_CASE("interpolation: at a sample's own time it is the sample", "[registration]") {
    Rig rig;
    rig.eo(1, 100);
    rig.eo(2, 300);
    rig.radar(2);
    const Told told = rig.told("eo").at(0);
    CHECK(told.value(0) == 300);
    CHECK(told.covariance == rig.covariance);
    CHECK(told.id == 2);
}

TEST_CASE("interpolation: several times between two samples are told each, under ids of their own", "[registration]") {
    Rig rig;
    rig.eo(1, 100);
    for (const double t : {1.1, 1.2, 1.9}) rig.radar(t);
    rig.eo(2, 110);
    CHECK(rig.order() == "radar 1.1, eo 1.1, radar 1.2, eo 1.2, radar 1.9, eo 1.9");
    const auto told = rig.told("eo");
    CHECK(told[2].value(0) == Approx(109));
    CHECK(told[0].id != told[1].id);
    CHECK(told[1].id != told[2].id);
}

TEST_CASE("interpolation: an angle goes the short way", "[registration]") {
    const double pi = std::acos(-1.0);
    Rig rig;
    rig.send("eo", 1, vector({1, pi - 0.1}));
    rig.radar(1.75);
    rig.send("eo", 2, vector({1, -pi + 0.1}));
    CHECK(rig.told("eo").at(0).value(1) == Approx(-pi + 0.05));
}

TEST_CASE("interpolation: values and rates tell a cubic exactly", "[registration]") {
    RateRig rig;
    rig.send("eo", 1.0, vector({cubic(1), cubic_rate(1), 0.1}));
    rig.radar(1.3);
    rig.send("eo", 2.0, vector({cubic(2), cubic_rate(2), 0.2}));
    const Told told = rig.told("eo").at(0);
    CHECK(told.value(0) == Approx(cubic(1.3)).epsilon(1e-12));
    CHECK(told.value(1) == Approx(0.7 * cubic_rate(1) + 0.3 * cubic_rate(2)));
    CHECK(told.value(2) == Approx(0.13));
    // The basis functions of the textbooks: h00 = 2 u^3 - 3 u^2 + 1, h10 = u^3 - 2 u^2 + u, h01 = 1 - h00, h11 = u^3 - u^2.
    const double h00 = 0.784, h10 = 0.147, h01 = 0.216, h11 = -0.063;
    CHECK(told.covariance(0, 0) == Approx((h00 * h00 + h01 * h01) * 4 + (h10 * h10 + h11 * h11) * 0.25));
    CHECK(told.covariance(0, 1) == Approx((h10 * 0.7 + h11 * 0.3) * 0.25));
}

TEST_CASE("interpolation: rates are known by name", "[registration]") {
    const pelorus::Space kinematic = pelorus::kinematic_space(2, {0, 0});
    CHECK(interpolate::rate_of(kinematic, 0) == 2);
    CHECK(interpolate::rate_of(kinematic, 1) == 3);
    CHECK(interpolate::rate_of(kinematic, 2) == -1);
    CHECK(interpolate::rate_of(with_rate(), 0) == 1);
    CHECK(interpolate::rate_of(with_rate(), 2) == -1);
}

TEST_CASE("interpolation: for want of a sample after, a time is told from those before, but not far beyond them",
          "[registration]") {
    Rig rig;
    rig.eo(1.0, 100);
    rig.eo(1.5, 105);
    rig.radar(2.0);
    rig.radar(2.6);
    rig.radar(4.5);
    rig.stage.finish();
    CHECK(rig.order() == "radar 2, eo 2, radar 2.6, radar 4.5");
    const Told told = rig.told("eo").at(0);
    CHECK(told.value(0) == Approx(110));
    CHECK(told.covariance(0, 0) == Approx(25 * (1 + 4)));
    CHECK(rig.counted("untold_times") == 2);
}

TEST_CASE("interpolation: beyond the last sample its rate leads on", "[registration]") {
    RateRig rig;
    rig.send("eo", 1.0, vector({500, 3, 0}));
    rig.send("eo", 1.5, vector({100, -8, 0}));
    rig.radar(2.0);
    rig.stage.finish();
    const Told told = rig.told("eo").at(0);
    CHECK(told.value(0) == Approx(96));
    CHECK(told.covariance(0, 0) == Approx(4 + 0.25 * 0.25));
}

TEST_CASE("interpolation: samples that lie too far apart are not joined", "[registration]") {
    Rig rig, patient(", max_gap: 3 s");
    for (Rig* each : {&rig, &patient}) {
        each->eo(1);
        each->radar(1.5);
        each->eo(3.5);
    }
    CHECK(rig.order() == "radar 1.5");
    CHECK(patient.order() == "radar 1.5, eo 1.5");
}

TEST_CASE("interpolation: before the first sample nothing is told", "[registration]") {
    Rig rig;
    rig.radar(0.9);
    rig.eo(1);
    rig.eo(2);
    CHECK(rig.order() == "radar 0.9");
}

TEST_CASE("interpolation: samples that come late and in disorder are neighbours all the same", "[registration]") {
    Rig rig(", lateness: 0.5 s");
    rig.eo(1.0, 100);
    rig.radar(1.2);
    rig.send("eo", 1.5, vector({150, 0}), 1.5);
    rig.send("eo", 1.3, vector({130, 0}), 1.6);
    rig.send("eo", 1.1, vector({110, 0}), 1.65);
    rig.send("eo", 1.8, vector({0, 0}), 1.8);
    REQUIRE(rig.order() == "radar 1.2, eo 1.2");
    CHECK(rig.told("eo").at(0).value(0) == Approx(120));
    CHECK(rig.told("eo").at(0).covariance(0, 0) == Approx(12.5));
}

TEST_CASE("interpolation: a saved one goes on bit for bit", "[registration]") {
    const auto play = [](Rig& rig, int first, int last) {
        for (int i = first; i <= last; ++i) {
            rig.eo(0.1 * i, std::sin(i));
            if (i % 10 == 5) rig.radar(0.1 * i + 0.03);
        }
    };
    Rig whole, first, rest;
    play(whole, 1, 60);
    play(first, 1, 25);
    rest.stage.load(first.stage.save());
    rest.last_id = first.last_id;
    play(rest, 26, 60);
    std::vector<Told> halves = first.told(), later = rest.told();
    halves.insert(halves.end(), later.begin(), later.end());
    CHECK(halves == whole.told());
}
