// The printed figures of a campaign.
#include <catch2/catch.hpp>

#include "report/campaign_table.hpp"

using pelorus::report::campaign_table;
using Json = nlohmann::ordered_json;

namespace {

Json cell(const std::string& variant, const Json& sweep, double value) {
    return {{"variant", variant},
            {"sweep", sweep},
            {"runs", 20},
            {"scalars", {{"errors.rmse", {{"value", value}, {"unit", "m"}, {"ci95", 0.01234}}}}}};
}

}  // namespace

TEST_CASE("A line is a variant and a column a grid point", "[report]") {
    Json summary{{"cells", Json::array()}};
    for (const std::string variant : {"published", "best"})
        for (const double noise : {0.2, 1.0})
            for (const int count : {10, 22})
                summary["cells"].push_back(
                    cell(variant, {{"world.noise", noise}, {"world.count", count}}, noise * count / 7));
    CHECK(campaign_table(summary) ==
          "8 cells of 20 runs\n"
          "\n"
          "errors.rmse [m]\n"
          "  world.noise     0.2     0.2      1      1\n"
          "  world.count      10      22     10     22\n"
          "  published    0.2857  0.6286  1.429  3.143\n"
          "  best         0.2857  0.6286  1.429  3.143\n"
          "\n");
}

TEST_CASE("Few grid points leave room for intervals, and what has no value is a dash", "[report]") {
    Json summary{{"cells", {cell("a", Json::object(), 1.5), cell("b", Json::object(), 2.5)}}};
    summary["cells"][1]["scalars"]["errors.rmse"]["ci95"] = nullptr;
    summary["cells"][1]["scalars"]["luck"] = {{"value", nullptr}, {"unit", ""}, {"ci95", nullptr}};
    summary["cells"][1]["failed"] = 3;
    CHECK(campaign_table(summary) ==
          "2 cells of 20 runs, 3 failed\n"
          "\n"
          "errors.rmse [m]\n"
          "  a  1.5 +- 0.012\n"
          "  b           2.5\n"
          "\n"
          "luck\n"
          "\n");
}

TEST_CASE("A grid that is wider than a line goes on below", "[report]") {
    Json summary{{"cells", Json::array()}};
    for (int point = 0; point < 40; ++point) summary["cells"].push_back(cell("a", {{"world.count", point}}, 1e-4 / 3));
    const std::string text = campaign_table(summary);
    std::size_t lines = 0, from = 0;
    for (std::size_t to = text.find('\n'); to != std::string::npos; from = to + 1, to = text.find('\n', from)) {
        CHECK(to - from <= 118);
        ++lines;
    }
    CHECK(lines > 8);
    CHECK(text.find("39\n") != std::string::npos);
}
