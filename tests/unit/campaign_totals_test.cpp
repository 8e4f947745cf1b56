// What runs add up to, and that it does not matter how they were divided.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include <pelorus/abi/abi.h>
#include <pelorus/abi/consistency.h>

#include "campaign/finished_cell.hpp"
#include "campaign/in_order.hpp"
#include "campaign/statistics.hpp"

using namespace pelorus;
using campaign::Blocks;
using campaign::CellTotals;
using campaign::Totals;
using Json = nlohmann::ordered_json;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A run's results: a table of errors by time with one column of each reduction, and scalars.
runtime::Results results_of(std::uint64_t run) {
    const auto r = static_cast<double>(run);
    runtime::Table table;
    table.node = "errors";
    table.name = "by_time";
    table.columns = {{"time", "s", PLR_REDUCE_KEY, 0, {}},
                     {"mean", "m", PLR_REDUCE_MEAN, 0, {}},
                     {"rms", "m", PLR_REDUCE_ROOT_MEAN_SQUARE, 0, {}},
                     {"sum", "", PLR_REDUCE_SUM, 0, {}},
                     {"count", "", PLR_REDUCE_COUNT, 0, {}},
                     {"least", "", PLR_REDUCE_MIN, 0, {}},
                     {"greatest", "", PLR_REDUCE_MAX, 0, {}},
                     {"median", "", PLR_REDUCE_QUANTILE, 0.5, {}},
                     {"first", "", PLR_REDUCE_FIRST_RUN, 0, {}}};
    for (const double time : {0.0, 1.0, 2.0}) {
        const double x = std::sin(r * 12.9898 + time * 78.233) + 0.3 * time;
        const double y = run % 5 == 3 && time > 1 ? not_a_number : x;
        for (const double element : {time, y, y, y, y, y, y, y, x}) table.rows.push_back(element);
    }
    const double x = std::cos(r * 4.1414);
    table.scalars = {{"rmse", "m", 0, 0, 0, "rms", 1},
                     {"bias", "m", 0, 0, 0, "mean", 1},
                     {"worst", "m", 0, 0, 0, "greatest", 1},
                     {"score", "", PLR_REDUCE_MEAN, run == 2 ? not_a_number : x, 0, "", 1},
                     {"power", "", PLR_REDUCE_ROOT_MEAN_SQUARE, x, 0, "", 1},
                     {"middle", "", PLR_REDUCE_QUANTILE, x, 0.5, "", 1},
                     {"weighted", "", PLR_REDUCE_MEAN, x, 0, "", r + 1}};
    runtime::Results results;
    results.tables.push_back(table);
    return results;
}

Totals totals_of(std::uint64_t first, std::uint64_t last) {
    Totals totals;
    for (std::uint64_t run = first; run < last; ++run) totals.add(results_of(run), run);
    return totals;
}

/// All blocks, in the order that `order` says.
Json finished(std::uint64_t runs, const std::function<std::uint64_t(std::uint64_t)>& order) {
    const Blocks blocks(runs);
    CellTotals cell(blocks);
    for (std::uint64_t i = 0; i < blocks.count(); ++i) {
        const std::uint64_t block = order(i);
        cell.add(block, totals_of(blocks.first_run(block), blocks.last_run(block)));
    }
    REQUIRE(cell.is_complete());
    return campaign::finished_cell(cell, {});
}

Json in_order(std::uint64_t runs) {
    return finished(runs, [](std::uint64_t i) { return i; });
}

std::vector<double> values_of(std::uint64_t runs, const std::function<double(const runtime::Results&)>& value) {
    std::vector<double> values;
    for (std::uint64_t run = 0; run < runs; ++run) {
        const double x = value(results_of(run));
        if (std::isfinite(x)) values.push_back(x);
    }
    return values;
}

double element(const runtime::Results& results, std::size_t row, std::size_t column) {
    return results.tables[0].rows[row * 9 + column];
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double x : values) sum += x;
    return sum / static_cast<double>(values.size());
}

double scalar(const Json& cell, const std::string& name, const char* member = "value") {
    return cell["cell"]["scalars"]["errors." + name][member].get<double>();
}

}  // namespace

