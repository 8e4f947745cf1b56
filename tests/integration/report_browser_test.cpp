// Pages of `pelorus report` and `pelorus compare` in a browser without a window; sanitizers see nothing of it.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <catch2/catch.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/picture.hpp"
#include "../support/process.hpp"
#include "../support/small_campaign.hpp"
#include "report/browser.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

/// Whether there is a browser; says so if not.
bool has_browser() {
    if (!pelorus::report::find_browser().empty()) return true;
    WARN("skipped: there is no chromium on the PATH");
    return false;
}

Ended browse(const TemporaryFolder& folder, std::vector<std::string> flags, const std::string& page) {
    std::vector<std::string> words{pelorus::report::find_browser().string(),
                                   "--headless",
                                   "--use-angle=swiftshader",
                                   "--enable-unsafe-swiftshader",
                                   "--disable-dev-shm-usage",
                                   "--no-first-run",
                                   "--hide-scrollbars",
                                   "--enable-logging=stderr",
                                   "--user-data-dir=" + (folder / "profile"),
                                   "--virtual-time-budget=30000"};
    if (::geteuid() == 0) words.emplace_back("--no-sandbox");
    words.insert(words.end(), flags.begin(), flags.end());
    words.push_back("file://" + (folder / page));
    return run(words);
}

/// What the page complains of on its console. That the library reads a canvas back is no complaint.
std::vector<std::string> complaints(const Ended& ended) {
    std::vector<std::string> found;
    std::istringstream lines(ended.err);
    for (std::string line; std::getline(lines, line);)
        if (line.find("CONSOLE") != std::string::npos && line.find("willReadFrequently") == std::string::npos)
            found.push_back(line);
    return found;
}

Picture screenshot(const TemporaryFolder& folder, const std::string& page, int width) {
    const std::string file = folder / "shot.png";
    std::filesystem::remove(file);
    const Ended ended =
        browse(folder, {"--window-size=" + std::to_string(width) + ",3000", "--screenshot=" + file}, page);
    INFO(ended.err);
    CHECK(complaints(ended) == std::vector<std::string>());
    REQUIRE(std::filesystem::exists(file));
    return read_png(file);
}

void must(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
    ProcessOptions options;
    options.folder = folder.path();
    const Ended ended = pelorus_command(arguments, options);
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
}

TemporaryFolder& result() {
    static TemporaryFolder folder;
    static const bool is_made = [] {
        folder.write("c.yaml", small_campaign);
        must(folder, {"run", "c.yaml", "--out", "out"});
        must(folder, {"report", "out", "--out", "page.html"});
        return true;
    }();
    static_cast<void>(is_made);
    return folder;
}

}  // namespace

TEST_CASE("a report is drawn on a phone and on a screen, dark and light, without a word of complaint",
          "[release-only]") {
    if (!has_browser()) return;
    for (const int width : {500, 1440})
        for (const std::string theme : {"dark", "light"}) {
            INFO(width << " " << theme);
            const Picture picture = screenshot(result(), "page.html#theme=" + theme, width);
            CHECK(picture.width == static_cast<std::size_t>(width));
            CHECK(picture.colours() > 200);
            if (theme == "dark")
                CHECK(picture.mean_brightness() < 80);
            else
                CHECK(picture.mean_brightness() > 200);
        }
}

TEST_CASE("a report has all of its sections, and the page says when it is drawn", "[release-only]") {
    if (!has_browser()) return;
    const std::string document = browse(result(), {"--dump-dom"}, "page.html").out;
    CHECK_THAT(document, Contains("data-ready=\"yes\""));
    for (const char* name : {"figures", "time", "scene", "distributions", "provenance"})
        CHECK_THAT(document, Contains("<section id=\"" + std::string(name) + "\" aria-labelledby"));
    CHECK_THAT(document, Contains("scope=\"row\"") && Contains("scope=\"col\"") && Contains("role=\"img\"") &&
                             Contains("aria-label=\"Scene."));
    // A plot that could not be drawn leaves its element without a picture.
    CHECK(count(document, "class=\"main-svg\"") >= 4);
    CHECK_THAT(document, Contains("<canvas"));
}

TEST_CASE("groups are drawn with their lineage", "[release-only]") {
    if (!has_browser()) return;
    TemporaryFolder folder;
    must(folder, {"run", PELORUS_SOURCE_DIR "/configs/crossing_clouds.yaml", "--out", "out"});
    must(folder, {"report", "out", "--out", "page.html"});
    const std::string document = browse(folder, {"--dump-dom"}, "page.html").out;
    CHECK_THAT(document, Contains("data-ready=\"yes\""));
    CHECK_THAT(document, Contains("<section id=\"lineage\" aria-labelledby"));
    CHECK_THAT(document, Contains("aria-label=\"Lineage. 2 groups of groups.csv: 0 splits, 1 merger.\""));
    CHECK_THAT(document, Contains("10 objects, 10 tracks, 1 group, "));
    CHECK_THAT(document, Contains("extent of groups"));
    // The number of groups over time lies over the true one.
    CHECK_THAT(document, Contains("groups over time") && Contains(">truth</text>"));
    CHECK(screenshot(folder, "page.html#theme=light", 1440).colours() > 100);
}

TEST_CASE("plots are written as images for papers", "[release-only]") {
    if (!has_browser()) return;
    must(result(), {"report", "out", "--out", "plots.html", "--plot", "png", "--plot", "svg"});
    for (const std::string name : {"figures", "time", "scene", "distributions"}) {
        INFO(name);
        const Picture picture = read_png(result() / ("plots/" + name + ".png"));
        CHECK(picture.width == 2400);
        CHECK(picture.colours() > 20);
        CHECK(picture.mean_brightness() > 200);
        CHECK_THAT(result().read("plots/" + name + ".svg"), Contains("<svg") && Contains("</svg>"));
    }
}

TEST_CASE("a comparison is drawn", "[release-only]") {
    if (!has_browser()) return;
    must(result(), {"run", "c.yaml", "--seed", "8", "--out", "eight"});
    must(result(), {"compare", "out", "eight", "--html", "both.html", "--plot", "png"});
    CHECK(screenshot(result(), "both.html#theme=light", 1440).colours() > 50);
    const std::filesystem::path plot(result() / "plots/differences.png");
    REQUIRE(std::filesystem::exists(plot));
    CHECK(read_png(plot).colours() > 20);
}
