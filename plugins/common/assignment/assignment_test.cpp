#include "assignment.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <numeric>
#include <random>

using assignment::assign;
using assignment::unassigned;

namespace {

constexpr double forbidden = std::numeric_limits<double>::infinity();

/// The sum that assign() makes least; checks that the answer is an assignment.
double total(std::int64_t rows, std::int64_t columns, const std::vector<double>& costs, double none,
             const std::vector<std::int64_t>& answer) {
    REQUIRE(answer.size() == static_cast<std::size_t>(rows));
    std::vector<char> used(static_cast<std::size_t>(columns), 0);
    double sum = 0;
    for (std::size_t row = 0; row < answer.size(); ++row) {
        if (answer[row] == unassigned) {
            sum += none;
            continue;
        }
        const auto column = static_cast<std::size_t>(answer[row]);
        REQUIRE(column < used.size());
        REQUIRE(used[column] == 0);
        used[column] = 1;
        sum += costs[row * used.size() + column];
    }
    return sum;
}

/// The least sum, by trying everything.
double least(std::size_t row, std::size_t rows, std::size_t columns, const std::vector<double>& costs, double none,
             std::vector<char>& used) {
    if (row == rows) return 0;
    double best = none + least(row + 1, rows, columns, costs, none, used);
    for (std::size_t j = 0; j < columns; ++j) {
        if (used[j] != 0 || costs[row * columns + j] == forbidden) continue;
        used[j] = 1;
        best = std::min(best, costs[row * columns + j] + least(row + 1, rows, columns, costs, none, used));
        used[j] = 0;
    }
    return best;
}

}  // namespace

TEST_CASE("Assignment finds the least cost of thousands of small random problems", "[assignment]") {
    std::mt19937 random(1);
    for (int problem = 0; problem < 5000; ++problem) {
        const auto rows = static_cast<std::int64_t>(random() % 6), columns = static_cast<std::int64_t>(random() % 6);
        const bool ties = problem % 3 == 0;
        std::vector<double> costs;
        for (std::int64_t i = 0; i < rows * columns; ++i) {
            const double u = static_cast<double>(random() % 1000);
            costs.push_back(random() % 3 == 0 ? forbidden : ties ? std::floor(u / 300) - 1 : u / 100 - 4);
        }
        const double none = ties ? 1 : static_cast<double>(random() % 100) / 20 - 1;
        const auto answer = assign(rows, columns, costs, none);
        std::vector<char> used(static_cast<std::size_t>(columns), 0);
        const double best =
            least(0, static_cast<std::size_t>(rows), static_cast<std::size_t>(columns), costs, none, used);
        REQUIRE(total(rows, columns, costs, none, answer) == Approx(best).margin(1e-9));
        REQUIRE(assign(rows, columns, costs, none) == answer);
    }
}

TEST_CASE("Assignment of equal costs takes the first that comes", "[assignment]") {
    CHECK(assign(2, 3, {1, 1, 1, 1, 1, 1}, 5) == std::vector<std::int64_t>{0, 1});
    CHECK(assign(1, 1, {5}, 5) == std::vector<std::int64_t>{0});  // better than none, if it is no worse
    CHECK(assign(1, 1, {5.1}, 5) == std::vector<std::int64_t>{unassigned});
    CHECK(assign(3, 0, {}, 5) == std::vector<std::int64_t>(3, unassigned));
    CHECK(assign(0, 3, {}, 5).empty());
}

TEST_CASE("Assignment reassigns along chains of any length", "[assignment]") {
    // Row i may have column i - 1 or i; the last row may have the last column but one only: all must move.
    constexpr std::int64_t n = 400;
    std::vector<double> costs(n * n, forbidden);
    for (std::int64_t i = 0; i < n; ++i) {
        if (i + 1 < n) costs[static_cast<std::size_t>(i * n + i)] = 1;
        if (i > 0) costs[static_cast<std::size_t>(i * n + i - 1)] = 1;
    }
    costs[n - 1] = 1;  // the first row may have the last column, too
    const auto answer = assign(n, n, costs, 1000);
    CHECK(total(n, n, costs, 1000, answer) == n);
}

TEST_CASE("Assignment of a large dense problem agrees with its dual bound", "[assignment]") {
    // Costs a_i + b_j + c_ij with c >= 0 and one zero a row in a hidden permutation: the least sum is known.
    constexpr std::int64_t n = 300;
    std::mt19937 random(5);
    std::vector<std::size_t> hidden(n);
    std::iota(hidden.begin(), hidden.end(), 0u);
    std::shuffle(hidden.begin(), hidden.end(), random);
    std::vector<double> costs(n * n), a(n), b(n);
    for (auto* values : {&a, &b})
        for (double& x : *values) x = static_cast<double>(random() % 1000) / 10;
    double expected = 0;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
            costs[i * n + j] = a[i] + b[j] + (hidden[i] == j ? 0 : static_cast<double>(random() % 500) / 10);
            if (hidden[i] == j) expected += costs[i * n + j];
        }
    CHECK(total(n, n, costs, 1e6, assign(n, n, costs, 1e6)) == Approx(expected));
}
