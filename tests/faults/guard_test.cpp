// Models that break their contract: each fault gives one line that names part, call and what was expected, and ends the run
// with exit code 1; what was computed is kept.
#include <catch2/catch.hpp>

#include "guard_config.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

const std::string motion = "tracker.estimator.motion (org.example.motion.zoo), ";
const std::string sensor = "tracker.estimator.sensors.radar (org.example.sensor.zoo), ";
const std::string estimator = "tracker.estimator (org.example.estimator.zoo), ";

struct Case {
    const char* fault;
    const char* in;
    const char* place;
    std::string line;
};

const char* const second_scan = "tracker (tracker.point_target), receive scans at 1 s";

}  // namespace

TEST_CASE("guard: a motion that breaks its contract is named with call, item and what was expected") {
    const std::string threw = "an exception came through the C table";
    const auto one = GENERATE_COPY(values<Case>({
        {"throws", "propagate", second_scan, motion + "propagate: " + threw + ": boom"},
        {"throws", "jacobian", second_scan, motion + "jacobian: " + threw + ": boom"},
        {"throws", "noise", second_scan, motion + "noise: " + threw + ": boom"},
        {"throws_number", "propagate", second_scan,
         motion + "propagate: " + threw + ", of a type that is no std::exception"},
        {"nan", "propagate", second_scan,
         motion + "propagate, item 0: out is nan, expected a finite number (row 0, column 0)"},
        {"infinite", "jacobian", second_scan,
         motion + "jacobian, item 0: out is inf, expected a finite number (row 0, column 0)"},
        {"beyond", "jacobian", second_scan, motion + "jacobian: it wrote outside out, which is 6 x 6 x 1"},
        {"between", "propagate", second_scan, motion + "propagate: it wrote outside out, which is 6 x 1 x 1"},
        {"input", "propagate", second_scan, motion + "propagate: it changed its input state"},
        {"scratch", "noise", second_scan, ""},
        {"status", "propagate", second_scan,
         motion + "propagate: it answered status 7, expected PLR_OK, PLR_ITEMS_FAILED or PLR_E_... (1 to -13)"},
        {"unflagged", "propagate", second_scan,
         motion + "propagate: it answered PLR_ITEMS_FAILED, but the item_status of every item is PLR_OK"},
        {"flagged", "propagate", second_scan,
         motion + "propagate, item 0: its item_status is PLR_E_NUMERIC, but the call answered PLR_OK, expected "
                  "PLR_ITEMS_FAILED"},
        {"unwritten", "propagate", second_scan, motion + "propagate, item 0: out was not written (row 0, column 0)"},
        {"asymmetric", "noise", second_scan, ""},
        {"negative", "noise", second_scan,
         motion + "noise, item 0: out has -1 on its diagonal (row 0), expected no negative variance"},
        {"size", "", second_scan,
         motion + "propagate: info() answers 3 doubles of record, it answered 0 when the instance was made; it has to "
                  "be constant"},
    }));
    CAPTURE(one.fault, one.in);
    const TemporaryFolder folder;
    ZooConfig config;
    config.motion = zoo_part("motion", one.fault, *one.in == '\0' ? "\"\"" : one.in);
    const Ended ended = run_zoo(folder, config);
    CAPTURE(ended.err);
    if (!one.line.empty()) return check_told(folder, ended, one.place, one.line);
    // Numbers in the text that are not worth fixing.
    CHECK(ended.exit == 1);
    CHECK_THAT(first_line(ended.err),
               Catch::StartsWith(std::string("pelorus: node ") + one.place + ": " + motion + "noise") &&
                   (Contains("what is taken has to be given back") || Contains("out is not symmetric")));
}

TEST_CASE("guard: a sensor that breaks its contract is named") {
    const std::string threw = "an exception came through the C table: boom";
    const char* const first_scan = "tracker (tracker.point_target), receive scans at 0 s";
    const auto one = GENERATE_COPY(values<Case>({
        {"nan", "measure", second_scan,
         sensor + "measure, item 0: out is nan, expected a finite number (row 0, column 0)"},
        {"throws", "jacobian", second_scan, sensor + "jacobian: " + threw},
        {"throws", "residual", second_scan, sensor + "residual: " + threw},
        {"beyond", "measure", second_scan, sensor + "measure: it wrote outside out, which is 3 x 1 x 1"},
        {"nan", "invert", first_scan,
         sensor + "invert, item 0: mean is nan, expected a finite number (row 0, column 0)"},
    }));
    CAPTURE(one.fault, one.in);
    const TemporaryFolder folder;
    ZooConfig config;
    config.sensor = zoo_part("sensor", one.fault, one.in);
    const Ended ended = run_zoo(folder, config);
    CAPTURE(ended.err);
    check_told(folder, ended, one.place, one.line);
}

