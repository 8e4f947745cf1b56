#include "ospa.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "../../../tests/fixtures/results_of.hpp"

namespace {

using namespace pelorus::test;
constexpr std::int64_t second = 1'000'000'000;
enum Port : std::uint32_t { tracks, truth };

/// Objects and estimates on a line, told by hand.
struct Scored {
    Bench bench;
    StageUnderTest analyzer;
    ResultsOf results{bench, analyzer};
    explicit Scored(const std::string& with) : analyzer(bench, plugin_of<ospa::Ospa>("analyzer.ospa"), with) {}

    void real(std::int64_t time, const std::vector<double>& places) {
        pelorus::TruthBuilder builder("", pelorus::position_space(1));
        for (std::size_t i = 0; i < places.size(); ++i) builder.add({i, time * second, &places[i], nullptr, i, 0, {}});
        analyzer.receive(truth, builder.message(time * second));
    }
    void estimates(std::int64_t time, const std::vector<double>& places, std::int32_t status = PLR_TRACK_CONFIRMED) {
        pelorus::TracksBuilder builder("", pelorus::position_space(1));
        const double covariance = 1;
        for (std::size_t i = 0; i < places.size(); ++i)
            builder.add({100 + i, time * second, status, 0, &places[i], &covariance, nullptr, {}, 0, {}, {}});
        analyzer.receive(tracks, builder.message(time * second));
    }
};

}  // namespace

TEST_CASE("ospa: a row of each time, with what is missed and what is false", "[ospa]") {
    Scored run("{cutoff: 10 m, order: 1}");
    run.real(0, {0, 100});
    run.estimates(0, {3});
    run.real(1, {0});
    run.estimates(1, {4, 500}, PLR_TRACK_COASTING);
    run.real(2, {0});
    run.estimates(2, {0}, PLR_TRACK_TENTATIVE);
    run.estimates(9, {0});
    REQUIRE(run.results.table().rows.count == 3);
    CHECK(run.results.cell(0, "ospa") == Approx((3 + 10) / 2.0));
    CHECK(run.results.cell(0, "missed") == 1);
    CHECK(run.results.cell(0, "gospa") == Approx(3 + 5));
    CHECK(run.results.cell(1, "false") == 1);
    CHECK(run.results.cell(1, "ospa_localisation") == Approx(2));
    CHECK(run.results.cell(1, "gospa_false") == Approx(5));
    CHECK(run.results.cell(2, "ospa") == 10);
    CHECK(run.results.cell(2, "estimates") == 0);
    CHECK(run.results.value("without_truth") == 1);
    CHECK(std::string(run.results.scalar("ospa").column) == "ospa");
    CHECK(std::string(run.results.scalar("gospa").unit) == "m");
}

TEST_CASE("ospa: the middle is while groups come apart, its path runs over gaps", "[ospa]") {
    Scored run("{cutoff: 100 m, order: 2, group_distance: 10 m, end_from: 4 s}");
    const double offsets[] = {50, 1, 3, 9, 2, 4};
    for (int k = 0; k < 6; ++k) {
        // One group, then two of three objects, once all apart, then two again, then all apart.
        const double far = k == 0 ? 5 : 200;
        const std::vector<double> places =
            k == 2 || k == 5 ? std::vector<double>{0, 100, 200} : std::vector<double>{0, 5, far};
        run.real(k, places);
        std::vector<double> moved = places;
        for (double& x : moved) x += offsets[k];
        run.estimates(k, moved);
    }
    // The middle: k = 1, 3, 4, with 1, 9 and 2 m.
    CHECK(run.results.value("middle") == Approx(4));
    CHECK(run.results.value("middle_pooled") == Approx(4));
    CHECK(run.results.scalar("middle_pooled").weight == 3);
    CHECK(run.results.value("middle_path") == Approx(8 + 7));
    CHECK(run.results.value("end_mean") == Approx(3));
    CHECK(run.results.value("end_median") == Approx(3));
    CHECK(run.results.scalar("end_median").reduce == PLR_REDUCE_QUANTILE);
    CHECK(run.results.scalar("end_median").quantile == 0.5);
}

TEST_CASE("ospa: without a distance of groups all is the middle, without a time the last tenth is the end", "[ospa]") {
    Scored run("{cutoff: 100 m}");
    for (int k = 0; k < 20; ++k) {
        run.real(k, {0});
        run.estimates(k, {static_cast<double>(k)});
    }
    CHECK(run.results.value("middle") == Approx(9.5));
    CHECK(run.results.value("middle_path") == Approx(19));
    CHECK(run.results.value("end_mean") == Approx(18.5));
}

TEST_CASE("ospa: a run whose objects never come apart has no middle", "[ospa]") {
    Scored run("{cutoff: 100 m, group_distance: 10 m}");
    run.real(0, {0, 1});
    run.estimates(0, {0});
    CHECK(std::isnan(run.results.value("middle")));
    CHECK(std::isnan(run.results.value("middle_path")));
    CHECK_FALSE(std::isnan(run.results.value("end_mean")));
}

TEST_CASE("ospa: a cutoff is asked for", "[ospa]") {
    Bench bench;
    const auto& plugin = plugin_of<ospa::Ospa>("analyzer.ospa");
    CHECK_THROWS_WITH(StageUnderTest(bench, plugin, "{}"), Catch::Contains("cutoff"));
    CHECK_THROWS_WITH(StageUnderTest(bench, plugin, "{cutoff: 10 m, order: 0.5}"), Catch::Contains("order"));
}
