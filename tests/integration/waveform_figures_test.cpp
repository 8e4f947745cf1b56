// The waveform paper's campaigns as they are shipped: the figures that stand beside each config, and what the reproduction says of them.
#include <numeric>

#include "../support/expected_figures.hpp"

using namespace pelorus::test;

namespace {

const std::vector<std::string> errors{"errors.position_rmse", "errors.velocity_rmse", "errors.acceleration_rmse"};

/// A set of 500 runs scatters by 0.4, 0.3 and 0.2 %; figures are printed with one digit behind the point.
Band band_of(const std::string&, const std::string& scalar) { return {scalar == errors[0] ? 0.015 : 0.025, 0.05}; }

void check_ratios(const Json& cells, const std::string& variant, const std::vector<double>& known) {
    for (std::size_t k = 0; k < errors.size(); ++k) {
        CAPTURE(variant, errors[k]);
        const double ratio = value(cell_of(cells, variant), errors[k]) / value(cell_of(cells, "aca"), errors[k]);
        CHECK(ratio == Approx(known[k]).epsilon(0.02));
    }
}

}  // namespace

// Thousands of runs: too slow under the sanitizers, which see the same code in the cases of waveform_test.cpp.
TEST_CASE("the waveform campaign reaches the figures beside it", "[waveform][release-only]") {
    const Json cells = cells_of("waveform", {});
    REQUIRE(cells.size() == 14);
    CHECK(check_figures("waveform", cells, band_of) == 42);
    check_ratios(cells, "aca_rotation_exact", {0.647, 0.987, 0.995});
    check_ratios(cells, "imm", {0.971, 0.735, 0.699});
    check_ratios(cells, "cs", {1.035, 1.306, 1.361});
    check_ratios(cells, "ca", {1.404, 1.263, 0.761});
    for (const std::string& scalar : errors) {
        CAPTURE(scalar);
        // The exhaustive scheduler ties with one fixed up-chirp; the best choice is better than the tuned filter with it.
        CHECK(value(cell_of(cells, "aca_library"), scalar) ==
              Approx(value(cell_of(cells, "aca_fixed_chirp"), scalar)).epsilon(0.002));
        CHECK(value(cell_of(cells, "best"), scalar) < value(cell_of(cells, "imm_fixed_chirp"), scalar));
    }
    CHECK(value(cell_of(cells, "best"), errors[0]) > 19.0);  // below, it would know what it cannot know
}

TEST_CASE("the waveform campaign with a noise that grows with range reaches the figures beside it",
          "[waveform][release-only]") {
    std::vector<std::string> flags;
    for (const char* variant : {"aca", "aca_rotation_published", "aca_rotation_exact", "imm", "cs", "ca"})
        flags.insert(flags.end(), {"--variant", variant});
    CHECK(check_figures("waveform_range_law", cells_of("waveform_range_law", flags), band_of) == 18);
}

TEST_CASE("errors grow with falling signal-to-noise ratio as the reproduction's do", "[waveform][release-only]") {
    const Json cells = cells_of("waveform_snr", {"--variant", "aca", "--variant", "ca", "--variant", "imm"});
    const std::string snr = "world.sensors.radar.snr";  // in summary.json a ratio of powers: 0 dB is 1, -20 dB 0.01
    const std::map<std::string, std::vector<double>> known{
        {"aca", {9.27, 8.83, 7.54}}, {"ca", {6.85, 2.74, 1.19}}, {"imm", {8.70, 4.68, 2.43}}};
    for (const auto& [variant, growth] : known)
        for (std::size_t k = 0; k < errors.size(); ++k) {
            CAPTURE(variant, errors[k]);
            CHECK(value(cell_of(cells, variant, {{snr, 0.01}}), errors[k]) /
                      value(cell_of(cells, variant, {{snr, 1}}), errors[k]) ==
                  Approx(growth[k]).epsilon(0.04));
        }
}

TEST_CASE("a target of the filter's own model is tracked as well as the Cramer-Rao bound allows",
          "[waveform][release-only]") {
    const Json cells = cells_of("waveform_matched", {});
    REQUIRE(cells.size() == 1);
    const Json& tables = cells[0]["tables"];
    const auto column = [&](const std::string& table, const std::string& name) {
        const Json& columns = tables[table]["columns"];
        std::size_t place = 0;
        while (columns.at(place)["name"] != name) ++place;
        std::vector<double> out;
        for (const Json& row : tables[table]["rows"]) out.push_back(row[place]);
        return out;
    };
    constexpr std::size_t first = 5;  // steps 6 to 60: the rows begin with step 1
    for (const std::string derivative : {"position", "velocity", "acceleration"})
        for (const std::string axis : {".x", ".y"}) {
            const auto errors = column(derivative == "acceleration" ? "errors.acceleration" : "errors.by_time",
                                       derivative + axis),
                       bounds = column("bound.by_time", derivative + axis);
            REQUIRE(errors.size() == 60);
            REQUIRE(bounds.size() == 60);
            double ratio = 0;
            for (std::size_t k = first; k < 60; ++k) ratio += errors[k] / bounds[k] / (60.0 - first);
            CAPTURE(derivative, axis);
            CHECK(ratio == Approx(1).margin(0.04));
        }
    const auto nees = column("errors.by_time", "nees");
    CHECK(std::accumulate(nees.begin() + first, nees.end(), 0.0) / 55 == Approx(6).margin(0.3));
}
