// `pelorus report` and `pelorus compare`: what is in the page, and what is not.
#include <filesystem>
#include <regex>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"
#include "../support/small_campaign.hpp"

using namespace pelorus::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

Ended in(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
    ProcessOptions options;
    options.folder = folder.path();
    return pelorus_command(arguments, options);
}

void must(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
    const Ended ended = in(folder, arguments);
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
}

/// The JSON of a data block; null where the page has none.
Json block(const std::string& page, const std::string& id) {
    const std::string begin = "<script type=\"application/json\" id=\"" + id + "\">";
    const std::size_t at = page.find(begin);
    if (at == std::string::npos) return nullptr;
    return Json::parse(page.substr(at + begin.size(), page.find("</script>", at) - at - begin.size()));
}

/// The page without the library, whose code names places that it is never asked to load.
std::string without_library(const std::string& page) {
    const std::size_t begin = page.find("<script>\n"), end = page.find("</script>", begin);
    return page.substr(0, begin) + page.substr(end);
}

const char* const expected = R"(expected: 1
config: c.yaml
band: {reproduced: 0.9}
cells:
  - variant: calm
    sweep: {world.sensors.radar.noise: 5}
    scalars: {errors.position_rmse: {published: 5, reproduced: 5}, errors.velocity_rmse: {limit: 0.001}}
)";

TemporaryFolder& campaign() {
    static TemporaryFolder folder;
    static const bool is_made = [] {
        folder.write("c.yaml", small_campaign);
        folder.write("c.expected.yaml", expected);
        must(folder, {"run", "c.yaml", "--out", "out"});
        return true;
    }();
    static_cast<void>(is_made);
    return folder;
}

std::string page_of(const TemporaryFolder& folder, const std::string& result) {
    must(folder, {"report", result, "--out", "page.html"});
    return folder.read("page.html");
}

}  // namespace

TEST_CASE("a report holds the whole summary, and what it was made from") {
    const std::string page = page_of(campaign(), "out");
    CHECK(block(page, "summary") == Json::parse(campaign().read("out/summary.json")));
    CHECK(block(page, "provenance") == Json::parse(campaign().read("out/provenance.json")));
    CHECK(block(page, "page")["title"] == "an aircraft");
    REQUIRE(block(page, "samples").size() == 4);
    CHECK(block(page, "samples")[0]["errors.track_count"].size() == 8);
    const Json scene = block(page, "scene");
    REQUIRE(scene.size() == 3);
    CHECK(scene[0]["kind"] == "scans");
    CHECK(scene[1]["kind"] == "tracks");
    CHECK(scene[2]["kind"] == "truth");
    CHECK(scene[2]["position"][0][0] == -3000);
    CHECK(scene[2]["time"].size() == 20);
}

TEST_CASE("tables of groups are told from those of tracks, with their lineage") {
    const TemporaryFolder folder;
    must(folder, {"run", PELORUS_SOURCE_DIR "/configs/crossing_clouds.yaml", "--out", "out"});
    const std::string page = page_of(folder, "out");
    const Json scene = block(page, "scene");
    REQUIRE(scene.size() == 3);
    CHECK(scene[0]["name"] == "groups.csv");
    CHECK(scene[0]["kind"] == "groups");
    CHECK(scene[0]["extent"].size() == 3);
    CHECK(scene[1]["kind"] == "tracks");
    CHECK(scene[1]["lineage"].is_null());
    CHECK(scene[2]["kind"] == "truth");
    const Json lineage = scene[0]["lineage"];
    REQUIRE(lineage.size() == 2);
    CHECK(lineage[0]["id"] == "1");
    CHECK(lineage[0]["spans"].size() == 1);
    CHECK(lineage[0]["parents"][0][0] == "2");
    CHECK(lineage[1]["spans"].size() == 2);
    CHECK(lineage[1]["spans"][1][1] == 180);
}

TEST_CASE("a report loads nothing, and forbids it") {
    const std::string page = without_library(page_of(campaign(), "out"));
    CHECK_THAT(page, Contains("default-src 'none'"));
    const std::regex loads(
        R"re((src|href|action)\s*=\s*["']?(https?:)?//|url\(\s*["']?https?:|@import|fetch\(|XMLHttpRequest)re");
    CHECK_FALSE(std::regex_search(page, loads));
    for (const char* landmark : {"<main id=\"main\"", "<nav id=\"contents\" aria-label", "<header", "<footer",
                                 "lang=\"en\"", "name=\"viewport\""})
        CHECK_THAT(page, Contains(landmark));
}

