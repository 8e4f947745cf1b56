// A head that is turned by 1 mrad, or is not, and a calibration against the radar that does not know.
#include "../support/expected_figures.hpp"

using namespace pelorus::test;

namespace {

const Json right{0.0, 0.0, 0.0}, turned{0.0, 0.0, 1e-3}, nothing{0.0, 0.0, 0.0}, any{1e-3, 1e-3, 1e-3};

/// Of one variant with one reading of the head.
struct Figures {
    Json cells;
    std::string variant, reading;

    double of(const char* scalar, const Json& error, const Json& estimated) const {
        return value(cell_of(cells, variant,
                             {{"world.sensors.eo.range", reading},
                              {"world.sensors.eo.attitude_error", error},
                              {"calibration.attitude_sd", estimated}}),
                     scalar);
    }
    double armse(const Json& error, const Json& estimated) const {
        return of("errors.position_armse", error, estimated);
    }
};

}  // namespace

// Hundreds of runs: too slow under the sanitizers, which see the same code in shorter ones.
TEST_CASE("a calibration on line makes up for a turned head in the published chain, and costs little where it is right",
          "[radar_eo][release-only]") {
    const Json cells = cells_of("radar_eo_calibration", {"--variant", "imm", "--runs", "30"});
    for (const std::string reading : {"own", "passive"}) {
        CAPTURE(reading);
        const Figures figures{cells, "imm", reading};
        const bool is_own = reading == "own";
        // Left alone, the turn costs a factor of 5 and of 2.
        CHECK(figures.armse(turned, nothing) > (is_own ? 4.5 : 1.8) * figures.armse(right, nothing));
        CHECK(figures.armse(turned, any) < (is_own ? 0.9 : 1.5));
        CHECK(figures.armse(right, any) < (is_own ? 1.5 : 1.1) * figures.armse(right, nothing));
    }
}

TEST_CASE("tracks that are corrected for a turned head know how wrong they are", "[radar_eo][release-only]") {
    const Json cells = cells_of("radar_eo_calibration", {"--variant", "expert", "--runs", "20"});
    for (const std::string reading : {"own", "passive"}) {
        CAPTURE(reading);
        const Figures figures{cells, "expert", reading};
        CHECK(figures.armse(turned, any) < 0.5 * figures.armse(turned, nothing));
        CHECK(figures.of("errors.nees", turned, nothing) > 1000);
        // Three is the right mean; less where nothing is wrong, which is one of the things that might have been.
        for (const Json& error : {right, turned}) {
            CHECK(figures.of("errors.nees", error, any) > 1.0);
            CHECK(figures.of("errors.nees", error, any) < 3.6);
        }
    }
}
