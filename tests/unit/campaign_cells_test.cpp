// The cells of a campaign: order, overrides, what the command line changes.
#include <catch2/catch.hpp>

#include "campaign/cells.hpp"

using namespace pelorus;
using campaign::Cell;
using campaign::Plan;
using campaign::Selection;

namespace {

constexpr const char* grid = R"(
campaign:
  runs: 7
  sweep:
    world.noise: [1 m, 2 m]
    count: {world.count: [3, 4, 5], tracker.count: [30, 40, 50]}
  variants:
    slow: {}
    fast: {tracker.mode: fast}
)";

graph::Document document(const std::string& campaign, const std::vector<graph::Override>& overrides = {}) {
    return graph::Document::parse("pelorus: 1\ngraph: {world: {use: source.fake}}\n" + campaign, "test.yaml", ".",
                                  overrides);
}

Plan planned(const std::string& campaign, const Selection& selection = {},
             const std::vector<graph::Override>& overrides = {}) {
    graph::Problems problems;
    Plan plan = campaign::plan_cells(document(campaign, overrides), selection, problems);
    problems.raise();
    return plan;
}

std::vector<std::string> texts(const Plan& plan) {
    std::vector<std::string> found;
    for (const Cell& cell : plan.cells) found.push_back(campaign::cell_text(cell));
    return found;
}

std::string problem_of(const std::string& campaign, const Selection& selection = {}) {
    graph::Problems problems;
    campaign::plan_cells(document(campaign), selection, problems);
    REQUIRE(problems.count() == 1);
    return problems.items().front().where.text() + ": " + problems.items().front().text;
}

}  // namespace

TEST_CASE("Cells come out variants first, then axes in file order, the last one fastest", "[campaign]") {
    const Plan plan = planned(grid);
    CHECK(plan.runs == 7);
    CHECK(plan.reference == "slow");
    CHECK_FALSE(plan.goes_on);
    CHECK(texts(plan) ==
          std::vector<std::string>{"variant slow, world.noise = 1 m, world.count = 3, tracker.count = 30",
                                   "variant slow, world.noise = 1 m, world.count = 4, tracker.count = 40",
                                   "variant slow, world.noise = 1 m, world.count = 5, tracker.count = 50",
                                   "variant slow, world.noise = 2 m, world.count = 3, tracker.count = 30",
                                   "variant slow, world.noise = 2 m, world.count = 4, tracker.count = 40",
                                   "variant slow, world.noise = 2 m, world.count = 5, tracker.count = 50",
                                   "variant fast, world.noise = 1 m, world.count = 3, tracker.count = 30",
                                   "variant fast, world.noise = 1 m, world.count = 4, tracker.count = 40",
                                   "variant fast, world.noise = 1 m, world.count = 5, tracker.count = 50",
                                   "variant fast, world.noise = 2 m, world.count = 3, tracker.count = 30",
                                   "variant fast, world.noise = 2 m, world.count = 4, tracker.count = 40",
                                   "variant fast, world.noise = 2 m, world.count = 5, tracker.count = 50"});
    for (std::size_t i = 0; i < plan.cells.size(); ++i) CHECK(plan.cells[i].index == i);
}

TEST_CASE("A config without a campaign is one cell, run once", "[campaign]") {
    const Plan plan = planned("");
    CHECK(plan.is_single_run());
    CHECK(texts(plan) == std::vector<std::string>{"variant default"});
    CHECK_FALSE(planned("", {{}, 5}).is_single_run());
}

TEST_CASE("An override of any address of an axis removes the axis", "[campaign]") {
    const std::vector<std::string> noises{"variant slow, world.noise = 1 m", "variant slow, world.noise = 2 m"};
    CHECK(texts(planned(grid, {{"slow"}, {}}, {{"tracker.count", "8"}})) == noises);
    CHECK(texts(planned(grid, {{"slow"}, {}}, {{"tracker", "{use: tracker.fake}"}})) == noises);
    CHECK(planned(grid, {{"slow"}, {}}, {{"tracker.cou", "8"}}).cells.size() == 6);
    CHECK(texts(planned(grid, {{"slow"}, {}}, {{"tracker.count", "8"}, {"world.noise", "1"}})) ==
          std::vector<std::string>{"variant slow"});
}