TEST_CASE("guard: an estimator that breaks its contract is named") {
    const std::string threw = "an exception came through the C table: boom";
    const char* const first_scan = "tracker (tracker.point_target), receive scans at 0 s";
    const auto one = GENERATE_COPY(values<Case>({
        {"throws", "init", first_scan, estimator + "init: " + threw},
        {"throws", "predict", second_scan, estimator + "predict: " + threw},
        {"throws", "project", second_scan, estimator + "project: " + threw},
        {"throws", "update", second_scan, estimator + "update: " + threw},
        {"beyond", "predict", second_scan, estimator + "predict: it wrote outside out, which is 42 x 1 x 1"},
        {"input", "update", second_scan, estimator + "update: it changed its input measurement"},
        {"nan", "project", second_scan,
         estimator + "project, item 0: covariance is nan, expected a finite number (row 0, column 0)"},
    }));
    CAPTURE(one.fault, one.in);
    const TemporaryFolder folder;
    ZooConfig config;
    config.outer = "org.example.estimator.zoo, with: {fault: " + std::string(one.fault) + ", call: " + one.in + "}";
    const Ended ended = run_zoo(folder, config);
    CAPTURE(ended.err);
    check_told(folder, ended, one.place, one.line);
}

TEST_CASE("guard: a partitioner that breaks its contract is named") {
    const std::string split = "cells.partitioner (org.example.partitioner.zoo), split: ";
    const auto [fault, line] = GENERATE_COPY(table<std::string, std::string>({
        {"over_capacity", "it answers 2 members, the buffer holds 1"},
        {"no_capacity",
         "it answered PLR_E_CAPACITY, but the 1 alternatives, 1 cells and 1 members that it asks for were given"},
        {"left_out", "point 0 is in no cell of alternative 0"},
        {"out_of_range", "member_points[0] is 1, there are points 0 to 0"},
        {"descending", "cell_offsets[1] is -1, less than cell_offsets[0], which is 0"},
        {"prediction", "cell_predictions[0] is 5, expected -1 to -1"},
        {"throws", "an exception came through the C table: boom"},
    }));
    CAPTURE(fault);
    const TemporaryFolder folder;
    ZooConfig config;
    config.further =
        "  cells:\n    use: org.example.analyzer.zoo_cells\n    in: {scans: world.scans}\n    parts: {partitioner: "
        "{use: org.example.partitioner.zoo, with: {fault: " +
        fault + "}}}\n";
    const Ended ended = run_zoo(folder, config);
    CAPTURE(ended.err);
    check_told(folder, ended, "cells (org.example.analyzer.zoo_cells), receive scans at 0 s", split + line);
}

TEST_CASE("guard: a stage that changes its message, answers no status or throws is named") {
    const auto [fault, in, line] = GENERATE(table<std::string, std::string, std::string>({
        {"input", "receive",
         "receive scans at 0 s: changed the message that it received; messages are shared by all receivers, "
         "and not to be written"},
        {"status", "receive", "receive scans at 0 s: answered status 7, expected PLR_OK or PLR_E_... (0 or -1 to -13)"},
        {"throws", "receive", "receive scans at 0 s: boom"},
        {"throws", "finish", "finish at 39 s: boom"},
    }));
    CAPTURE(fault, in);
    const TemporaryFolder folder;
    ZooConfig config;
    config.further =
        "  zoo:\n    use: org.example.analyzer.zoo\n    in: {scans: world.scans}\n    with: {fault: " + fault +
        ", call: " + in + "}\n";
    const Ended ended = run_zoo(folder, config);
    CAPTURE(ended.err);
    CHECK(ended.exit == 1);
    CHECK(first_line(ended.err) == "pelorus: node zoo (org.example.analyzer.zoo), " + line);
    CHECK(folder.has("out/summary.json"));
    CHECK(folder.has("out/truth.csv"));
}

TEST_CASE("guard: well-behaved models give the same bytes in every mode") {
    std::vector<std::string> results;
    for (const std::string mode : {"off", "start", "all"}) {
        const TemporaryFolder folder;
        ZooConfig config;
        config.motion = zoo_part("motion", "none", "propagate");
        config.sensor = zoo_part("sensor", "none", "measure");
        config.outer = "org.example.estimator.zoo";
        config.further =
            "  cells:\n    use: org.example.analyzer.zoo_cells\n    in: {scans: world.scans}\n    parts: {partitioner: "
            "{use: org.example.partitioner.zoo}}\n";
        const Ended ended = run_zoo(folder, config, {"--guard", mode});
        CAPTURE(mode, ended.err);
        REQUIRE(ended.exit == 0);
        results.push_back(folder.read("out/summary.json") + folder.read("out/truth.csv"));
    }
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
}

TEST_CASE("guard: an item that has no result and is flagged as failed is no fault") {
    const TemporaryFolder folder;
    ZooConfig config;
    config.motion = zoo_part("motion", "fails_one", "propagate");
    const Ended ended = run_zoo(folder, config, {"--guard", "all"});
    CAPTURE(ended.err);
    CHECK(ended.exit == 0);
    // The tracker goes on without the item, and says where the failure comes from.
    CHECK_THAT(ended.err, Contains("tracker.estimator.motion (org.example.motion.zoo), propagate: "));
    CHECK(count(ended.err, "(org.example.motion.zoo)") == 1);
}

TEST_CASE("guard: off hands out the plugins' own tables, and a wrong mode is refused") {
    const TemporaryFolder folder;
    ZooConfig config;
    config.motion = zoo_part("motion", "unflagged", "propagate");
    CHECK(run_zoo(folder, config, {"--guard", "off"}).exit == 0);
    const Ended refused = run_zoo(folder, config, {"--guard", "of"});
    CHECK(refused.exit == 2);
    CHECK(refused.err == "pelorus: --guard: expected one of off, start, all, got 'of'; did you mean 'off'?\n");
}
