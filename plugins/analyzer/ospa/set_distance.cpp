#include "set_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../../common/assignment/assignment.hpp"

namespace ospa {

namespace {

double squared_distance(const Point& a, const Point& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

/// What an assignment costs, as multiples of cutoff^order.
struct Assigned {
    double localisation = 0;
    std::int64_t pairs = 0;  ///< closer than the cutoff
};

Assigned assigned(const std::vector<Point>& fewer, const std::vector<Point>& more, double cutoff, double order) {
    std::vector<double> costs;
    costs.reserve(fewer.size() * more.size());
    for (const Point& a : fewer)
        for (const Point& b : more) {
            const double share = std::sqrt(squared_distance(a, b)) / cutoff;
            costs.push_back(share < 1 ? std::pow(share, order) : std::numeric_limits<double>::infinity());
        }
    const auto rows = static_cast<std::int64_t>(fewer.size()), columns = static_cast<std::int64_t>(more.size());
    const std::vector<std::int64_t> answer = assignment::assign(rows, columns, costs, 1.0);
    Assigned out;
    for (std::size_t row = 0; row < answer.size(); ++row) {
        if (answer[row] == assignment::unassigned) continue;
        out.localisation += costs[row * more.size() + static_cast<std::size_t>(answer[row])];
        ++out.pairs;
    }
    return out;
}

}  // namespace

SetDistance set_distance(const std::vector<Point>& objects, const std::vector<Point>& estimates, double cutoff,
                         double order) {
    const bool less = objects.size() <= estimates.size();
    const Assigned best =
        less ? assigned(objects, estimates, cutoff, order) : assigned(estimates, objects, cutoff, order);
    const auto m = static_cast<double>(std::min(objects.size(), estimates.size()));
    const auto n = static_cast<double>(std::max(objects.size(), estimates.size()));
    const auto root = [&](double power) { return cutoff * std::pow(power, 1 / order); };
    SetDistance out;
    out.missed = static_cast<std::int64_t>(objects.size()) - best.pairs;
    out.false_ones = static_cast<std::int64_t>(estimates.size()) - best.pairs;
    if (n == 0) return out;
    const double within = best.localisation + (m - static_cast<double>(best.pairs));
    out.ospa = root((within + (n - m)) / n);
    out.ospa_localisation = root(within / n);
    out.ospa_cardinality = root((n - m) / n);
    const double missed = static_cast<double>(out.missed) / 2, false_ones = static_cast<double>(out.false_ones) / 2;
    out.gospa = root(best.localisation + missed + false_ones);
    out.gospa_localisation = root(best.localisation);
    out.gospa_missed = root(missed);
    out.gospa_false = root(false_ones);
    return out;
}

}  // namespace ospa
