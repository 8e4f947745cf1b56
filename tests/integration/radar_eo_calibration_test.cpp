// A head that is turned by 1 mrad, or is not, and a calibration against the radar that does not know.
#include "../support/expected_figures.hpp"

using namespace pelorus::test;

// Hundreds of runs: too slow under the sanitizers, which see the same code in shorter ones.
TEST_CASE("a calibration on line makes up for a turned head, and costs little where nothing is wrong",
          "[radar_eo][release-only]") {
    const Json cells = cells_of("radar_eo_calibration", {"--variant", "imm", "--runs", "40"});
    const Json right{0.0, 0.0, 0.0}, turned{0.0, 0.0, 1e-3}, nothing{0.0, 0.0, 0.0}, any{1e-3, 1e-3, 1e-3};
    for (const std::string reading : {"own", "passive"}) {
        CAPTURE(reading);
        const auto figure = [&](const Json& error, const Json& estimated, const char* scalar) {
            return value(cell_of(cells, "imm",
                                 {{"world.sensors.eo.range", reading},
                                  {"world.sensors.eo.attitude_error", error},
                                  {"calibration.attitude_sd", estimated}}),
                         scalar);
        };
        const auto armse = [&](const Json& error, const Json& estimated) {
            return figure(error, estimated, "errors.position_armse");
        };
        const bool is_own = reading == "own";
        // Left alone, the turn costs a factor of 5 and of 2.
        CHECK(armse(turned, nothing) > (is_own ? 4.5 : 1.8) * armse(right, nothing));
        CHECK(armse(turned, any) < (is_own ? 0.9 : 1.5));
        CHECK(armse(right, any) < (is_own ? 1.5 : 1.1) * armse(right, nothing));
        // What is not known of the turn is in the tracks' covariances: three is the right mean.
        for (const Json& error : {right, turned}) {
            CHECK(figure(error, any, "errors.nees") > 1.2);
            CHECK(figure(error, any, "errors.nees") < 3.6);
        }
    }
}
