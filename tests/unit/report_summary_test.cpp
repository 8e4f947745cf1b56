#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include <pelorus/abi/abi.h>
#include <pelorus/abi/consistency.h>

#include "report/json_file.hpp"
#include "report/summary.hpp"
#include "report/terminal_table.hpp"

using namespace pelorus;
using nlohmann::ordered_json;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A table of three times with errors, one unknown, and a word; a scalar of the errors and two of their own.
runtime::Results results() {
    runtime::Table table;
    table.node = "errors";
    table.name = "by_time";
    table.columns = {{"time", "s", PLR_REDUCE_KEY, 0, {}},
                     {"error", "m", PLR_REDUCE_ROOT_MEAN_SQUARE, 0, {}},
                     {"phase", "", PLR_REDUCE_KEY, 0, {"straight", "turn \"left\""}}};
    table.rows = {0, -1, 0, 0.1, not_a_number, 1, 0.2, 4, 0};
    runtime::Scalar rmse{"rmse", "m", 0, not_a_number, 0, "error", 1},
        bias{"bias", "m", PLR_REDUCE_MEAN, -0.25, 0, "", 1};
    runtime::Scalar lost{"lost", "1", PLR_REDUCE_MEAN, not_a_number, 0, "", 1};
    table.scalars = {rmse, bias, lost};
    runtime::Table scalars_only;
    scalars_only.node = "identity";
    scalars_only.scalars = {{"switches", "1", PLR_REDUCE_SUM, 3, 0, "", 1}};
    return {{table, scalars_only}};
}

}  // namespace

TEST_CASE("summary.json has the shape that readers rely on", "[report]") {
    const ordered_json expected = ordered_json::parse(R"({"cells": [{
        "variant": "default", "sweep": {}, "runs": 1,
        "scalars": {
            "errors.rmse": {"value": 2.5, "unit": "m", "ci95": null, "non_finite": 1},
            "errors.bias": {"value": -0.25, "unit": "m", "ci95": null},
            "errors.lost": {"value": null, "unit": "1", "ci95": null, "non_finite": 1},
            "identity.switches": {"value": 3.0, "unit": "1", "ci95": null}},
        "tables": {"errors.by_time": {
            "columns": [{"name": "time", "unit": "s"}, {"name": "error", "unit": "m"}, {"name": "phase", "unit": ""}],
            "rows": [[0.0, 1.0, "straight"], [0.1, null, "turn \"left\""], [0.2, 4.0, "straight"]],
            "non_finite": 1}}}]})");
    const ordered_json document = report::summary({report::cell_of_run(results())});
    CHECK(document == expected);
    CHECK(document.dump() == expected.dump());  // the order of keys, too
}

TEST_CASE("a run without results is a cell without any", "[report]") {
    CHECK(report::summary({report::cell_of_run({})}).dump() ==
          R"({"cells":[{"variant":"default","sweep":{},"runs":1,"scalars":{},"tables":{}}]})");
}

TEST_CASE("the reductions of a single run", "[report]") {
    CHECK(report::reduce_one(-3, PLR_REDUCE_ROOT_MEAN_SQUARE) == 3);
    for (const std::uint32_t reduce : {PLR_REDUCE_KEY, PLR_REDUCE_MEAN, PLR_REDUCE_SUM, PLR_REDUCE_MIN, PLR_REDUCE_MAX,
                                       PLR_REDUCE_QUANTILE, PLR_REDUCE_FIRST_RUN})
        CHECK(report::reduce_one(-3, reduce) == -3);
    CHECK(report::reduce_one(10, PLR_REDUCE_CHI_SQUARE, 0.975) == Approx(2.04832).epsilon(1e-5));  // tables: 20.4832
    CHECK(std::isnan(report::reduce_one(0, PLR_REDUCE_CHI_SQUARE, 0.975)));
    CHECK(report::reduce_one(-3, PLR_REDUCE_COUNT) == 1);
    CHECK(report::reduce_one(not_a_number, PLR_REDUCE_COUNT) == 0);
    CHECK(std::isnan(report::reduce_one(not_a_number, PLR_REDUCE_MEAN)));
}

TEST_CASE("numbers read back to the same double, in as few digits as that takes", "[report]") {
    const std::vector<double> numbers = {0.1, 1.0 / 3, 1e300, 5e-324, -2.36, 123456789.125, std::nextafter(1.0, 2.0)};
    const std::string text = report::json_text(ordered_json(numbers));
    CHECK(ordered_json::parse(text).get<std::vector<double>>() == numbers);
    CHECK_THAT(
        text, Catch::StartsWith("[0.1, 0.3333333333333333, 1e+300, 5e-324, -2.36, 123456789.125, 1.0000000000000002]"));
}

TEST_CASE("documents are laid out one row a line", "[report]") {
    const ordered_json document = ordered_json::parse(
        R"({"a": {"value": 1, "unit": "m"}, "rows": [[1, null], ["x", 2.5]], "empty": {}, "flat": [1, 2]})");
    CHECK(report::json_text(document) ==
          "{\n"
          "  \"a\": {\"value\": 1, \"unit\": \"m\"},\n"
          "  \"rows\": [\n"
          "    [1, null],\n"
          "    [\"x\", 2.5]\n"
          "  ],\n"
          "  \"empty\": {},\n"
          "  \"flat\": [1, 2]\n"
          "}\n");
    CHECK(ordered_json::parse(report::json_text(document)) == document);
}

TEST_CASE("text that is not UTF-8 does not spoil a document", "[report]") {
    CHECK_NOTHROW(ordered_json::parse(report::json_text(ordered_json{{"unit", "\xff\xfe"}})));
}

TEST_CASE("the table on the terminal is aligned, with units and five significant digits", "[report]") {
    CHECK(report::terminal_table({report::cell_of_run(results())}) ==
          "errors.rmse          2.5  m  (1 not finite, left out)\n"
          "errors.bias        -0.25  m\n"
          "errors.lost            -  1  (1 not finite, left out)\n"
          "identity.switches      3  1\n"
          "tables: errors.by_time (3 rows)\n");
    report::Cell one, two;
    one.scalars = {{"errors.position_rmse", "m", 2.3612345, 0.0312, 0}, {"errors.spin", "°/s", 1234567, {}, 0}};
    two.variant = "koch";
    two.sweep["world.noise"] = 5.0;
    two.runs = 200;
    CHECK(report::terminal_table({one, two}) ==
          "default (1 run)\n"
          "errors.position_rmse      2.3612  m    +- 0.0312\n"
          "errors.spin           1.2346e+06  °/s\n"
          "\nkoch, world.noise = 5.0 (200 runs)\n");
    CHECK(report::terminal_table({report::Cell{}}).empty());
}
