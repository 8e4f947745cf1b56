// As guard_test.cpp, for the kinds that no tracker of points needs: trajectory, extent, waveform.
#include <catch2/catch.hpp>

#include "guard_config.hpp"

using namespace pelorus::test;

namespace {

struct Case {
    std::string fault, in, told;
};

const std::string threw = "an exception came through the C table: boom";

ZooConfig with_waveform(const std::string& fault, const std::string& in) {
    ZooConfig config;
    config.further =
        "  looks:\n    use: org.example.analyzer.zoo_looks\n    in: {scans: world.scans}\n    parts: {waveform: " +
        zoo_part("waveform", fault, in) + "}\n";
    return config;
}

/// A tracker of extended targets beside the one of points.
ZooConfig with_extent(const std::string& fault, const std::string& in) {
    ZooConfig config;
    config.further = R"(  shapes:
    use: tracker.extended_target
    in: {scans: world.scans}
    parts:
      estimator:
        use: estimator.kalman
        parts: {motion: {use: motion.constant_velocity}, sensors: {radar: {use: sensor.position, with: {noise: 10 m}}}}
      extent: )" + zoo_part("extent", fault, in) +
                     "\n";
    return config;
}

}  // namespace

TEST_CASE("guard: a trajectory that breaks its contract is named") {
    const auto one = GENERATE_COPY(values<Case>({
        {"throws", "realise", "realise: " + threw},
        {"beyond", "realise", "realise: it wrote outside record, which is 1 x 1 x 1"},
        {"throws", "states", "states: " + threw},
        {"beyond", "states", "states: it wrote outside states, which is 6 x "},
        {"between", "states", "states: it wrote outside states, which is 6 x "},
        {"input", "states", "states: it changed its input record"},
        {"nan", "states",
         "states: the state of object 0 at 0 ns has 5 components of 6 that are finite numbers, expected"},
        {"unwritten", "states", "states: states was not written (row 0, column 0)"},
        {"status", "states", "states: it answered status 7, expected PLR_OK, PLR_ITEMS_FAILED or PLR_E_... (1 to -13)"},
    }));
    CAPTURE(one.fault, one.in);
    const TemporaryFolder folder;
    ZooConfig config;
    config.trajectory = zoo_part("trajectory", one.fault, one.in);
    const Ended ended = run_zoo(folder, config);
    CAPTURE(ended.err);
    // Some are seen when the simulation is made, which refuses the config; others when it runs.
    CHECK((ended.exit == 1 || ended.exit == 2));
    CHECK_THAT(first_line(ended.err),
               Catch::Contains("world.targets.aircraft (org.example.trajectory.zoo), " + one.told));
}

TEST_CASE("guard: an extent that breaks its contract is named") {
    const std::string shape_like = ", item 0: matrix ";
    const auto one = GENERATE_COPY(values<Case>({
        {"throws", "init", "init: " + threw},
        {"beyond", "init", "init: it wrote outside record, which is 1 x 1 x 1"},
        {"input", "init", "init: it changed its input points"},
        {"throws", "predict", "predict: " + threw},
        {"beyond", "predict", "predict: it wrote outside out, which is 1 x 1 x 1"},
        {"input", "predict", "predict: it changed its input before"},
        {"nan", "effective_noise", "effective_noise, item 0: out is nan, expected a finite number (row 0, column 0)"},
        {"negative", "effective_noise",
         "effective_noise, item 0: out has -1 on its diagonal (row 0), expected no negative variance"},
        {"throws", "update", "update: " + threw},
        {"unflagged", "update", "update: it answered PLR_ITEMS_FAILED, but the item_status of every item is PLR_OK"},
        {"nan", "shape", "shape" + shape_like + "is nan, expected a finite number (row 0, column 0)"},
        {"unwritten", "shape", "shape" + shape_like + "was not written (row 0, column 0)"},
        {"nan", "gate", "gate, item 0: squared_distance of point 0 is nan, expected a number"},
        {"beyond", "gate", "gate: it wrote outside squared_distance, which is 1 x 1 x 1"},
    }));
    CAPTURE(one.fault, one.in);
    const TemporaryFolder folder;
    const Ended ended = run_zoo(folder, with_extent(one.fault, one.in));
    CAPTURE(ended.err);
    CHECK(ended.exit == 1);
    CHECK_THAT(first_line(ended.err),
               Catch::StartsWith("pelorus: node shapes (tracker.extended_target), receive scans at ") &&
                   Catch::EndsWith(": shapes.extent (org.example.extent.zoo), " + one.told));
}

TEST_CASE("guard: a waveform that breaks its contract is named") {
    const auto one = GENERATE_COPY(values<Case>({
        {"throws", "choose", "choose: " + threw},
        {"nan", "choose", "choose, item 0: noise is nan, expected a finite number (row 0, column 0)"},
        {"input", "choose", "choose: it changed its input base_noise"},
        {"beyond", "choose", "choose: it wrote outside noise, which is 3 x 3 x 1"},
        {"unwritten", "choose", "choose, item 0: waveform was not written (row 0, column 0)"},
        {"flagged", "choose",
         "choose, item 0: its item_status is PLR_E_NUMERIC, but the call answered PLR_OK, expected PLR_ITEMS_FAILED"},
        {"throws", "noise", "noise: " + threw},
        {"asymmetric", "noise", "noise, item 0: out is not symmetric: 0 at row 1, column 0, but 1 at row 0, column 1"},
        {"negative", "noise", "noise, item 0: out has -1 on its diagonal (row 0), expected no negative variance"},
    }));
    CAPTURE(one.fault, one.in);
    const TemporaryFolder folder;
    const Ended ended = run_zoo(folder, with_waveform(one.fault, one.in));
    CAPTURE(ended.err);
    check_told(folder, ended, "looks (org.example.analyzer.zoo_looks), receive scans at 0 s",
               "looks.waveform (org.example.waveform.zoo), " + one.told);
}

TEST_CASE("guard: well-behaved trajectories, extents and waveforms pass, every call looked at") {
    const TemporaryFolder folder;
    ZooConfig config = with_waveform("none", "choose");
    config.further += with_extent("none", "update").further;
    config.trajectory = zoo_part("trajectory", "none", "states");
    const Ended ended = run_zoo(folder, config, {"--guard", "all"});
    CAPTURE(ended.err);
    CHECK(ended.exit == 0);
    CHECK(ended.err.find("zoo") == std::string::npos);
}