TEST_CASE("A block is never larger than its part of 32 groups, and every run is in one", "[campaign]") {
    for (const std::uint64_t runs : {1u, 2u, 31u, 32u, 33u, 200u, 1000u, 12345u}) {
        const Blocks blocks(runs);
        CHECK(blocks.groups() <= 32);
        CHECK(blocks.first_run(0) == 0);
        CHECK(blocks.last_run(blocks.count() - 1) == runs);
        CHECK(blocks.first_run(blocks.count() - 1) < runs);
        CHECK(blocks.group_of(blocks.count() - 1) == blocks.groups() - 1);
    }
    CHECK(Blocks(20).count() == 20);
    CHECK(Blocks(200).count() == 29);
    CHECK(Blocks(12345).last_run(0) == 16);
}

TEST_CASE("Blocks that come in another order add up to the same bytes", "[campaign]") {
    const std::uint64_t count = Blocks(70).count();
    const Json expected = in_order(70);
    CHECK(expected.dump() == finished(70, [&](std::uint64_t i) { return count - 1 - i; }).dump());
    CHECK(expected.dump() == finished(70, [&](std::uint64_t i) { return i * 5 % count; }).dump());
}

TEST_CASE("Totals come out of their bytes as they went in, and broken bytes are refused", "[campaign]") {
    Totals totals = totals_of(0, 6);
    totals.add_failed({6, "no luck"});
    runtime::ByteWriter writer, again;
    totals.write(writer);
    runtime::ByteReader reader(writer.bytes().data(), writer.bytes().size());
    Totals::read(reader).write(again);
    CHECK(writer.bytes() == again.bytes());
    for (std::size_t size = 0; size < writer.bytes().size(); size += 7) {
        runtime::ByteReader cut(writer.bytes().data(), size);
        CHECK_THROWS_AS(Totals::read(cut), runtime::CorruptBytes);
    }
}

TEST_CASE("Columns reduce as their analyzers say", "[campaign]") {
    const std::uint64_t runs = 40;
    const Json cell = in_order(runs);
    const Json& row = cell["cell"]["tables"]["errors.by_time"]["rows"][2];
    std::vector<double> values = values_of(runs, [](const auto& results) { return element(results, 2, 1); });
    REQUIRE(values.size() == 32);  // eight of forty are not finite
    double squares = 0, sum = 0;
    for (const double x : values) squares += x * x, sum += x;
    std::sort(values.begin(), values.end());
    CHECK(row[0] == 2.0);
    CHECK(row[1].get<double>() == Approx(sum / 32));
    CHECK(row[2].get<double>() == Approx(std::sqrt(squares / 32)));
    CHECK(row[3].get<double>() == Approx(sum));
    CHECK(row[4] == 32.0);
    CHECK(row[5] == values.front());
    CHECK(row[6] == values.back());
    CHECK(row[7].get<double>() == Approx((values[15] + values[16]) / 2));
    CHECK(row[8] == element(results_of(0), 2, 8));
    CHECK(cell["cell"]["tables"]["errors.by_time"]["non_finite"] == 7 * 8);
    CHECK(cell["cell"]["scalars"]["errors.rmse"]["non_finite"] == 8);
}

TEST_CASE("Degrees of freedom of all runs make a bound of chi-square", "[campaign]") {
    Totals totals;
    for (std::uint64_t run = 0; run < 5; ++run) {
        runtime::Table table;
        table.node = "errors";
        table.name = "by_time";
        table.columns = {{"time", "s", PLR_REDUCE_KEY, 0, {}},
                         {"lower", "", PLR_REDUCE_CHI_SQUARE, 0.025, {}},
                         {"upper", "", PLR_REDUCE_CHI_SQUARE, 0.975, {}}};
        const double degrees = run == 3 ? not_a_number : 6;
        table.rows = {0, degrees, degrees};
        table.scalars = {{"bound", "", PLR_REDUCE_CHI_SQUARE, degrees, 0.975, "", 1}};
        runtime::Results results;
        results.tables.push_back(table);
        totals.add(results, run);
    }
    const auto& found = totals.tables().at(0);
    // Chi-square of 24 degrees: 12.4012 and 39.3641.
    CHECK(campaign::reduced(found.columns[1], found.rows.at(0), 1, 0) == Approx(12.4012 / 24).epsilon(1e-5));
    CHECK(campaign::reduced(found.columns[2], found.rows.at(0), 2, 0) == Approx(39.3641 / 24).epsilon(1e-5));
    const auto& scalar = totals.scalars().at(0);
    CHECK(campaign::estimate_of(scalar.reduce, scalar.quantile, scalar.values, scalar.weights).value ==
          Approx(39.3641 / 24).epsilon(1e-5));
}

