#include <catch2/catch.hpp>
#include <cmath>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "identity_analyzer.hpp"

namespace {

using namespace pelorus::test;
using analyzer_identity::IdentityAnalyzer;

constexpr std::int64_t second = 1'000'000'000;
enum Port : std::uint32_t { tracks, truth };

/// An analyzer that is told stories: "at 3 s, measurement 12 came from 7 and was used by track 1".
struct Story {
    Bench bench;
    StageUnderTest analyzer;

    explicit Story(const std::string& with = "{}")
        : analyzer(bench, plugin_of<IdentityAnalyzer>("analyzer.identity"), with) {}

    void came(std::int64_t time, std::uint64_t identity, const std::vector<std::uint64_t>& measurements) {
        pelorus::TruthBuilder builder("", pelorus::position_space(1));
        const double state[] = {0};
        builder.add({identity, time * second, state, nullptr, identity, 0, measurements});
        analyzer.receive(truth, builder.message(time * second));
    }
    void used(std::int64_t time, std::uint64_t track, const std::vector<std::uint64_t>& measurements,
              std::int32_t status = PLR_TRACK_CONFIRMED) {
        pelorus::TracksBuilder builder("", pelorus::position_space(1));
        const double mean[] = {0}, covariance[] = {1};
        builder.add({track, time * second, status, 0, mean, covariance, nullptr, {}, 0, measurements, {}});
        analyzer.receive(tracks, builder.message(time * second));
    }
    /// The tables, by name.
    const plr_table& table(const std::string& name) {
        if (bench.published.empty()) analyzer.finish(100 * second);
        for (const Published& p : bench.published)
            if (name == p.table().name) return p.table();
        throw std::runtime_error("no table " + name);
    }
    double cell(const std::string& name, double key, const std::string& column) {
        const plr_table& t = table(name);
        for (std::int64_t row = 0; row < t.rows.count; ++row)
            for (std::uint32_t c = 0; c < t.column_count; ++c)
                if (t.rows.data[row * t.rows.item_stride] == key && column == t.columns[c].name)
                    return t.rows.data[row * t.rows.item_stride + c];
        throw std::runtime_error("no cell");
    }
    double scalar(const std::string& name) {
        for (const char* of : {"by_identity", "by_track"}) {
            const plr_table& t = table(of);
            for (std::uint32_t i = 0; i < t.scalar_count; ++i)
                if (name == t.scalars[i].name) return t.scalars[i].value;
        }
        throw std::runtime_error("no scalar " + name);
    }
};

}  // namespace

TEST_CASE("analyzer.identity finds nothing wrong with a perfect tracker", "[analyzer.identity]") {
    Story story;
    for (std::int64_t k = 0; k < 10; ++k)
        for (std::uint64_t who : {235070762u, 244660000u}) {
            const std::uint64_t measurement = static_cast<std::uint64_t>(k) * 10 + who % 10;
            story.came(k, who, {measurement});
            story.used(k, who % 10, {measurement});
        }
    CHECK(story.scalar("identities") == 2);
    CHECK(story.scalar("tracks") == 2);
    CHECK(story.scalar("tracked_share") == 1);
    CHECK(story.scalar("switches") == 0);
    CHECK(story.scalar("fragments") == 0);
    CHECK(story.scalar("mean_purity") == 1);
    CHECK(story.cell("by_identity", 235070762, "main_track") == 2);
    CHECK(story.cell("by_track", 2, "main_identity") == 235070762);
    CHECK(story.cell("by_track", 2, "start") == 0);
    CHECK(story.cell("by_track", 2, "end") == 9);
}

TEST_CASE("analyzer.identity counts switches and fragments", "[analyzer.identity]") {
    Story story;
    // Tracks of the reports of identity 5, 0: none:  1 1 0 1 2 2 0 0 1
    const std::uint64_t by[] = {1, 1, 0, 1, 2, 2, 0, 0, 1};
    for (std::uint64_t k = 0; k < 9; ++k) {
        const auto time = static_cast<std::int64_t>(k);
        story.came(time, 5, {100 + k});
        if (by[k] != 0) story.used(time, by[k], {100 + k});
    }
    CHECK(story.cell("by_identity", 5, "reports") == 9);
    CHECK(story.cell("by_identity", 5, "tracked_share") == Approx(6.0 / 9));
    CHECK(story.cell("by_identity", 5, "tracks") == 2);
    CHECK(story.cell("by_identity", 5, "switches") == 2);   // 1 -> 2, 2 -> 1
    CHECK(story.cell("by_identity", 5, "fragments") == 2);  // after the third and after the eighth report
    CHECK(story.cell("by_identity", 5, "main_track") == 1);
    CHECK(story.cell("by_identity", 5, "main_share") == Approx(4.0 / 9));
}

TEST_CASE("analyzer.identity: untracked reports before the first tracked one are no fragment", "[analyzer.identity]") {
    Story story;
    for (std::uint64_t k = 0; k < 4; ++k) story.came(static_cast<std::int64_t>(k), 5, {k});
    story.used(3, 1, {2});
    story.used(3, 1, {3});
    CHECK(story.cell("by_identity", 5, "fragments") == 0);
    CHECK(story.cell("by_identity", 5, "tracked_share") == 0.5);
}

