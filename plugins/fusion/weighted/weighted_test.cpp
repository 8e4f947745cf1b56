#include "weighted_fusion.hpp"

#include <Eigen/Dense>

#include "../../common/fusion/fusion_rig.hpp"

namespace {

using namespace fusion_rig;

struct WeightedRig : Rig<weighted::WeightedFusion> {
    explicit WeightedRig(const std::string& with) : Rig("fusion.weighted", with) {}
    explicit WeightedRig(const std::string& with, const std::vector<std::array<std::string, 3>>& sensors)
        : Rig("fusion.weighted", with, sensors) {}
};

const MatrixXd radar_noise = diagonal({25, 9e-6, 9e-6}), eo_noise = diagonal({4e-11, 4e-11});
const VectorXd radar_fix = vector({1000, 0.102, 1.1}), eo_fix = vector({0.1, 1.103});

}  // namespace

TEST_CASE("weighted fusion: the camera's angles and the radar's range", "[fusion]") {
    const std::string rule = GENERATE("scalar", "matrix");
    WeightedRig rig("{rule: " + rule + "}");
    rig.scan("radar", 2, {{7, radar_fix, radar_noise}});
    CHECK(rig.told().empty());
    rig.scan("eo", 2, {{8, eo_fix, eo_noise}});
    const auto told = rig.told();
    REQUIRE(told.size() == 1);
    CHECK(told[0].time == 2 * second);
    CHECK(told[0].ids == std::vector<std::uint64_t>{7});
    const double share = 4e-11 / (9e-6 + 4e-11);  // the radar's weight
    CHECK(told[0].means[0](0) == Approx(1000));
    CHECK(told[0].means[0](1) == Approx(0.1 + share * 0.002).epsilon(1e-14));
    CHECK(told[0].means[0](2) == Approx(1.103 - share * 0.003).epsilon(1e-14));
    CHECK(told[0].covariances[0](0, 0) == Approx(25));
    CHECK(told[0].covariances[0](1, 1) == Approx(4e-11 * (1 - share)).epsilon(1e-12));
    CHECK(told[0].covariances[0](1, 2) == 0);
    const plr_scan& scan = rig.bench.published[0].scan();
    CHECK(std::string(scan.sensor) == "fused");
    CHECK(std::string(scan.frame) == "eo");
    CHECK(pelorus::Space(*scan.space).text() == "range [m], azimuth [rad], zenith [rad]");
}

TEST_CASE("weighted fusion: correlations count in the matrix rule, and only there", "[fusion]") {
    const std::vector<std::array<std::string, 3>> sensors{{"one", "position", "{}"}, {"other", "position", "{}"}};
    const VectorXd a = vector({1, 2, 3}), b = vector({2, 0, 4});
    const MatrixXd p = full(3, 1), q = full(3, 2);
    WeightedRig whole("{}", sensors), scalar("{rule: scalar}", sensors);
    for (WeightedRig* rig : {&whole, &scalar}) {
        rig->scan("one", 1, {{1, a, p}});
        rig->scan("other", 1, {{2, b, q}});
    }
    const Eigen::MatrixXd gain = p * MatrixXd((p + q).inverse());
    CHECK((whole.told()[0].means[0] - (a + gain * (b - a))).norm() < 1e-12);
    CHECK((whole.told()[0].covariances[0] - (p - gain * p)).norm() < 1e-12);
    for (int c = 0; c < 3; ++c) {
        const double weight = q(c, c) / (p(c, c) + q(c, c));
        CHECK(scalar.told()[0].means[0](c) == Approx(weight * a(c) + (1 - weight) * b(c)));
        CHECK(scalar.told()[0].covariances[0](c, c) == Approx(weight * p(c, c)));
    }
    CHECK(scalar.told()[0].covariances[0](0, 1) == 0);
}

TEST_CASE("weighted fusion: the radar alone is told, the camera alone is not: it knows no range", "[fusion]") {
    WeightedRig rig("{rule: scalar}");
    rig.scan("radar", 2, {{1, radar_fix, radar_noise}});
    rig.scan("eo", 4, {{2, eo_fix, eo_noise}});
    rig.scan("radar", 6, {{3, radar_fix, radar_noise}});
    rig.scan("eo", 6, {{4, eo_fix, eo_noise}});
    rig.stage->finish();
    const auto told = rig.told();
    REQUIRE(told.size() == 2);
    CHECK(told[0].time == 2 * second);
    CHECK(told[0].means[0] == radar_fix);
    CHECK(told[0].covariances[0] == radar_noise);
    CHECK(told[1].time == 6 * second);
    CHECK(rig.bench.counters.at("times_not_whole") == 1);
    CHECK(rig.bench.counters.at("times_dropped") == 1);
}

