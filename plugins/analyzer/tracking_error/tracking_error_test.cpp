#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "../../../tests/fixtures/results_of.hpp"
#include "tracking_error.hpp"

namespace {

using namespace pelorus::test;
constexpr std::int64_t second = 1'000'000'000;
enum Port : std::uint32_t { tracks, truth, innovations };

/// Objects and estimates in space, told by hand.
struct Scored {
    Bench bench;
    StageUnderTest analyzer;
    ResultsOf results{bench, analyzer};
    pelorus::Space space;
    explicit Scored(const std::string& with = "{}", const std::vector<double>& deviations = {1, 1})
        : analyzer(bench, plugin_of<tracking_error::TrackingError>("analyzer.tracking_error"), with),
          space(pelorus::kinematic_space(3, deviations)) {}

    void real(std::int64_t time, std::uint64_t id, std::vector<double> state) {
        pelorus::TruthBuilder builder("", space);
        builder.add({id, time * second, state.data(), nullptr, id, 0, {}});
        analyzer.receive(truth, builder.message(time * second));
    }
    void estimate(std::int64_t time, std::uint64_t id, std::vector<double> mean, double variance = 1,
                  std::int32_t status = PLR_TRACK_CONFIRMED) {
        const Eigen::MatrixXd covariance = variance * Eigen::MatrixXd::Identity(space.size(), space.size());
        pelorus::TracksBuilder builder("", space);
        builder.add({id, time * second, status, 0, mean.data(), covariance.data(), nullptr, {}, 0, {}, {}});
        analyzer.receive(tracks, builder.message((time + 1) * second), (time + 1) * second);  // belated
    }
    void innovation(std::int64_t time, const std::vector<double>& squares, int components) {
        pelorus::InnovationsBuilder builder;
        for (std::size_t i = 0; i < squares.size(); ++i) builder.add(i + 1, squares[i], components);
        analyzer.receive(innovations, builder.message(time * second));
    }
    const plr_table& table() { return results.table(); }
    double cell(std::int64_t row, const std::string& column) { return results.cell(row, column); }
    const plr_scalar& scalar(const std::string& name) { return results.scalar(name); }
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

TEST_CASE("tracking error: velocity has axes and a bias, too", "[tracking_error]") {
    Scored run;
    run.real(0, 9, {0, 0, 0, 10, 0, 0});
    run.estimate(0, 1, {0, 0, 0, 11, 0, -2});
    CHECK(run.cell(0, "velocity.x") == Approx(1));
    CHECK(run.cell(0, "velocity.z") == Approx(2));
    CHECK(run.cell(0, "velocity_bias.z") == Approx(-2));
    CHECK(run.cell(0, "velocity_bias.y") == 0);
    CHECK_FALSE(run.results.has_table("acceleration"));
}

TEST_CASE("tracking error: accelerations are scored where both sides tell them", "[tracking_error]") {
    Scored run("{acceleration: true}", {1, 1, 1});
    run.real(0, 9, {0, 0, 0, 0, 0, 0, 0, 1, 0});
    run.estimate(0, 1, {0, 0, 0, 2, 0, 0, 3, 5, 0}, 2);
    CHECK(run.results.cell(0, "acceleration", "acceleration") == Approx(5));
    CHECK(run.results.cell(0, "acceleration.x", "acceleration") == Approx(3));
    CHECK(run.results.cell(0, "acceleration_bias.y", "acceleration") == Approx(4));
    CHECK(std::string(run.scalar("acceleration_rmse").column) == "acceleration");
    CHECK(run.cell(0, "nees") == Approx(2));  // of position and velocity alone
}

TEST_CASE("tracking error: the ratio of squares to components lies between its bounds", "[tracking_error]") {
    Scored run("{confidence: 0.9}");
    run.real(0, 1, {0, 0, 0, 0, 0, 0});
    run.real(0, 2, {100, 0, 0, 0, 0, 0});
    run.estimate(0, 1, {3, 0, 0, 0, 0, 0}, 1);
    run.estimate(0, 2, {100, 3, 3, 0, 0, 0}, 1);
    CHECK(run.cell(0, "nees") == Approx(27 / 2.0));
    CHECK(run.cell(0, "anees") == Approx(27 / 12.0));
    CHECK(run.cell(0, "anees_lower") == 12);  // degrees of freedom: the host makes the bound
    CHECK(run.cell(0, "anees_upper") == 12);
    CHECK(run.results.column("anees_lower").reduce == PLR_REDUCE_CHI_SQUARE);
    CHECK(run.results.column("anees_lower").quantile == Approx(0.05));
    CHECK(run.results.column("anees_upper").quantile == Approx(0.95));
}

TEST_CASE("tracking error: without a covariance there are no degrees of freedom", "[tracking_error]") {
    Scored run;
    run.real(0, 1, {0, 0, 0, 0, 0, 0});
    run.estimate(0, 1, {1, 0, 0, 0, 0, 0}, 0);
    run.estimate(0, 2, {2, 0, 0, 0, 0, 0}, 1);
    CHECK(run.cell(0, "nees") == Approx(4));
    CHECK(run.cell(0, "anees_lower") == 6);
}

TEST_CASE("tracking error: innovations have a table of their own", "[tracking_error]") {
    Scored run;
    run.innovation(1, {2, 4}, 3);
    run.innovation(1, {3}, 2);
    run.innovation(2, {1}, 3);
    const plr_table& table = run.results.table("innovations");
    REQUIRE(table.rows.count == 2);
    CHECK(run.results.cell(0, "time", "innovations") == 1);
    CHECK(run.results.cell(0, "nis", "innovations") == Approx(3));
    CHECK(run.results.cell(0, "anis", "innovations") == Approx(9 / 8.0));
    CHECK(run.results.cell(0, "anis_lower", "innovations") == 8);
    CHECK(run.results.cell(1, "innovations", "innovations") == 1);
    CHECK(run.scalar("innovations").value == 4);
    CHECK(std::string(run.scalar("nis").column) == "nis");
}

TEST_CASE("tracking error: values that are no innovations are refused", "[tracking_error]") {
    Scored run;
    pelorus::ValuesBuilder other;
    other.add("", "bias", "m", Eigen::MatrixXd::Ones(1, 1));
    CHECK_THROWS_WITH(run.analyzer.receive(innovations, other.message(0)), "tells no normalised_innovation_squared");
    pelorus::ValuesBuilder shapeless;
    shapeless.add("", PLR_QUANTITY_INNOVATION, "", Eigen::MatrixXd::Ones(1, 1));
    CHECK_THROWS_WITH(run.analyzer.receive(innovations, shapeless.message(0)),
                      Catch::Contains("is 1 x 1 an item, expected 2 x 1 and ids"));
    CHECK_FALSE(run.results.has_table("innovations"));
}

TEST_CASE("tracking error: goes on exactly where its saved state left off", "[tracking_error]") {
    Scored one, two;
    one.real(0, 1, {0, 0, 0, 0, 0, 0});
    one.estimate(0, 1, {1, 0, 0, 0, 0, 0});
    one.innovation(0, {2}, 3);
    two.analyzer.load(one.analyzer.save());
    CHECK(two.cell(0, "position") == 1);
    CHECK(two.results.cell(0, "nis", "innovations") == 2);
}

TEST_CASE("tracking error: what comes before from_scan is not scored", "[tracking_error]") {
    Scored run("{from_scan: 1, acceleration: true}", {1, 1, 1});
    for (int k = 0; k < 3; ++k) {
        run.real(k, 9, {0, 0, 0, 0, 0, 0, 0, 0, 0});
        run.estimate(k, 1, {10.0 - 3 * k, 0, 0, 0, 0, 0, 0, 0, 0});
    }
    REQUIRE(run.table().rows.count == 2);
    CHECK(run.cell(0, "position") == Approx(7));
    CHECK(run.results.table("acceleration").rows.count == 2);
    CHECK(run.scalar("estimates").value == 2);
}

TEST_CASE("tracking error: nees counts as many derivatives as it is asked for", "[tracking_error]") {
    for (const int derivatives : {1, 2, 3}) {
        Scored run("{nees_derivatives: " + std::to_string(derivatives) + "}", {1, 1, 1});
        run.real(0, 9, {0, 0, 0, 0, 0, 0, 0, 0, 0});
        run.estimate(0, 1, {1, 0, 0, 0, 2, 0, 0, 0, 3}, 1);
        CHECK(run.cell(0, "nees") == Approx(derivatives == 1 ? 1 : derivatives == 2 ? 5 : 14));
    }
}

TEST_CASE("tracking error: a single run tells its root mean squares over time", "[tracking_error]") {
    Scored run("{whole_run: true}");
    for (int k = 0; k < 2; ++k) run.real(k, 9, {0, 0, 0, 0, 0, 0});
    run.estimate(0, 1, {3, 0, 0, 0, 0, 1});
    run.estimate(1, 1, {-5, 4, 0, 0, 0, 7});
    CHECK(run.scalar("position_rms.x").value == Approx(std::sqrt(17)));
    CHECK(run.scalar("position_rms.y").value == Approx(std::sqrt(8)));
    CHECK(run.scalar("position_rms").value == Approx(5));
    CHECK(run.scalar("velocity_rms.z").value == Approx(5));
    CHECK(run.scalar("position_rms").reduce == PLR_REDUCE_ROOT_MEAN_SQUARE);
}

TEST_CASE("tracking error: averaged errors of x and y beside those of all axes", "[tracking_error]") {
    Scored run("{armse: true}");
    run.real(0, 9, {0, 0, 0, 0, 0, 0});
    run.estimate(0, 1, {3, 4, 12, 0, 0, 0});
    CHECK(run.cell(0, "position_xy") == Approx(5));
    CHECK(run.cell(0, "position") == Approx(13));
    CHECK(std::string(run.scalar("position_armse").column) == "position_xy");
    CHECK(std::string(run.scalar("position_armse_3d").column) == "position");
}

TEST_CASE("tracking error: only instants at multiples of the period count, and nees may begin later",
          "[tracking_error]") {
    Scored run("{period: 2 s, from_scan: 1, nees_from_scan: 2}");
    for (int k = 0; k < 7; ++k) {
        run.real(k, 9, {0, 0, 0, 0, 0, 0});
        run.estimate(k, 1, {1.0 * k, 0, 0, 0, 0, 0});
    }
    REQUIRE(run.table().rows.count == 3);
    for (int row = 0; row < 3; ++row) CHECK(run.cell(row, "time") == 2 * (row + 1));
    CHECK(run.cell(0, "position") == 2);
    CHECK(std::isnan(run.cell(0, "nees")));
    CHECK(std::isnan(run.cell(0, "anees")));
    CHECK(run.cell(1, "nees") == Approx(16));
    CHECK(run.scalar("estimates").value == 3);
}
