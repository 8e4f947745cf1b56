#include "../../common/streams/stream_rig.hpp"
#include "block_mean_stage.hpp"

namespace {

using namespace streams_test;
using block_mean::BlockMean;

struct Rig : StreamRig<BlockMean> {
    explicit Rig(const std::string& more = "") : StreamRig("registration.block_mean", "{sensor: eo" + more + "}") {}
};

/// Frames of a period of 0.05 s from `first` to `last`, both included; range is linear in time.
void frames(Rig& rig, int first, int last) {
    for (int i = first; i <= last; ++i) rig.eo(0.05 * i, 1000 - 7 * 0.05 * i);
}

}  // namespace

TEST_CASE("block mean: ten frames become one at the mean of their times, with a tenth of their covariance",
          "[registration]") {
    Rig rig;
    frames(rig, 1, 9);
    CHECK(rig.told().empty());
    frames(rig, 10, 20);
    CHECK(rig.order() == "eo 0.275, eo 0.775");
    for (const Told& each : rig.told()) {
        CHECK(each.value(0) == Approx(1000 - 7e-9 * static_cast<double>(each.time)).epsilon(1e-12));
        CHECK((each.covariance - rig.covariance / 10).norm() < 1e-12);
    }
    CHECK(rig.told()[1].id == 20);
}

TEST_CASE("block mean: frames that are missing leave a mean of the others", "[registration]") {
    Rig rig;
    for (const int i : {1, 2, 4, 5, 10}) rig.eo(0.05 * i, 1000 - 7 * 0.05 * i);
    REQUIRE(rig.told().size() == 1);
    const Told told = rig.told()[0];
    CHECK(told.time == ns(0.05 * 22 / 5));
    CHECK(told.value(0) == Approx(1000 - 7 * 0.05 * 22 / 5).epsilon(1e-12));
    CHECK((told.covariance - rig.covariance / 5).norm() < 1e-12);
}

TEST_CASE("block mean: samples of other covariances give the covariance of their mean", "[registration]") {
    Rig rig;
    rig.eo(0.1, 1);
    rig.covariance *= 9;
    rig.eo(0.5, 3);
    REQUIRE(rig.told().size() == 1);
    CHECK(rig.told()[0].value(0) == Approx(2));
    CHECK(rig.told()[0].covariance(0, 0) == Approx((25 + 9 * 25) / 4.0));
}

TEST_CASE("block mean: an angle goes on through the turn", "[registration]") {
    const double pi = std::acos(-1.0);
    Rig rig;
    rig.send("eo", 0.25, vector({1, pi - 0.01}));
    rig.send("eo", 0.5, vector({1, -pi + 0.03}));
    REQUIRE(rig.told().size() == 1);
    CHECK(rig.told()[0].value(1) == Approx(-pi + 0.01));
}

TEST_CASE("block mean: scans of other sensors leave in the order of the stamps, or at once", "[registration]") {
    const bool is_held = GENERATE(true, false);
    Rig rig(is_held ? "" : ", others: passed");
    frames(rig, 1, 6);
    rig.radar(0.3);
    frames(rig, 7, 9);
    rig.radar(0.5);
    frames(rig, 10, 19);
    rig.radar(1.0);
    frames(rig, 20, 20);
    CHECK(rig.order() == (is_held ? "eo 0.275, radar 0.3, radar 0.5, eo 0.775, radar 1"
                                  : "radar 0.3, radar 0.5, eo 0.275, radar 1, eo 0.775"));
}

TEST_CASE("block mean: at equal times the other sensor comes first", "[registration]") {
    Rig rig;
    rig.eo(0.2);
    rig.radar(0.3);
    rig.eo(0.4);
    rig.eo(0.51);
    CHECK(rig.order() == "radar 0.3, eo 0.3");
}

TEST_CASE("block mean: an outage ends a block, and no scan of another sensor waits for longer than a block",
          "[registration]") {
    Rig rig;
    frames(rig, 1, 4);
    rig.radar(0.4);
    rig.radar(2);  // 0.5 s have passed
    CHECK(rig.order() == "eo 0.125, radar 0.4");
    rig.radar(4);
    CHECK(rig.order() == "eo 0.125, radar 0.4, radar 2");
    frames(rig, 81, 90);
    rig.stage.finish();
    CHECK(rig.order() == "eo 0.125, radar 0.4, radar 2, radar 4, eo 4.275");
}

