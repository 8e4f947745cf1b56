#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "tracking_error.hpp"

namespace {

using namespace pelorus::test;
constexpr std::int64_t second = 1'000'000'000;
enum Port : std::uint32_t { tracks, truth };

/// Objects and estimates in space, told by hand.
struct Scored {
    Bench bench;
    StageUnderTest analyzer{bench, plugin_of<tracking_error::TrackingError>("analyzer.tracking_error"), "{}"};
    pelorus::Space space = pelorus::kinematic_space(3, {1, 1});

    void real(std::int64_t time, std::uint64_t id, std::vector<double> state) {
        pelorus::TruthBuilder builder("", space);
        builder.add({id, time * second, state.data(), nullptr, id, 0, {}});
        analyzer.receive(truth, builder.message(time * second));
    }
    void estimate(std::int64_t time, std::uint64_t id, std::vector<double> mean, double variance = 1,
                  std::int32_t status = PLR_TRACK_CONFIRMED) {
        const Eigen::MatrixXd covariance = variance * Eigen::MatrixXd::Identity(6, 6);
        pelorus::TracksBuilder builder("", space);
        builder.add({id, time * second, status, 0, mean.data(), covariance.data(), nullptr, {}, 0, {}, {}});
        analyzer.receive(tracks, builder.message((time + 1) * second), (time + 1) * second);  // belated
    }
    const plr_table& table() {
        if (bench.published.empty()) analyzer.finish();
        return bench.published.back().table();
    }
    double cell(std::int64_t row, const std::string& column) {
        const plr_table& t = table();
        for (std::uint32_t c = 0; c < t.column_count; ++c)
            if (column == t.columns[c].name) return t.rows.data[row * t.rows.item_stride + c];
        throw std::runtime_error("no column " + column);
    }
    const plr_scalar& scalar(const std::string& name) {
        const plr_table& t = table();
        for (std::uint32_t i = 0; i < t.scalar_count; ++i)
            if (name == t.scalars[i].name) return t.scalars[i];
        throw std::runtime_error("no scalar " + name);
    }
};

}  // namespace

TEST_CASE("tracking error: norms, axes, bias and consistency of one target", "[tracking_error]") {
    Scored run;
    run.real(0, 9, {0, 0, 0, 1, 0, 0});
    run.real(1, 9, {1, 0, 0, 1, 0, 0});
    run.estimate(0, 1, {3, 4, 0, 1, 0, 2}, 4);
    run.estimate(1, 1, {1, 0, -12, 1, 0, 0});
    REQUIRE(run.table().rows.count == 2);
    CHECK(run.cell(0, "time") == 0);
    CHECK(run.cell(0, "position") == Approx(5));
    CHECK(run.cell(0, "velocity") == Approx(2));
    CHECK(run.cell(0, "nees") == Approx((9 + 16 + 4) / 4.0));
    CHECK(run.cell(0, "position.y") == Approx(4));
    CHECK(run.cell(1, "position") == Approx(12));
    CHECK(run.cell(1, "position.z") == Approx(12));
    CHECK(run.cell(1, "position_bias.z") == Approx(-12));
    CHECK(std::string(run.scalar("position_rmse").column) == "position");
    CHECK(std::string(run.scalar("velocity_rmse").unit) == "m/s");
    CHECK(run.scalar("track_count").value == 1);
    for (std::uint32_t c = 0; c < run.table().column_count; ++c) {
        const std::string name = run.table().columns[c].name;
        if (name == "time") CHECK(run.table().columns[c].reduce == PLR_REDUCE_KEY);
        if (name == "position" || name == "velocity")
            CHECK(run.table().columns[c].reduce == PLR_REDUCE_ROOT_MEAN_SQUARE);
        if (name.rfind("position_bias", 0) == 0) CHECK(run.table().columns[c].reduce == PLR_REDUCE_MEAN);
    }
}

TEST_CASE("tracking error: estimates that are missing leave a gap and are counted", "[tracking_error]") {
    Scored run;
    for (int k = 0; k < 4; ++k) run.real(k, 9, {0, 0, 0, 0, 0, 0});
    run.estimate(1, 1, {1, 0, 0, 0, 0, 0});
    run.estimate(2, 1, {1, 0, 0, 0, 0, 0}, 1, PLR_TRACK_COASTING);
    run.estimate(3, 1, {1, 0, 0, 0, 0, 0}, 1, PLR_TRACK_TENTATIVE);
    run.estimate(7, 1, {1, 0, 0, 0, 0, 0});
    REQUIRE(run.table().rows.count == 4);
    CHECK(std::isnan(run.cell(0, "position")));
    CHECK(run.cell(2, "position") == 1);
    CHECK(std::isnan(run.cell(3, "nees")));
    CHECK(run.scalar("missing").value == 2);
    CHECK(run.scalar("estimates").value == 2);
    CHECK(run.scalar("without_truth").value == 1);
}

TEST_CASE("tracking error: each estimate is scored against the nearest object, and told again it replaces itself",
          "[tracking_error]") {
    Scored run;
    run.real(0, 1, {0, 0, 0, 0, 0, 0});
    run.real(0, 2, {100, 0, 0, 0, 0, 0});
    run.estimate(0, 1, {55, 0, 0, 0, 0, 0});
    run.estimate(0, 1, {97, 0, 0, 0, 0, 0});
    run.estimate(0, 2, {104, 0, 0, 0, 0, 0});
    CHECK(run.cell(0, "position") == Approx(std::sqrt((9 + 16) / 2.0)));
    CHECK(run.cell(0, "estimates") == 2);
    CHECK(run.cell(0, "missing") == 1);
    CHECK(run.scalar("track_count").value == 2);
}

TEST_CASE("tracking error: a covariance that is none gives no consistency figure", "[tracking_error]") {
    Scored run;
    run.real(0, 1, {0, 0, 0, 0, 0, 0});
    run.estimate(0, 1, {1, 0, 0, 0, 0, 0}, 0);
    CHECK(std::isnan(run.cell(0, "nees")));
    CHECK(run.cell(0, "position") == 1);
}

TEST_CASE("tracking error: tracks on other axes than the truth's are refused", "[tracking_error]") {
    Scored run;
    run.real(0, 1, {0, 0, 0, 0, 0, 0});
    pelorus::TracksBuilder flat("", pelorus::kinematic_space(2, {1, 1}));
    const double mean[4] = {}, covariance[16] = {};
    flat.add({1, 0, PLR_TRACK_CONFIRMED, 0, mean, covariance, nullptr, {}, 0, {}, {}});
    CHECK_THROWS_WITH(run.analyzer.receive(tracks, flat.message(0)),
                      "tracks have positions on 2 axes, what came before on 3");
    CHECK(run.scalar("missing").value == 1);
}

TEST_CASE("tracking error: saved half-way, it tells the same", "[tracking_error]") {
    Scored first, second_half;
    for (int k = 0; k < 5; ++k) {
        first.real(k, 1, {0, 0, 0, 0, 0, 0});
        first.estimate(k, 1, {1.0 * k, 0, 0, 0, 0, 1});
    }
    second_half.analyzer.load(first.analyzer.save());
    for (int k = 0; k < 5; ++k) CHECK(second_half.cell(k, "position") == first.cell(k, "position"));
    CHECK(second_half.scalar("track_count").value == 1);
}

TEST_CASE("tracking error: nothing at all is an empty table", "[tracking_error]") {
    Scored run;
    CHECK(run.table().rows.count == 0);
    CHECK(run.scalar("missing").value == 0);
}
