#include <catch2/catch.hpp>
#include <cmath>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "../../../tests/support/reference.hpp"
#include "plane_analyzer.hpp"

namespace {

using namespace pelorus::test;
using plane_motion::PlaneAnalyzer;

constexpr std::int64_t second = 1'000'000'000;

/// An analyzer that is shown places: circles and helices about (9, 8, 7) km.
struct Show {
    Bench bench;
    StageUnderTest analyzer;
    std::uint64_t id = 1;

    explicit Show(const std::string& with) : analyzer(bench, plugin_of<PlaneAnalyzer>("analyzer.plane_motion"), with) {}

    void place(std::int64_t time, const Eigen::Vector3d& p, double variance = 100) {
        pelorus::ScanBuilder scan("radar", "", pelorus::position_space(3));
        const Eigen::Matrix3d covariance = variance * Eigen::Matrix3d::Identity();
        scan.add(id++, p.data(), covariance.data());
        analyzer.receive(0, scan.message(time));
    }
    /// `rise` m a second out of the plane of the circle.
    void circle(std::int64_t from, std::int64_t to, double rise = 0) {
        for (std::int64_t k = from; k <= to; ++k) {
            const double t = static_cast<double>(k), wobble = 5 * std::sin(37.0 * t);
            place(k * second, {9e3 + 2e3 * std::cos(0.2 * t), 8e3 + 2e3 * std::sin(0.2 * t), 7e3 + rise * t + wobble});
        }
    }
    const plr_table& table() {
        for (const Published& p : bench.published)
            if (p.port == 0) return p.table();
        analyzer.finish(200 * second);
        return bench.published.back().table();
    }
    std::size_t rows() { return static_cast<std::size_t>(table().rows.count); }
    double cell(std::int64_t row, const std::string& column) {
        const plr_table& t = table();
        for (std::uint32_t c = 0; c < t.column_count; ++c)
            if (column == t.columns[c].name) return t.rows.data[row * t.rows.item_stride + c];
        throw std::runtime_error("no column " + column);
    }
    std::string status(std::int64_t row) {
        const plr_table& t = table();
        const auto number = static_cast<std::uint32_t>(cell(row, "status"));
        return t.columns[t.column_count - 1].texts[number];
    }
    double scalar(const std::string& name) {
        for (std::uint32_t i = 0; i < table().scalar_count; ++i)
            if (name == table().scalars[i].name) return table().scalars[i].value;
        throw std::runtime_error("no scalar " + name);
    }
    bool is_finite() {
        const plr_table& t = table();
        bool finite = true;
        for (std::int64_t i = 0; i < t.rows.count * t.rows.rows; ++i) finite = finite && std::isfinite(t.rows.data[i]);
        return finite;
    }
    /// What the port plane told last; -1: nothing yet.
    double holds() const {
        double last = -1;
        for (const Published& p : bench.published)
            if (p.port == 1) last = p.message->body.values->quantities[2].numbers.data[0];
        return last;
    }
};

}  // namespace

TEST_CASE("plane motion: critical values are the known ones", "[plane_motion]") {
    // 80, 100 and 150 samples: 77, 97 and 147 degrees of freedom at 5 %.
    Show show("{windows: [[1 s, 80 s], [1 s, 100 s], [1 s, 150 s]]}");
    show.circle(1, 160);
    CHECK(std::fabs(show.scalar("critical_value_80") - 98.4844) < 1e-4);
    CHECK(std::fabs(show.scalar("critical_value_100") - 120.9896) < 1e-4);
    CHECK(std::fabs(show.scalar("critical_value_150") - 176.2938) < 1e-4);
    CHECK(show.cell(0, "samples") == 80);
    CHECK(show.cell(0, "degrees_of_freedom") == 77);
}

TEST_CASE("plane motion: a circle is in its plane, a helix is not", "[plane_motion]") {
    Show level("{windows: [[0 s, 60 s]]}"), rising("{windows: [[0 s, 60 s]]}"),
        regressed("{windows: [[0 s, 60 s]], statistic: regression}");
    level.circle(0, 60);
    rising.circle(0, 60, 5);
    regressed.circle(0, 60, 5);
    CHECK(level.scalar("rejection_rate_60") == 0);
    CHECK(level.cell(0, "normal.z") == Approx(1).epsilon(1e-4));
    CHECK(level.cell(0, "offset") == Approx(7000).epsilon(1e-3));
    CHECK(level.status(0) == "tested");
    CHECK(level.holds() == 1);
    CHECK(rising.scalar("rejection_rate_60") == 1);
    CHECK(rising.cell(0, "decision") == 1);
    CHECK(rising.holds() == 0);
    CHECK(regressed.scalar("rejection_rate_60") == 1);
}