TEST_CASE("An RMSE is the mean over time of the root mean square over runs", "[campaign]") {
    const Json cell = in_order(40);
    double sum = 0;
    for (int row = 0; row < 3; ++row) sum += cell["cell"]["tables"]["errors.by_time"]["rows"][row][2].get<double>();
    CHECK(scalar(cell, "rmse") == Approx(sum / 3).epsilon(1e-14));
}

TEST_CASE("Scalars have the intervals of the textbooks", "[campaign]") {
    const std::uint64_t runs = 30;
    const Json cell = in_order(runs);
    const auto deviation = [](const std::vector<double>& values) {
        double squares = 0;
        for (const double x : values) squares += (x - mean(values)) * (x - mean(values));
        return std::sqrt(squares / static_cast<double>(values.size() - 1) / static_cast<double>(values.size()));
    };
    const std::vector<double> scores = values_of(runs, [](const auto& r) { return r.tables[0].scalars[3].value; });
    CHECK(scalar(cell, "score") == Approx(mean(scores)));
    CHECK(scalar(cell, "score", "ci95") == Approx(2.048407 * deviation(scores)).epsilon(1e-6));  // t of 28 degrees
    CHECK(scalar(cell, "score", "non_finite") == 1);
    std::vector<double> squares = values_of(runs, [](const auto& r) { return r.tables[0].scalars[4].value; });
    for (double& x : squares) x *= x;
    const double root = std::sqrt(mean(squares));
    CHECK(scalar(cell, "power") == Approx(root));
    CHECK(scalar(cell, "power", "ci95") == Approx(2.045230 * deviation(squares) / (2 * root)).epsilon(1e-6));
    double sum = 0, weights = 0;
    for (std::uint64_t run = 0; run < runs; ++run) {
        const auto w = static_cast<double>(run + 1);
        sum += w * results_of(run).tables[0].scalars[6].value, weights += w;
    }
    CHECK(scalar(cell, "weighted") == Approx(sum / weights));
    std::vector<double> sorted = values_of(runs, [](const auto& r) { return r.tables[0].scalars[5].value; });
    std::sort(sorted.begin(), sorted.end());
    CHECK(scalar(cell, "middle") == Approx((sorted[14] + sorted[15]) / 2));
    CHECK(scalar(cell, "middle", "ci95") > 0);
    CHECK(cell["cell"]["scalars"]["errors.worst"]["ci95"].is_null());
}

TEST_CASE("With a run a group, the jackknife of a mean is Student's interval", "[campaign]") {
    // `bias` is a mean over rows of means over runs: with complete rows, the mean over runs of a run's own mean.
    runtime::Results with_gap;
    CellTotals cell{Blocks(20)};
    std::vector<double> own;
    for (std::uint64_t run = 0; run < 20; ++run) {
        runtime::Results results = results_of(run);
        for (std::size_t row = 0; row < 3; ++row) results.tables[0].rows[row * 9 + 1] = element(results, row, 8);
        own.push_back((element(results, 0, 1) + element(results, 1, 1) + element(results, 2, 1)) / 3);
        Totals totals;
        totals.add(results, run);
        cell.add(run, std::move(totals));
    }
    double squares = 0;
    for (const double x : own) squares += (x - mean(own)) * (x - mean(own));
    const Json finished = campaign::finished_cell(cell, {});
    CHECK(scalar(finished, "bias") == Approx(mean(own)));
    CHECK(scalar(finished, "bias", "ci95") == Approx(2.093024 * std::sqrt(squares / 19 / 20)).epsilon(1e-6));
}