TEST_CASE("A variant that overrides an address of an axis has no such axis", "[campaign]") {
    const Plan plan = planned("campaign:\n  sweep: {a.b: [1, 2]}\n  variants: {x: {}, y: {a.b: 9}}\n");
    CHECK(texts(plan) == std::vector<std::string>{"variant x, a.b = 1", "variant x, a.b = 2", "variant y"});
}

TEST_CASE("A sweep is laid on the file, a variant on the sweep, the command line on both", "[campaign]") {
    const std::string text = "campaign:\n  sweep: {a.x: [1]}\n  variants: {v: {a.y: 2}}\n";
    const graph::Document base = document(text, {{"a.z", "3"}});
    graph::Problems problems;
    const Plan plan = campaign::plan_cells(base, {}, problems);
    const graph::Document made = campaign::document_of(base, plan.cells[0]);
    std::vector<std::string> order;
    for (const graph::Assignment& each : made.overrides()) order.push_back(each.address);
    CHECK(order == std::vector<std::string>{"a.x", "a.y", "a.z"});
}

TEST_CASE("Variants that are named are taken in file order, and the first of them is the reference", "[campaign]") {
    const Plan both = planned(grid, {{"fast", "slow"}, 3});
    CHECK(both.runs == 3);
    CHECK(both.cells.front().variant == "slow");
    const Plan one = planned(grid, {{"fast"}, {}});
    CHECK(one.cells.size() == 6);
    CHECK(one.reference == "fast");
    CHECK(planned("campaign: {variants: {a: {}, b: {}}, reference: b, on_failure: continue}").reference == "b");
    CHECK(planned("campaign: {variants: {a: {}, b: {}}, reference: b, on_failure: continue}").goes_on);
}

TEST_CASE("What is wrong with a campaign is told with its place", "[campaign]") {
    CHECK(problem_of(grid, {{"fsat"}, {}}) ==
          "--variant fsat: there is no variant 'fsat'; did you mean 'fast'? variants: slow, fast");
    CHECK(problem_of("campaign: {variants: {a: {}}, reference: c}") ==
          "test.yaml:3:42: campaign.reference: there is no variant 'c'; variants: a");
    CHECK(problem_of("campaign: {on_failure: stopp}") ==
          "test.yaml:3:24: campaign.on_failure: expected one of stop, continue, got 'stopp'; did you mean 'stop'?");
    CHECK(problem_of("campaign: {sweep: {a.b: [1], c: {a.b: [2]}}}") ==
          "test.yaml:3:34: campaign.sweep: a.b stands in two axes");
    CHECK(problem_of("campaign: {variants: {-a: {}}}") ==
          "test.yaml:3:23: campaign.variants: '-a' cannot name a variant: letters, digits, _, -, + and . only, no - "
          "first");
    std::string axes;
    for (int axis = 0; axis < 7; ++axis)
        axes += (axis == 0 ? "" : ", ") + std::string(1, static_cast<char>('a' + axis)) + ".x: [1,2,3,4,5,6,7,8,9,0]";
    CHECK(problem_of("campaign: {sweep: {" + axes + "}}") ==
          "test.yaml:3:11: campaign: more than 1000000 variants and grid points");
}

TEST_CASE("A value is found in a resolved config by its address", "[campaign]") {
    const auto resolved = nlohmann::ordered_json::parse(R"({"run": {"seed": 7}, "graph": {"world": {"use": "source.x",
        "with": {"period": 2.0}, "parts": {"sensors": {"radar": {"use": "sensor.y", "with": {"noise": [1.5]}}},
        "motion": {"use": "motion.z", "with": {"q": 3}}}}}})");
    CHECK(campaign::value_at(resolved, "run.seed") == 7);
    CHECK(campaign::value_at(resolved, "world.period") == 2.0);
    CHECK(campaign::value_at(resolved, "world.use") == "source.x");
    CHECK(campaign::value_at(resolved, "world.sensors.radar.noise")[0] == 1.5);
    CHECK(campaign::value_at(resolved, "world.motion.q") == 3);
    CHECK(campaign::value_at(resolved, "world.motion.r").is_null());
    CHECK(campaign::value_at(resolved, "elsewhere.x").is_null());
}