TEST_CASE("block mean: a stream that comes with a constant delay loses nothing", "[registration]") {
    Rig rig;
    for (int i = 1; i <= 40; ++i) rig.send("eo", 0.05 * i, vector({1, 0}), 0.05 * i + 0.23);
    CHECK(rig.order() == "eo 0.275, eo 0.775, eo 1.275, eo 1.775");
    CHECK(rig.counted("late") == 0);
}

TEST_CASE("block mean: a block waits for late samples, and no longer", "[registration]") {
    Rig strict, patient(", lateness: 0.1 s"), refusing(", late: refuse");
    for (Rig* rig : {&strict, &patient, &refusing})
        for (const int i : {1, 2, 3, 4, 5, 6, 7, 8, 10}) rig->eo(0.05 * i, i);
    strict.send("eo", 0.45, vector({9, 0}), 0.52);
    patient.send("eo", 0.45, vector({9, 0}), 0.52);
    CHECK_THROWS_WITH(refusing.send("eo", 0.45, vector({9, 0}), 0.52),
                      "a sample of eo came after its time had been told");
    CHECK(strict.counted("late") == 1);
    CHECK(patient.told().empty());
    patient.eo(0.6);
    REQUIRE(patient.told().size() == 1);
    CHECK(patient.told()[0].value(0) == Approx(5.5));
    CHECK(patient.counted("out_of_order") == 1);
}

TEST_CASE("block mean: short blocks are left out, the last one is told at the end", "[registration]") {
    Rig rig(", min_samples: 3");
    frames(rig, 1, 10);
    frames(rig, 11, 12);
    frames(rig, 21, 23);
    rig.stage.finish();
    CHECK(rig.order() == "eo 0.275, eo 1.1");
    CHECK(rig.counted("short_blocks") == 1);
}

TEST_CASE("block mean: times before the epoch lie in blocks as well", "[registration]") {
    Rig rig;
    for (int i = -20; i <= 0; ++i) rig.eo(0.05 * i);
    rig.stage.finish();
    CHECK(rig.order() == "eo -1, eo -0.725, eo -0.225");
}

TEST_CASE("block mean: one stamp from the future closes no blocks", "[registration]") {
    const std::string wrong = GENERATE("eo", "radar");
    Rig rig;
    frames(rig, 1, 3);
    rig.radar(0.15);
    rig.send(wrong, 3600, vector({0, 0}), 0.17);
    frames(rig, 4, 20);
    CHECK(rig.counted("leaps") == 1);
    CHECK(rig.counted("late") == 0);
    CHECK(rig.order() ==
          (wrong == "eo" ? "radar 0.15, eo 0.275, eo 0.775" : "radar 3600, radar 0.15, eo 0.275, eo 0.775"));
}

TEST_CASE("block mean: no more than capacity is kept", "[registration]") {
    Rig rig(", capacity: 5");
    frames(rig, 1, 10);
    CHECK(rig.counted("overflows") == 5);
    CHECK((rig.told().at(0).covariance - rig.covariance / 5).norm() < 1e-12);
    Rig waiting(", capacity: 5, period: 1000 s");
    for (int k = 1; k <= 8; ++k) waiting.radar(k);
    CHECK(waiting.told("radar").size() == 8);  // the block that all of them fell into was given up
    CHECK(waiting.counted("closed_early") == 1);
}

TEST_CASE("block mean: a saved one goes on bit for bit", "[registration]") {
    const auto play = [](Rig& rig, int first, int last) {
        for (int i = first; i <= last; ++i) {
            rig.eo(0.05 * i, std::sin(i));
            if (i % 20 == 15) rig.radar(0.05 * i);
        }
    };
    Rig whole(", lateness: 0.1 s"), first(", lateness: 0.1 s"), rest(", lateness: 0.1 s");
    play(whole, 1, 100);
    play(first, 1, 37);
    rest.stage.load(first.stage.save());
    rest.last_id = first.last_id;
    play(rest, 38, 100);
    std::vector<Told> halves = first.told(), later = rest.told();
    halves.insert(halves.end(), later.begin(), later.end());
    CHECK(halves == whole.told());
    CHECK(rest.stage.save() == whole.stage.save());
}