TEST_CASE("One run has no interval and is what a run alone is", "[campaign]") {
    const Json one = in_order(1);
    CHECK(one["cell"]["scalars"]["errors.rmse"]["ci95"].is_null());
    CHECK(one["cell"]["scalars"]["errors.score"]["ci95"].is_null());
    CHECK(one["cell"].dump() == report::cell_json(report::cell_of_run(results_of(0))).dump());
}

TEST_CASE("Runs are paired: what two cells have in common falls out of their difference", "[campaign]") {
    CellTotals shifted{Blocks(30)};
    for (std::uint64_t run = 0; run < 30; ++run) {
        runtime::Results results = results_of(run);
        for (runtime::Scalar& scalar : results.tables[0].scalars) scalar.value += 0.5;
        Totals totals;
        totals.add(results, run);
        shifted.add(run, std::move(totals));
    }
    const Json base = in_order(30), other = campaign::finished_cell(shifted, {});
    const Json differences = campaign::paired_differences(other, base);
    CHECK(differences["errors.score"]["difference"].get<double>() == Approx(0.5));
    CHECK(differences["errors.score"]["ci95"].get<double>() < 1e-12);
    CHECK(scalar(base, "score", "ci95") > 0.1);
    CHECK(differences["errors.rmse"]["difference"] == 0.0);
    CHECK(differences["errors.rmse"]["ci95"] == 0.0);
    CHECK(differences["errors.middle"]["ci95"].is_null());
}

TEST_CASE("A failed run counts and has no values", "[campaign]") {
    CellTotals cell{Blocks(4)};
    for (std::uint64_t run = 0; run < 4; ++run) {
        Totals totals;
        if (run == 1)
            totals.add_failed({run, "it broke"});
        else
            totals.add(results_of(run), run);
        cell.add(run, std::move(totals));
    }
    const Json finished = campaign::finished_cell(cell, {});
    CHECK(finished["cell"]["runs"] == 4);
    CHECK(finished["cell"]["failed"] == 1);
    CHECK(finished["cell"]["failed_runs"] == Json{1});
    CHECK(finished["cell"]["failure"] == "it broke");
    CHECK(finished["samples"]["errors.power"]["values"][1].is_null());
    CHECK(scalar(finished, "rmse", "ci95") > 0);
}

TEST_CASE("A row that a later run brings stands behind what came before it there", "[campaign]") {
    const auto itself = [](const int& number) -> const int& { return number; };
    std::vector<int> into{1, 2, 5};
    int joined = 0;
    campaign::merge_in_order(into, {1, 3, 5, 6, 2}, itself, [&](int&, int) { ++joined; });
    CHECK(into == std::vector<int>{1, 3, 2, 5, 6});
    CHECK(joined == 3);
    campaign::merge_in_order(into, {5, 7, 8, 1, 9, 4}, itself, [&](int&, int) { ++joined; });
    CHECK(into == std::vector<int>{1, 9, 4, 3, 2, 5, 7, 8, 6});
    CHECK(joined == 5);
}

TEST_CASE("Rows of keys that no two runs share are all kept, and found without looking at each", "[campaign]") {
    std::size_t looks = 0;
    const auto counted = [&](const int& number) -> const int& {
        ++looks;
        return number;
    };
    std::vector<int> into;
    for (int run = 0; run < 10; ++run) {
        std::vector<int> later;
        for (int row = 0; row < 1000; ++row) later.push_back(10 * row + run);
        campaign::merge_in_order(into, std::move(later), counted, [](int&, int) {});
    }
    CHECK(into.size() == 10000);
    CHECK(std::set<int>(into.begin(), into.end()).size() == 10000);
    CHECK(looks < 10 * 10000 * 40);  // row against row would be some 25 times that
}

TEST_CASE("A table with other columns than before is refused", "[campaign]") {
    Totals totals = totals_of(0, 1);
    runtime::Results results = results_of(1);
    results.tables[0].columns[3].unit = "s";
    CHECK_THROWS_WITH(totals.add(results, 1),
                      "node errors: the table 'by_time' has other columns than in the runs before");
}
