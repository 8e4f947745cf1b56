#include "association.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "../../common/assignment/assignment.hpp"
#include "../../common/assignment/clusters.hpp"

namespace point_target {

namespace {

/// Numbers what it meets in the order of meeting.
class Numbering {
public:
    std::size_t of(std::size_t name) { return numbers_.emplace(name, numbers_.size()).first->second; }
    std::size_t size() const noexcept { return numbers_.size(); }

private:
    std::map<std::size_t, std::size_t> numbers_;
};

void solve(const std::vector<GatedPair>& pairs, const std::vector<std::size_t>& cluster, double gate,
           std::vector<std::size_t>& chosen) {
    if (cluster.size() == 1) return chosen.push_back(cluster.front());
    Numbering rows, columns;
    double largest = -std::numeric_limits<double>::infinity();
    for (const std::size_t i : cluster) {
        rows.of(pairs[i].track);
        columns.of(pairs[i].detection);
        largest = std::max(largest, pairs[i].log_determinant);
    }
    std::vector<double> costs(rows.size() * columns.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> pair_at(costs.size());
    for (const std::size_t i : cluster) {
        const std::size_t at = rows.of(pairs[i].track) * columns.size() + columns.of(pairs[i].detection);
        // Counted from what none costs: numbers stay small, and none costs 0.
        costs[at] = pairs[i].distance - gate + (pairs[i].log_determinant - largest);
        pair_at[at] = i;
    }
    const auto answer = assignment::assign(static_cast<std::int64_t>(rows.size()),
                                           static_cast<std::int64_t>(columns.size()), costs, 0.0);
    for (std::size_t row = 0; row < answer.size(); ++row)
        if (answer[row] != assignment::unassigned)
            chosen.push_back(pair_at[row * columns.size() + static_cast<std::size_t>(answer[row])]);
}

}  // namespace

std::vector<std::size_t> associate(const std::vector<GatedPair>& pairs, double gate) {
    std::vector<std::size_t> chosen;
    for (const auto& cluster : assignment::clusters(pairs)) solve(pairs, cluster, gate, chosen);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

}  // namespace point_target
