// Expected figures: the file's form, the comparison, the printed table.
#include <catch2/catch.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "host/error.hpp"
#include "report/expected.hpp"
#include "report/expected_table.hpp"

using namespace pelorus;
using pelorus::test::TemporaryFolder;
using Json = nlohmann::ordered_json;

namespace {

Json figures_of(const std::string& text) {
    const TemporaryFolder folder;
    return report::read_expected(folder.write("a.expected.yaml", text))->figures;
}

/// What is wrong, `LINE:COLUMN: TEXT`.
std::vector<std::string> problems_of(const std::string& text) {
    std::vector<std::string> problems;
    try {
        figures_of(text);
    } catch (const ConfigError& error) {
        for (const auto& item : error.items())
            problems.push_back(std::to_string(item.where.line) + ":" + std::to_string(item.where.column) + ": " +
                               item.text);
    }
    return problems;
}

const std::string good = R"(expected: 1
config: a.yaml
band: {reproduced: 0.1}
cells:
  - variant: one
    sweep: {world.radar.noise: 1, world.count: 10}
    scalars:
      errors.rmse: {published: 2, reproduced: 2.2}
      shape.angle: {limit: 3}
  - variant: two
    sweep: {world.radar.noise: 1, world.count: 10}
    scalars: {errors.rmse: {reproduced: 4}}
  - variant: three
    scalars: {errors.rmse: {reproduced: 4}}
)";

Json scalar(const Json& value) { return {{"value", value}, {"unit", "m"}, {"ci95", nullptr}}; }

Json summary() {
    const Json sweep{{"world.radar.noise", 1.0}, {"world.count", 10}};
    return {{"cells",
             {{{"variant", "one"},
               {"sweep", sweep},
               {"runs", 1},
               {"scalars", {{"errors.rmse", scalar(2.3)}, {"shape.angle", scalar(3.5)}}}},
              {{"variant", "two"}, {"sweep", sweep}, {"runs", 1}, {"scalars", {{"errors.rmse", scalar(nullptr)}}}},
              {{"variant", "two"},
               {"sweep", {{"world.radar.noise", 5.0}, {"world.count", 10}}},
               {"runs", 1},
               {"scalars", {{"errors.rmse", scalar(4)}}}}}}};
}

}  // namespace

TEST_CASE("the expected figures of a config lie beside it", "[report]") {
    CHECK(report::expected_file_of("configs/airship.yaml") == "configs/airship.expected.yaml");
    CHECK_FALSE(report::read_expected("/nonexistent/a.expected.yaml"));
}

TEST_CASE("a value is held to bands and limits, and has its relative deviation", "[report]") {
    const Json beside = report::beside_expected(summary(), figures_of(good));
    REQUIRE(beside.at("figures").size() == 3);
    const Json& rmse = beside["figures"][0];
    CHECK(rmse["scalar"] == "errors.rmse");
    CHECK(rmse["expected"][0]["kind"] == "published");
    CHECK(rmse["expected"][0]["deviation"].get<double>() == Approx(0.15));
    CHECK(rmse["expected"][0]["within"].is_null());  // no band is stated
    CHECK(rmse["expected"][1]["deviation"].get<double>() == Approx(0.1 / 2.2));
    CHECK(rmse["expected"][1]["within"] == true);
    CHECK(beside["figures"][1]["expected"][0]["within"] == false);  // above the limit
    CHECK(beside["figures"][2]["variant"] == "two");
    CHECK(beside["figures"][2]["expected"][0]["within"] == false);  // no value keeps to nothing
    CHECK(beside["judged"] == 3);
    CHECK(beside["outside"] == 2);
}

TEST_CASE("a band is as much wider as figures are rounded", "[report]") {
    std::string text = good;
    text.replace(text.find("band: {reproduced: 0.1}"), 23, "band: {reproduced: 0.01}");
    CHECK(report::beside_expected(summary(), figures_of(text))["figures"][0]["expected"][1]["within"] == false);
    text.replace(text.find("band: {reproduced: 0.01}"), 24, "band: {reproduced: 0.01, rounding: 0.1}");
    CHECK(report::beside_expected(summary(), figures_of(text))["figures"][0]["expected"][1]["within"] == true);
}

TEST_CASE("values and what was expected of them stand beside each other", "[report]") {
    const std::string text = report::expected_table(report::beside_expected(summary(), figures_of(good)));
    CHECK(text ==
          "beside what is expected\n"
          "                         errors.rmse [m]\n"
          "  variant  noise  count  value   published  reproduced\n"
          "  one          1     10  2.3             2         2.2\n"
          "  two          1     10  -*                          4\n"
          "\n"
          "                         shape.angle [m]\n"
          "  variant  noise  count  value   limit\n"
          "  one          1     10  3.5*        3\n"
          "\n"
          "1 of 3 figures keep within their bands and limits; those that do not are marked *\n"
          "\n");
    CHECK(report::expected_table(report::beside_expected({{"cells", Json::array()}}, figures_of(good))).empty());
}

TEST_CASE("all that is wrong with expected figures is told with its place", "[report]") {
    CHECK(problems_of("expected: 2\ncells: []\n").at(0).rfind("1:11: expected: 1 is the version", 0) == 0);
    CHECK(problems_of("expected: 1\n").at(0).rfind("1:1: cells: expected a list", 0) == 0);
    CHECK(problems_of("[1, 2]\n").at(0).rfind("1:1: expected a map with expected, config, band, cells", 0) == 0);
    const auto problems = problems_of(R"(expected: 1
band: {limit: 0.1}
cells:
  - variant: one
    sweeep: {}
    scalars: {errors.rmse: {published: 2 m}, shape.angle: 3}
  - variant: [one]
    sweep: {world.noise: [1]}
  - five
)");
    REQUIRE(problems.size() == 8);
    CHECK(problems[0].rfind("2:8: band: unknown key 'limit'", 0) == 0);
    CHECK(problems[1].rfind("5:5: cells[0]: unknown key 'sweeep'; did you mean 'sweep'?", 0) == 0);
    CHECK(problems[2] == "6:40: cells[0].scalars.errors.rmse.published: expected a number in SI units, got '2 m'");
    CHECK(problems[3].rfind("6:59: cells[0].scalars.shape.angle: expected a map with some of published", 0) == 0);
    CHECK(problems[4].rfind("7:14: cells[1].variant: expected the name of a variant, got a list", 0) == 0);
    CHECK(problems[5].rfind("8:26: cells[1].sweep.world.noise: expected a single value, got a list", 0) == 0);
    CHECK(problems[6].rfind("7:5: cells[1].scalars: expected a map", 0) == 0);
    CHECK(problems[7].rfind("9:5: cells[2]: expected a map with variant, sweep, scalars, got 'five'", 0) == 0);
}
