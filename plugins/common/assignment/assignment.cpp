#include "assignment.hpp"

#include <limits>

namespace assignment {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Prices u of rows and v of columns with cost(i, j) - u[i] - v[j] >= 0, and = 0 where row i has column j.
class Assignment {
public:
    Assignment(std::int64_t rows, std::int64_t columns, const std::vector<double>& costs, double none)
        : columns_(static_cast<std::size_t>(columns)),
          costs_(costs),
          none_(none),
          row_price_(static_cast<std::size_t>(rows), 0.0),
          column_price_(columns_, 0.0),
          column_of_(static_cast<std::size_t>(rows), unassigned),
          row_of_(columns_, unassigned) {}

    /// Finds row `start` a column (or none) along the shortest path on which other rows may move.
    void augment(std::int64_t start) {
        reach_.assign(columns_, infinity);
        from_.assign(columns_, unassigned);
        done_.assign(columns_, false);
        visited_.clear();
        double leave = infinity;            // length of the shortest path whose last row goes without a column
        std::int64_t leaving = unassigned;  // and that row
        std::int64_t end = unassigned;      // the free column that the path ends at
        double length = 0;                  // to `row`
        for (std::int64_t row = start;;) {
            visited_.push_back({row, length});
            const double exit = length + none_ - row_price_[index(row)];
            if (exit < leave) {
                leave = exit;
                leaving = row;
            }
            const std::int64_t nearest = relax(row, length);
            if (nearest == unassigned || leave < reach_[index(nearest)]) {
                length = leave;
                break;
            }
            done_[index(nearest)] = true;
            length = reach_[index(nearest)];
            if (row_of_[index(nearest)] == unassigned) {
                end = nearest;
                break;
            }
            row = row_of_[index(nearest)];
        }
        set_prices(length);
        if (end == unassigned) {  // the leaving row sets its column free for the one before it on the path
            end = column_of_[index(leaving)];
            column_of_[index(leaving)] = unassigned;
            if (end == unassigned) return;
        }
        flip(start, end);
    }

    std::vector<std::int64_t> columns() && { return std::move(column_of_); }

private:
    static std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i); }

    /// Lengths of the paths that go on from `row`; answers the nearest column that is not done, the first among equals.
    std::int64_t relax(std::int64_t row, double length) {
        const double* cost = costs_.data() + index(row) * columns_;
        const double shift = length - row_price_[index(row)];
        std::int64_t nearest = unassigned;
        double shortest = infinity;
        for (std::size_t j = 0; j < columns_; ++j) {
            if (done_[j]) continue;
            const double candidate = cost[j] + shift - column_price_[j];
            if (candidate < reach_[j]) {
                reach_[j] = candidate;
                from_[j] = row;
            }
            if (reach_[j] < shortest) {
                shortest = reach_[j];
                nearest = static_cast<std::int64_t>(j);
            }
        }
        return nearest;
    }

    void set_prices(double length) {
        for (const auto& [row, reached] : visited_) row_price_[index(row)] += length - reached;
        for (std::size_t j = 0; j < columns_; ++j)
            if (done_[j] && reach_[j] < length) column_price_[j] -= length - reach_[j];
    }

    /// Gives every row on the path the column that comes after it.
    void flip(std::int64_t start, std::int64_t end) {
        for (std::int64_t column = end;;) {
            const std::int64_t row = from_[index(column)];
            const std::int64_t before = column_of_[index(row)];
            column_of_[index(row)] = column;
            row_of_[index(column)] = row;
            if (row == start) return;
            column = before;
        }
    }

    struct Visit {
        std::int64_t row;
        double length;
    };
    std::size_t columns_;
    const std::vector<double>& costs_;
    double none_;
    std::vector<double> row_price_, column_price_;
    std::vector<std::int64_t> column_of_, row_of_;
    std::vector<double> reach_;
    std::vector<std::int64_t> from_;
    std::vector<char> done_;
    std::vector<Visit> visited_;
};

}  // namespace

std::vector<std::int64_t> assign(std::int64_t rows, std::int64_t columns, const std::vector<double>& costs,
                                 double cost_of_none) {
    Assignment problem(rows, columns, costs, cost_of_none);
    for (std::int64_t row = 0; row < rows; ++row) problem.augment(row);
    return std::move(problem).columns();
}

}  // namespace assignment
