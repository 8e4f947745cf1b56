// A narrow camera that a radar's track points, closed by a feedback edge: the shipped config, against what geometry says of it.
#include "../support/expected_figures.hpp"

using namespace pelorus::test;

namespace {

/// Values of a column of a table of a cell.
std::vector<double> column(const Json& cell, const std::string& table, const std::string& name) {
    std::vector<double> out;
    const Json& told = cell["tables"][table];
    for (std::size_t c = 0; c < told["columns"].size(); ++c)
        if (told["columns"][c]["name"] == name)
            for (const Json& row : told["rows"]) out.push_back(row[c].is_null() ? std::nan("") : row[c].get<double>());
    REQUIRE_FALSE(out.empty());
    return out;
}

}  // namespace

// Tens of thousands of scans: too slow under the sanitizers, which see the same code in the cases of pointing_scheduler_test.cpp.
TEST_CASE("a pointed camera is worth nearly as much as one that sees everything", "[cueing][release-only]") {
    const Json cells = cells_of("radar_eo_cueing", {"--runs", "10", "--variant", "cued", "--variant", "cued_wide",
                                                    "--variant", "never_pointed", "--variant", "sees_everything"});
    CHECK(check_figures("radar_eo_cueing", cells, [](const std::string&, const std::string&) {
              return Band{0, 0};
          }) == 9);
    const Json &cued = cell_of(cells, "cued"), &wide = cell_of(cells, "cued_wide"),
               &never = cell_of(cells, "never_pointed"), &everything = cell_of(cells, "sees_everything");
    const std::string error = "errors.position_rmse";
    CHECK(value(cued, error) < 1.04 * value(everything, error));
    CHECK(value(wide, error) < 1.02 * value(everything, error));
    CHECK(value(everything, error) < 0.5 * value(never, error));
    CHECK(value(never, "scheduler.locked_share") == 0);

    // It turns from (-90, 10) degrees of its own axes to where the track is, and not before it is there can it see anything.
    const double pi = std::acos(-1.0), azimuth = column(wide, "scheduler.looks", "azimuth")[0],
                 elevation = column(wide, "scheduler.looks", "elevation")[0];
    const double cosine =
        std::sin(pi / 18) * std::sin(elevation) + std::cos(pi / 18) * std::cos(elevation) * std::cos(azimuth + pi / 2);
    const double way = std::acos(cosine) / (20 * pi / 180);  // s
    CHECK(value(wide, "scheduler.first_lock") > way);
    CHECK(value(wide, "scheduler.first_lock") < way + 0.7);
    CHECK(value(cued, "scheduler.first_lock") > value(wide, "scheduler.first_lock"));

    // What the narrow field loses at the outage's end, it has again some seconds later.
    const auto from = column(cued, "scheduler.locks", "from"), to = column(cued, "scheduler.locks", "to");
    REQUIRE(from.size() >= 2);
    CHECK(to[0] == Approx(220.4).margin(0.3));
    CHECK(from[1] > 220.5);
    CHECK(from[1] < 226);
    CHECK(column(wide, "scheduler.locks", "from").size() == 1);
}

TEST_CASE("a camera is pointed at one of two targets among false alarms", "[cueing][release-only]") {
    const Json cells = cells_of("radar_eo_cueing_clutter", {"--runs", "4", "--variant", "cued"});
    const Json& cued = cell_of(cells, "cued");
    CHECK(value(cued, "errors.position_rmse") < 3.2);  // 6.0 without the camera
    CHECK(value(cued, "scheduler.locked_share") > 0.94);
    CHECK(value(cued, "scheduler.losses") < 2.5);
    CHECK(value(cued, "scheduler.first_lock") > 6);
    CHECK(value(cued, "scheduler.first_lock") < 22);
}
