// configs/airship.yaml, a few runs: one of its figures, determinism, a snapshot half-way. All figures: airship_figures_test.cpp.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "graph/graph.hpp"
#include "host/catalog.hpp"
#include "runtime/runtime.hpp"

namespace {

using namespace pelorus;
using Sets = std::vector<graph::Override>;

host::Catalog& catalog() {
    static host::Catalog all({PELORUS_PLUGIN_DIR});
    return all;
}
const std::string config = PELORUS_SOURCE_DIR "/configs/airship.yaml";

graph::Graph build(std::uint64_t run, const Sets& sets) {
    graph::BuildOptions options;
    options.run = run;
    Sets all = sets;
    all.push_back({"files", "~"});  // these runs keep no files
    return graph::Graph::build(graph::Document::load(config, all), catalog(), options);
}

runtime::Results results_of(std::uint64_t run, const Sets& sets) {
    graph::Graph graph = build(run, sets);
    runtime::Runtime runtime(graph);
    runtime.run({});
    return runtime.results();
}

const runtime::Table& table(const runtime::Results& results, const std::string& node) {
    for (const auto& t : results.tables)
        if (t.node == node) return t;
    throw std::runtime_error("no table of " + node);
}
std::vector<double> column(const runtime::Table& t, const std::string& name) {
    std::vector<double> out;
    for (std::size_t c = 0; c < t.columns.size(); ++c)
        if (t.columns[c].name == name)
            for (std::size_t r = 0; r < t.row_count(); ++r) out.push_back(t.rows[r * t.columns.size() + c]);
    return out;
}
double scalar(const runtime::Table& t, const std::string& name) {
    for (const auto& s : t.scalars)
        if (s.name == name) return s.value;
    throw std::runtime_error("no scalar " + name);
}

/// Mean over time of the root mean square over runs; mean over runs of the long axis' error.
struct Figures {
    double position = 0, long_axis = 0;
};
Figures monte_carlo(int runs, const Sets& sets) {
    std::vector<double> position(100, 0);
    Figures out;
    for (int run = 0; run < runs; ++run) {
        const auto results = results_of(static_cast<std::uint64_t>(run), sets);
        const auto p = column(table(results, "errors"), "position");
        REQUIRE(p.size() == 100);
        for (std::size_t k = 0; k < 100; ++k) position[k] += p[k] * p[k] / runs;
        out.long_axis += scalar(table(results, "shape"), "major_axis_error") / runs;
    }
    for (std::size_t k = 0; k < 100; ++k) out.position += std::sqrt(position[k]) / 100;
    return out;
}

std::vector<double> all_numbers(const runtime::Results& results) {
    std::vector<double> out;
    for (const auto& t : results.tables) {
        out.insert(out.end(), t.rows.begin(), t.rows.end());
        for (const auto& s : t.scalars) out.push_back(s.value);
    }
    return out;
}
/// Equal bit for bit; NaN equals NaN.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
               return x == y || (std::isnan(x) && std::isnan(y));
           });
}

}  // namespace

TEST_CASE("the airship runs with Koch's joint extent", "[airship]") {
    const Sets koch{{"tracker.estimator", "~"},
                    {"tracker.extent",
                     "{use: extent.random_matrix, with: {update: koch}, parts: {motion: {use: motion.singer, with: "
                     "{form: truncated, maneuver_rate: 0.1 1/s, acceleration: 0.1 m/s2}}, sensors: {radar: {like: "
                     "world.sensors.radar}}}}"}};
    const Figures made = monte_carlo(20, koch);
    CHECK(made.position == Approx(2.41).epsilon(0.1));
    CHECK(made.long_axis == Approx(0.42).margin(0.1));
}

TEST_CASE("the airship's results are the same bits for the same seed, and others for another", "[airship]") {
    const auto once = all_numbers(results_of(3, {}));
    CHECK(same(once, all_numbers(results_of(3, {}))));
    CHECK_FALSE(same(once, all_numbers(results_of(4, {}))));
    CHECK_FALSE(same(once, all_numbers(results_of(3, {{"run.seed", "8"}}))));
}

TEST_CASE("an airship run resumed from a snapshot ends with the same bits", "[airship]") {
    const Sets sets =
        GENERATE(Sets{}, Sets{{"tracker.extent.start", "consistent"}, {"tracker.extent.update", "feldmann"}});
    const auto whole = all_numbers(results_of(0, sets));
    for (const std::int64_t at : {std::int64_t{0}, std::int64_t{50'500'000'000}}) {
        std::vector<unsigned char> bytes;
        graph::Graph first = build(0, sets);
        runtime::Runtime interrupted(first);
        runtime::RunOptions options;
        options.snapshot_at = at;
        options.on_snapshot = [&](const std::vector<unsigned char>& snapshot) { bytes = snapshot; };
        interrupted.run(options);
        CHECK(same(all_numbers(interrupted.results()), whole));
        graph::Graph again = build(0, sets);
        runtime::Runtime resumed(again);
        resumed.restore(bytes);
        resumed.run({});
        CHECK(same(all_numbers(resumed.results()), whole));
    }
}