TEST_CASE("analyzer.identity counts false alarms and strangers against a track's purity", "[analyzer.identity]") {
    Story story;
    for (std::uint64_t k = 0; k < 6; ++k) {
        story.came(static_cast<std::int64_t>(k), 5, {k});
        story.used(static_cast<std::int64_t>(k), 1, {k});
    }
    story.came(6, 6, {60});
    story.used(6, 1, {60});  // a stranger's
    story.used(7, 1, {70});  // nobody's
    story.used(8, 1, {});    // coasting
    story.used(8, 2, {80});  // a track of false alarms only
    story.came(9, 7, {90});
    CHECK(story.cell("by_track", 1, "purity") == Approx(6.0 / 8));
    CHECK(story.cell("by_track", 1, "unknown") == 1);
    CHECK(story.cell("by_track", 1, "identities") == 2);
    CHECK(story.cell("by_identity", 5, "main_purity") == Approx(6.0 / 8));
    CHECK(story.cell("by_track", 2, "purity") == 0);
    CHECK(std::isnan(story.cell("by_track", 2, "main_identity")));
    CHECK(std::isnan(story.cell("by_identity", 7, "main_track")));
    CHECK(story.scalar("identities_tracked") == 2);
    CHECK(story.scalar("mean_purity") == Approx((6.0 / 8 + 0) / 2));
    CHECK(story.scalar("purity") == Approx(6.0 / 9));
}

TEST_CASE("analyzer.identity tells how long it took until an identity was tracked", "[analyzer.identity]") {
    Story story;
    for (std::uint64_t k = 0; k < 5; ++k) {
        const auto time = static_cast<std::int64_t>(k);
        story.came(2 + time, 5, {k});
        if (k >= 3) story.used(2 + time, 1, {k});
        story.came(2 + time, 6, {10 + k});
        if (k != 1) story.used(2 + time, 2, {10 + k});
        story.came(2 + time, 7, {20 + k});
    }
    CHECK(story.cell("by_identity", 5, "latency") == 3);
    CHECK(story.cell("by_identity", 6, "latency") == 0);
    CHECK(std::isnan(story.cell("by_identity", 7, "latency")));
    CHECK(story.scalar("latency") == Approx(1.5));
}

TEST_CASE("analyzer.identity counts tracks of nobody and how long they live", "[analyzer.identity]") {
    Story story;
    story.came(0, 5, {1});
    story.used(0, 1, {1});
    story.used(7, 1, {100});  // strays, but was once somebody's
    story.used(2, 2, {200});
    story.used(5, 2, {201});
    story.used(6, 3, {300});
    story.used(8, 3, {}, PLR_TRACK_COASTING);
    CHECK(story.scalar("tracks") == 3);
    CHECK(story.scalar("false_tracks") == 2);
    CHECK(story.scalar("false_track_time") == Approx(3 + 2));
}

TEST_CASE("analyzer.identity leaves tentative and deleted entries out", "[analyzer.identity]") {
    Story story;
    story.came(0, 5, {1, 2});
    story.used(0, 1, {1}, PLR_TRACK_TENTATIVE);
    story.used(0, 2, {2}, PLR_TRACK_DELETED);
    CHECK(story.scalar("tracks") == 0);
    CHECK(story.scalar("tracked_share") == 0);
    CHECK(std::isnan(story.scalar("mean_purity")));
}

TEST_CASE("analyzer.identity waits for belated tracks, but not for ever", "[analyzer.identity]") {
    Story story("{patience: 20 s}");
    story.came(0, 5, {1});
    story.came(15, 5, {2});
    story.used(19, 1, {1});  // a tracker that smooths
    story.came(40, 5, {3});
    story.used(40, 1, {2});  // too late
    CHECK(story.cell("by_identity", 5, "tracked_share") == Approx(1.0 / 3));
    CHECK(story.cell("by_track", 1, "unknown") == 1);
}

TEST_CASE("analyzer.identity goes on exactly where its saved state left off", "[analyzer.identity]") {
    const auto tell = [](Story& story, std::uint64_t first, std::uint64_t last) {
        for (std::uint64_t k = first; k < last; ++k) {
            story.came(static_cast<std::int64_t>(k), k % 3, {k});
            if (k % 5 != 4) story.used(static_cast<std::int64_t>(k), 10 + k % 4, {k});
        }
    };
    Story whole, one, two;
    tell(whole, 0, 60);
    tell(one, 0, 23);
    two.analyzer.load(one.analyzer.save());
    tell(two, 23, 60);
    for (const char* name : {"by_identity", "by_track"}) {
        const plr_table &a = whole.table(name), &b = two.table(name);
        REQUIRE(a.rows.count == b.rows.count);
        const auto n = static_cast<std::size_t>(a.rows.count * a.rows.rows);
        CHECK(std::vector<double>(a.rows.data, a.rows.data + n) == std::vector<double>(b.rows.data, b.rows.data + n));
    }
    CHECK(whole.scalar("switches") == two.scalar("switches"));
    CHECK(whole.scalar("switches") > 0);
}