TEST_CASE("plane motion: a fixed window is tested as soon as it is over", "[plane_motion]") {
    Show show("{windows: [[0 s, 20 s], [5 s, 30.5 s], [0 s, 300 s]]}");
    show.circle(0, 19);
    CHECK(show.holds() == -1);
    show.circle(20, 20);
    CHECK(show.bench.published.size() == 1);
    show.circle(21, 30);
    CHECK(show.bench.published.size() == 1);
    show.circle(31, 40);
    CHECK(show.bench.published.size() == 2);
    CHECK(show.rows() == 3);
    CHECK(show.cell(0, "samples") == 21);
    CHECK(show.cell(1, "samples") == 26);
    CHECK(show.cell(2, "samples") == 41);  // what there was when the run ended
}

TEST_CASE("plane motion: a growing window holds all from its start on, up to its capacity", "[plane_motion]") {
    Show show("{window: growing, from: 10 s, every: 4, capacity: 30, scalars_at: [33 s, 99 s]}");
    show.circle(0, 60);
    REQUIRE(show.rows() == 12);  // 51 samples, each fourth
    CHECK(show.cell(0, "end") == 13);
    CHECK(show.cell(0, "samples") == 4);
    CHECK(show.cell(5, "first") == 10);
    CHECK(show.cell(11, "samples") == 30);
    CHECK(show.cell(11, "first") == 28);
    CHECK(show.scalar("mean_statistic_33") == show.cell(5, "statistic"));
    CHECK(show.scalar("tested_99") == 0);  // the run was over before
}

TEST_CASE("plane motion: a sliding window sees the plane that is left and the next one", "[plane_motion]") {
    Show show("{window: sliding, length: 20 s}");
    show.circle(0, 30);
    CHECK(show.holds() == 1);
    show.circle(31, 50, 20);
    CHECK(show.holds() == 0);
    for (std::int64_t k = 51; k <= 80; ++k) {
        const double t = static_cast<double>(k);
        show.place(k * second, {8e3 + t * t, 9e3 - 300 * t, 7e3});
    }
    CHECK(show.holds() == 1);
    CHECK(show.cell(70, "samples") == 20);
    CHECK(show.cell(70, "first") == 51);
}

TEST_CASE("plane motion: what cannot be tested is told, and nothing is not a number", "[plane_motion]") {
    Show few("{windows: [[0 s, 2 s], [50 s, 60 s]]}"), repeated("{windows: [[0 s, 20 s]]}"),
        exact("{windows: [[0 s, 20 s]]}"), straight("{windows: [[0 s, 20 s]]}");
    few.circle(0, 20);
    CHECK(few.status(0) == "fewer than 4 points");
    CHECK(few.status(1) == "fewer than 4 points");
    for (std::int64_t k = 0; k <= 20; ++k) {
        repeated.place(k * second, {1, 2, 3});
        exact.place(k * second, {1000 * std::cos(0.1 * static_cast<double>(k)), 100.0 * static_cast<double>(k), 3}, 0);
        straight.place(k * second, {100.0 * static_cast<double>(k), 50, 20.0 * static_cast<double>(k)});
    }
    CHECK(repeated.status(0) == "fewer than 4 different points");
    CHECK(exact.status(0) == "no variance across the plane");
    CHECK(straight.status(0) == "line: in many planes, rejected less often than the level says");
    CHECK(straight.scalar("rejection_rate_20") == 0);
    CHECK(few.scalar("tested_2") == 0);
    CHECK(repeated.scalar("tested_20") == 0);
    CHECK(straight.scalar("tested_20") == 1);
    for (Show* show : {&few, &repeated, &exact}) {
        CHECK(show->is_finite());
        CHECK(show->cell(0, "decision") == 0);
        CHECK(show->holds() == 0);
    }
    CHECK(straight.is_finite());
}

TEST_CASE("plane motion: measurements are converted by their sensor", "[plane_motion]") {
    const auto answers = test_support::reference("plane_test_cases.json");
    Bench bench;
    const auto sensor = std::make_shared<const Instance>(bench, installed("sensor.spherical"),
                                                         "{noise: [50 m, 0.8725 mrad, 0.8725 mrad]}");
    StageUnderTest analyzer(bench, plugin_of<PlaneAnalyzer>("analyzer.plane_motion"), "{windows: [[0 s, 20 s]]}",
                            std::vector<Instance::Part>{{"sensors", "radar", sensor}});
    const pelorus::Space space(
        {{"range", "m", 0, 0, false}, {"azimuth", "rad", 0, 0, true}, {"elevation", "rad", 0, 0, true}});
    for (std::size_t k = 0; k < 20; ++k) {
        pelorus::ScanBuilder scan("radar", "", space);
        const double z[] = {answers.at("r")[k], answers.at("az")[k], answers.at("el")[k]};
        scan.add(k + 1, z);
        analyzer.receive(0, scan.message(static_cast<std::int64_t>(k) * second));
    }
    analyzer.finish(20 * second);
    const plr_table& table = bench.published.back().table();
    CHECK(std::string(table.scalars[2].name) == "mean_statistic_20");
    CHECK(table.scalars[2].value == Approx(answers.at("eiv").get<double>()).epsilon(1e-6));
    CHECK(table.scalars[3].value == Approx(answers.at("crit05").get<double>()).epsilon(1e-6));
}