TEST_CASE("what a config calls itself is text on the page, whatever it looks like") {
    const TemporaryFolder folder;
    std::string config = small_campaign;
    config.replace(config.find("an aircraft"), 11, "'</title></script><script>alert(1)</script><!-- & @DATA@'");
    folder.write("c.yaml", config);
    must(folder, {"run", "c.yaml", "--run", "0", "--out", "out"});
    const std::string page = page_of(folder, "out");
    CHECK(count(page, "alert(1)") == 4);  // the title, and JSON of page and provenance, there with the config
    CHECK(count(page, "<script>alert") == 0);
    CHECK_THAT(page, Contains("<title>&lt;/title&gt;&lt;/script&gt;&lt;script&gt;alert(1)"));
    CHECK(block(page, "page")["title"] == "</title></script><script>alert(1)</script><!-- & @DATA@");
    CHECK(block(page, "summary")["cells"].size() == 1);
}

TEST_CASE("expected figures are copied into the result folder, printed and shown") {
    const Ended ended = in(campaign(), {"run", "c.yaml", "--out", "out", "--json"});
    REQUIRE(ended.exit == 0);
    const Json told = Json::parse(ended.out)["expected"];
    CHECK(told["judged"] == 2);
    CHECK(told["outside"] == 1);
    CHECK(campaign().read("out/expected.yaml") == expected);
    CHECK(block(page_of(campaign(), "out"), "beside") == told);
    CHECK_THAT(in(campaign(), {"run", "c.yaml", "--out", "out"}).out,
               Contains("1 of 2 figures keep within their bands and limits"));
}

TEST_CASE("expected figures are left aside when the config is made another one") {
    const Ended ended = in(campaign(), {"run", "c.yaml", "--out", "other", "--runs", "2", "--set", "world.scans=10"});
    CHECK(ended.exit == 0);
    CHECK_THAT(ended.err, Contains("the figures of c.expected.yaml are left aside"));
    CHECK_FALSE(campaign().has("other/expected.yaml"));
}

TEST_CASE("a report makes do with a summary alone, and with values that are not finite") {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path() / "out");
    const std::string summary =
        R"({"cells": [{"variant": "default", "sweep": {}, "runs": 1, "scalars": {"a.b": {"value": null, "unit": "", "ci95": null, "non_finite": 1}}, "tables": {}}]})";
    folder.write("out/summary.json", summary);
    const std::string page = page_of(folder, "out");
    CHECK(block(page, "summary") == Json::parse(summary));
    CHECK(block(page, "provenance").is_null());
    CHECK(block(page, "page")["title"] == "out");
    CHECK(block(page, "page")["notes"].size() == 2);
}

TEST_CASE("a comparison of two variants pairs their runs as the campaign does") {
    must(campaign(), {"run", "c.yaml", "--variant", "calm", "--out", "calm"});
    must(campaign(), {"run", "c.yaml", "--variant", "lively", "--out", "lively"});
    const Ended ended = in(campaign(), {"compare", "calm", "lively", "--json", "--html", "both.html"});
    REQUIRE(ended.exit == 0);
    const Json told = Json::parse(ended.out), summary = Json::parse(campaign().read("out/summary.json"));
    CHECK(told["paired"] == true);
    REQUIRE(told["cells"].size() == 2);
    for (std::size_t point = 0; point < 2; ++point) {
        const Json& joint = summary["cells"][2 + point];
        REQUIRE(joint["variant"] == "lively");
        for (const auto& [name, scalar] : told["cells"][point]["scalars"].items()) {
            INFO(name);
            CHECK(scalar["b"] == joint["scalars"][name]["value"]);
            CHECK(scalar["difference"] == joint["paired"]["scalars"][name]["difference"]);
            CHECK(scalar["ci95"] == joint["paired"]["scalars"][name]["ci95"]);
        }
    }
    CHECK(told["only_a"].empty());
    CHECK(block(campaign().read("both.html"), "compare") == told);
}

TEST_CASE("a comparison says what is not in common, and does not pair runs of other seeds") {
    must(campaign(), {"run", "c.yaml", "--seed", "8", "--out", "eight", "--set", "world.sensors.radar.noise=5m",
                      "--set", "files=~"});
    const Ended ended = in(campaign(), {"compare", "out", "eight"});
    CHECK(ended.exit == 0);
    CHECK_THAT(ended.out, Contains("other seed or runs") && Contains("no cell in common") &&
                              Contains("only in A\n  calm, world.sensors.radar.noise = 5.0\n") &&
                              Contains("only in B\n  calm\n  lively\n"));
    must(campaign(), {"run", "c.yaml", "--seed", "9", "--out", "nine"});
    const Json told = Json::parse(in(campaign(), {"compare", "out", "nine", "--json"}).out);
    const Json scalar = told["cells"][0]["scalars"]["errors.position_rmse"];
    const Json a = Json::parse(campaign().read("out/summary.json"))["cells"][0]["scalars"]["errors.position_rmse"],
               b = Json::parse(campaign().read("nine/summary.json"))["cells"][0]["scalars"]["errors.position_rmse"];
    CHECK(told["paired"] == false);
    CHECK(scalar["ci95"].get<double>() == Approx(std::hypot(a["ci95"].get<double>(), b["ci95"].get<double>())));
}
