// The plane-motion campaign as it is shipped: the figures that stand beside the config, and the tracker that is told of the plane.
#include "../support/expected_figures.hpp"

using namespace pelorus::test;

namespace {

/// Means of statistics scatter by a percent or less over 1000 runs; critical values are exact.
Band band_of(const std::string&, const std::string& scalar) {
    if (scalar.find("critical_value") != std::string::npos) return {0, 1e-4};
    return {0.03, 0};
}

/// Root mean square of a column over times in (from, to] (s).
double over(const Json& cell, const std::string& name, double from, double to) {
    const Json& table = cell["tables"]["errors.by_time"];
    std::size_t at = 0;
    while (table["columns"][at]["name"] != name) ++at;
    double sum = 0;
    int count = 0;
    for (const Json& row : table["rows"])
        if (row[0].get<double>() > from && row[0].get<double>() <= to) {
            sum += row[at].get<double>() * row[at].get<double>();
            ++count;
        }
    return std::sqrt(sum / count);
}

}  // namespace

TEST_CASE("the plane-motion campaign reaches the figures beside it", "[plane_motion][release-only]") {
    const Json cells = cells_of("plane_motion", {});
    REQUIRE(cells.size() == 2);
    CHECK(check_figures("plane_motion", cells, band_of) == 13);
    const Json& tested = cell_of(cells, "errors_in_variables");
    CHECK(value(tested, "plane.rejection_rate_40") >= 0.03);
    CHECK(value(tested, "plane.rejection_rate_40") <= 0.07);
    CHECK(value(tested, "plane.rejection_rate_50") >= 0.99);
    CHECK(value(tested, "plane.rejection_rate_75") >= 0.99);
    CHECK(value(tested, "plane.tested_40") == 1);
}

TEST_CASE("a tracker that is told of the plane is better while it holds, and no worse once it is rejected",
          "[plane_motion][release-only]") {
    const Json cells = cells_of("plane_motion_tracking", {"--runs", "100"});
    REQUIRE(cells.size() == 2);
    const Json &planar = cell_of(cells, "planar"), &free = cell_of(cells, "free");
    CHECK(over(planar, "position", 30, 40) < 0.95 * over(free, "position", 30, 40));
    CHECK(over(planar, "velocity", 30, 40) < 0.95 * over(free, "velocity", 30, 40));
    CHECK(over(planar, "position", 40, 50) < 1.02 * over(free, "position", 40, 50));
    CHECK(over(planar, "position", 0, 15) == Approx(over(free, "position", 0, 15)).epsilon(0.01));
    CHECK(over(planar, "position", 55, 75) == Approx(over(free, "position", 55, 75)).epsilon(0.01));
}