TEST_CASE("weighted fusion: on demand only what all sensors tell is published", "[fusion]") {
    WeightedRig rig("{alone: drop}");
    rig.scan("radar", 2, {{1, radar_fix, radar_noise}});
    rig.scan("radar", 4, {{3, radar_fix, radar_noise}});
    rig.scan("eo", 4, {{4, eo_fix, eo_noise}});
    rig.scan("radar", 6, {{5, radar_fix, radar_noise}});
    rig.scan("eo", 6, {});
    const auto told = rig.told();
    REQUIRE(told.size() == 2);
    CHECK(told[0].ids == std::vector<std::uint64_t>{3});
    CHECK(told[1].ids.empty());  // both looked, one saw nothing
    CHECK(rig.bench.counters.at("measurements_alone") == 1);
}

TEST_CASE("weighted fusion: a late partner is waited for, and comes too late at last", "[fusion]") {
    WeightedRig rig("{patience: 0.5 s, tolerance: 1 ms}");
    rig.scan("radar", 2, {{1, radar_fix, radar_noise}}, 2);
    rig.scan("eo", 2.0005, {{2, eo_fix, eo_noise}}, 2.4);
    REQUIRE(rig.told().size() == 1);
    CHECK(rig.told()[0].time == 2 * second);
    CHECK(rig.told()[0].means[0](1) == Approx(0.1).epsilon(1e-6));
    rig.scan("radar", 4, {{3, radar_fix, radar_noise}}, 4);
    rig.scan("radar", 6, {{5, radar_fix, radar_noise}}, 6);
    rig.scan("eo", 4, {{4, eo_fix, eo_noise}}, 6.1);
    CHECK(rig.told().size() == 2);
    CHECK(rig.bench.counters.at("scans_late") == 1);
    rig.scan("eo", 6, {{6, eo_fix, eo_noise}}, 6.2);
    CHECK(rig.told().size() == 3);
    CHECK(rig.told()[1].means[0](1) == 0.102);
    CHECK_THROWS_AS(([&] {
                        rig.scan("radar", 8, {});
                        rig.scan("radar", 8, {});
                    }()),
                    pelorus::test::CallFailed);
}

TEST_CASE("weighted fusion: of several targets each meets its own", "[fusion]") {
    WeightedRig rig("{gate: 5}");
    const auto at = [](double range, double azimuth) { return vector({range, azimuth, 1.2}); };
    rig.scan("radar", 1,
             {{1, at(1000, 0.1), radar_noise}, {2, at(900, 0.2), radar_noise}, {3, at(800, 0.5), radar_noise}});
    rig.scan(
        "eo", 1,
        {{4, vector({0.201, 1.2}), eo_noise}, {5, vector({0.7, 1.2}), eo_noise}, {6, vector({0.099, 1.2}), eo_noise}});
    const auto told = rig.told();
    REQUIRE(told.size() == 1);
    CHECK(told[0].ids == std::vector<std::uint64_t>{1, 2, 3});
    CHECK(told[0].means[0](1) == Approx(0.099).margin(1e-6));
    CHECK(told[0].means[1](1) == Approx(0.201).margin(1e-6));
    CHECK(told[0].means[2](1) == Approx(0.5).margin(1e-12));
    CHECK(rig.bench.counters.at("measurements_not_fused") == 1);  // the camera's second, without a range
}

TEST_CASE("weighted fusion: a scan without covariances has the noise of its sensor, if that is always the same",
          "[fusion]") {
    WeightedRig rig("{}");
    rig.scan("radar", 1, {{1, radar_fix, {}}});
    rig.scan("eo", 1, {{2, eo_fix, {}}});
    CHECK(rig.told()[0].covariances[0](0, 0) == Approx(25));
    CHECK(rig.told()[0].covariances[0](1, 1) == Approx(1e-10 * 9e-6 / (9e-6 + 1e-10)));
}

TEST_CASE("weighted fusion: a saved one goes on bit for bit", "[fusion]") {
    WeightedRig whole("{patience: 3 s}"), first("{patience: 3 s}"), rest("{patience: 3 s}");
    for (WeightedRig* rig : {&whole, &first}) {
        rig->scan("radar", 2, {{1, radar_fix, radar_noise}});
        rig->scan("radar", 4, {{3, radar_fix, radar_noise}});
    }
    rest.stage->load(first.stage->save());
    for (WeightedRig* rig : {&whole, &rest}) {
        rig->scan("eo", 4, {{4, eo_fix, eo_noise}});
        rig->stage->finish();
    }
    REQUIRE(whole.told().size() == 2);
    REQUIRE(rest.told().size() == 2);
    CHECK(rest.told()[1].means[0] == whole.told()[1].means[0]);
    CHECK(rest.told()[1].covariances[0] == whole.told()[1].covariances[0]);
}
