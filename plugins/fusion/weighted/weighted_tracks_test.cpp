#include "../../common/fusion/fusion_rig.hpp"
#include "weighted_fusion.hpp"

namespace {

using namespace fusion_rig;
using weighted::WeightedFusion;

struct TracksRig : Rig<WeightedFusion> {
    explicit TracksRig(const std::string& with)
        : Rig("fusion.weighted", "{dimension: 2, derivatives: position, " + with + "}", {}) {}
};
constexpr std::uint32_t first = WeightedFusion::first_in, other = WeightedFusion::second_in;

const MatrixXd small = diagonal({1, 1}), large = diagonal({4, 4});

}  // namespace

TEST_CASE("weighted fusion: tracks with a known cross-covariance are fused as by Bar-Shalom and Campo", "[fusion]") {
    // A random walk of variance q a step, seen by two filters of their own noise: both errors have the walk in common.
    const double q = 2, r1 = 3, r2 = 5;
    double p1 = 100, p2 = 100, c = 0;
    for (int step = 0; step < 50; ++step) {
        const double k1 = (p1 + q) / (p1 + q + r1), k2 = (p2 + q) / (p2 + q + r2);
        c = (1 - k1) * (c + q) * (1 - k2);
        p1 = k1 * r1;
        p2 = k2 * r2;
    }
    TracksRig rig("correlation: 0");
    pelorus::ValuesBuilder cross;
    cross.add("", "cross_covariance", "m2", diagonal({c, c}), 0, 10 * second);
    rig.stage->receive(WeightedFusion::cross_in, cross.message(0));
    rig.tracks(first, 1, {{5, vector({10, 20}), diagonal({p1, p1})}});
    rig.tracks(other, 1, {{9, vector({12, 19}), diagonal({p2, p2})}});
    const double gain = (p1 - c) / (p1 + p2 - 2 * c);
    const auto told = rig.fused();
    REQUIRE(told.size() == 1);
    CHECK(told[0].mean(0) == Approx(10 + 2 * gain));
    CHECK(told[0].mean(1) == Approx(20 - gain));
    CHECK(told[0].covariance(0, 0) == Approx((p1 * p2 - c * c) / (p1 + p2 - 2 * c)));
    CHECK(told[0].covariance(0, 0) > 1 / (1 / p1 + 1 / p2));  // what independent errors would leave
    CHECK(told[0].status == PLR_TRACK_CONFIRMED);
    rig.tracks(first, 11, {{5, vector({10, 20}), diagonal({p1, p1})}});  // no longer valid
    rig.tracks(other, 11, {{9, vector({12, 19}), diagonal({p2, p2})}});
    CHECK(rig.fused()[0].covariance(0, 0) == Approx(1 / (1 / p1 + 1 / p2)));
    cross.clear();
    cross.add("", "cross_covariance", "m2", diagonal({1, 1, 1}));
    CHECK_THROWS_WITH(rig.stage->receive(WeightedFusion::cross_in, cross.message(0)), Catch::Contains("3 x 3"));
}

TEST_CASE("weighted fusion: of two tracks that err alike the second tells little", "[fusion]") {
    for (const double correlation : {0.0, 0.4, 0.9}) {
        TracksRig rig("correlation: " + std::to_string(correlation));
        rig.tracks(first, 1, {{5, vector({10, 20}), large}});
        rig.tracks(other, 1, {{9, vector({12, 20}), large}});
        CHECK(rig.fused()[0].mean(0) == Approx(11));
        CHECK(rig.fused()[0].covariance(0, 0) == Approx(4 * (1 + correlation) / 2));
    }
}

TEST_CASE("weighted fusion: each track meets its own, and keeps its name", "[fusion]") {
    TracksRig rig("gate: 5");
    const auto a = vector({0, 0}), b = vector({100, 0}), c = vector({300, 0});
    rig.tracks(first, 1, {{1, a, small}, {2, b, small}});
    rig.tracks(other, 1,
               {{11, vector({101, 0}), small}, {12, vector({1, 0}), small}, {13, c, small, PLR_TRACK_TENTATIVE}});
    auto told = rig.fused();
    REQUIRE(told.size() == 3);
    CHECK(told[0].mean(0) == Approx(0.5));
    CHECK(told[1].mean(0) == Approx(100.5));
    CHECK(told[2].mean(0) == Approx(300));
    CHECK(told[2].status == PLR_TRACK_TENTATIVE);
    const std::uint64_t one = told[0].id, two = told[1].id, three = told[2].id;
    // The first tracker loses one and finds the third; crossing tracks stay with their partners.
    rig.tracks(first, 2, {{1, vector({50, 0}), small}, {3, c, small}});
    rig.tracks(other, 2, {{11, vector({50, 0}), small}, {12, vector({53, 0}), small}, {13, c, small}});
    told = rig.fused();
    REQUIRE(told.size() == 3);
    CHECK(told[0].id == one);
    CHECK(told[0].mean(0) == Approx(51.5));
    CHECK(told[1].id == three);
    CHECK(told[2].id == two);  // the second tracker still has it
    CHECK(told[2].mean(0) == Approx(50));
    // Both lose one: its end is told once.
    for (const double time : {3.0, 4.0}) {
        rig.tracks(first, time, {{3, c, small}});
        rig.tracks(other, time, {{11, vector({50, 0}), small}, {13, c, small}});
        told = rig.fused();
        if (time < 4) {
            REQUIRE(told.size() == 3);
            CHECK(told[2].id == one);
            CHECK(told[2].status == PLR_TRACK_DELETED);
        } else {
            CHECK(told.size() == 2);
        }
    }
}

TEST_CASE("weighted fusion: a tracker that falls silent does not end the other's tracks", "[fusion]") {
    const bool drops = GENERATE(false, true);
    TracksRig rig(drops ? "alone: drop" : "alone: pass");
    rig.tracks(first, 1, {{1, vector({0, 0}), small}});
    rig.tracks(other, 1, {{8, vector({1, 0}), small}});
    const std::uint64_t id = rig.fused()[0].id;
    rig.tracks(other, 2, {{8, vector({2, 0}), small}});
    rig.tracks(other, 3, {{8, vector({3, 0}), small}});
    CHECK(rig.bench.published.size() == (drops ? 1 : 2));
    if (!drops) {
        CHECK(rig.fused()[0].id == id);
        CHECK(rig.fused()[0].mean(0) == Approx(2));
    }
    rig.tracks(first, 3, {{1, vector({4, 0}), small}});
    CHECK(rig.fused()[0].id == id);
    CHECK(rig.fused()[0].mean(0) == Approx(3.5));
}

TEST_CASE("weighted fusion: fused tracks go on bit for bit from what was saved", "[fusion]") {
    TracksRig whole("gate: 5, patience: 2 s"), begun("gate: 5, patience: 2 s"), rest("gate: 5, patience: 2 s");
    for (TracksRig* rig : {&whole, &begun}) {
        rig->tracks(first, 1, {{1, vector({0, 0}), small}, {2, vector({50, 0}), small}});
        rig->tracks(other, 1, {{8, vector({1, 0}), small}});
        rig->tracks(first, 2, {{2, vector({50, 0}), small}});
    }
    rest.stage->load(begun.stage->save());
    for (TracksRig* rig : {&whole, &rest}) rig->tracks(other, 2, {{8, vector({1, 0}), small}});
    REQUIRE(whole.fused().size() == rest.fused().size());
    for (std::size_t i = 0; i < whole.fused().size(); ++i) {
        CHECK(whole.fused()[i].id == rest.fused()[i].id);
        CHECK(whole.fused()[i].mean == rest.fused()[i].mean);
    }
}