TEST_CASE("plane motion: without covariances a sensor's noise is that at the place measured", "[plane_motion]") {
    Bench bench;
    const auto sensor = std::make_shared<const Instance>(bench, installed("sensor.spherical"),
                                                         "{noise: [50 m, 1 mrad, 1 mrad], reference_range: 50 km}");
    const pelorus::Space space(
        {{"range", "m", 0, 0, false}, {"azimuth", "rad", 0, 0, true}, {"elevation", "rad", 0, 0, true}});
    std::vector<double> statistics;
    for (const bool is_told : {false, true}) {
        StageUnderTest analyzer(bench, plugin_of<PlaneAnalyzer>("analyzer.plane_motion"), "{windows: [[0 s, 20 s]]}",
                                std::vector<Instance::Part>{{"sensors", "", sensor}});
        for (std::int64_t k = 0; k < 20; ++k) {
            const double t = static_cast<double>(k);
            const double z[] = {60e3 + 500 * t, 0.5 + 0.02 * t * t / 20, 0.2 + 0.01 * std::cos(t)};
            const Eigen::Matrix3d noise = Eigen::Vector3d(2500, 1e-6, 1e-6).asDiagonal();
            const Eigen::Matrix3d there = std::pow(z[0] / 50e3, 4) * noise;
            pelorus::ScanBuilder scan("anything", "", space);
            scan.add(static_cast<std::uint64_t>(k) + 1, z, is_told ? there.data() : nullptr);
            analyzer.receive(0, scan.message(k * second));
        }
        analyzer.finish(20 * second);
        statistics.push_back(bench.published.back().table().scalars[2].value);
    }
    CHECK(statistics[0] > 0);
    CHECK(statistics[0] == Approx(statistics[1]).epsilon(1e-9));
}

TEST_CASE("plane motion: belated measurements find their place", "[plane_motion]") {
    Show one("{windows: [[0 s, 20 s]]}"), other("{windows: [[0 s, 20 s]]}");
    one.circle(0, 30);
    other.circle(0, 11);
    other.circle(13, 19);
    other.circle(12, 12);
    other.circle(20, 30);
    CHECK(one.scalar("mean_statistic_20") == other.scalar("mean_statistic_20"));
}

TEST_CASE("plane motion: what makes no sense is refused by name", "[plane_motion]") {
    const auto refusal = [](const std::string& with) -> std::string {
        try {
            Show show(with);
        } catch (const std::exception& problem) {
            return problem.what();
        }
        return "accepted";
    };
    CHECK_THAT(refusal("{}"), Catch::Contains("windows: is missing"));
    CHECK_THAT(refusal("{windows: [[3 s, 3 s]]}"), Catch::Contains("windows[0].end: is not after its start"));
    CHECK_THAT(refusal("{windows: [[0 s, 3 s], [1 s, 3 s]]}"), Catch::Contains("windows[1].end"));
    CHECK_THAT(refusal("{window: sliding}"), Catch::Contains("length: is missing"));
    CHECK_THAT(refusal("{window: growing, length: 3 s}"), Catch::Contains("length: belongs to window: sliding"));
    CHECK_THAT(refusal("{window: growing, windows: [[0 s, 1 s]]}"), Catch::Contains("windows: belongs"));
    CHECK_THAT(refusal("{windows: [[0 s, 1 s]], from: 0 s}"), Catch::Contains("from: belongs"));
    CHECK_THAT(refusal("{window: growing, scalars_at: [3 s, 3 s]}"), Catch::Contains("scalars_at: has a time twice"));
    Show show("{windows: [[0 s, 3 s]]}");
    pelorus::ScanBuilder bare("radar", "", pelorus::position_space(3));
    const double p[] = {1, 2, 3};
    bare.add(1, p);
    CHECK_THROWS_WITH(show.analyzer.receive(0, bare.message(0)), Catch::Contains("without covariances"));
}

TEST_CASE("plane motion: it goes on exactly where its saved state left off", "[plane_motion]") {
    for (const char* with : {"{windows: [[0 s, 20 s], [5 s, 40 s]]}", "{window: growing, every: 3}",
                             "{window: sliding, length: 15 s, every: 2}"}) {
        Show whole(with), one(with), two(with);
        whole.circle(0, 50, 2);
        one.circle(0, 22, 2);
        two.analyzer.load(one.analyzer.save());
        two.circle(23, 50, 2);
        const plr_table &a = whole.table(), &b = two.table();
        REQUIRE(a.rows.count == b.rows.count);
        const auto n = static_cast<std::size_t>(a.rows.count * a.rows.rows);
        CHECK(std::vector<double>(a.rows.data, a.rows.data + n) == std::vector<double>(b.rows.data, b.rows.data + n));
    }
}
