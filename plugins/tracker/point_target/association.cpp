#include "association.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "../../common/assignment/assignment.hpp"

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

/// Connected components by union and find.
class Components {
public:
    explicit Components(std::size_t size) : parent_(size) {
        for (std::size_t i = 0; i < size; ++i) parent_[i] = i;
    }
    std::size_t root(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) {
        a = root(a), b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::size_t> parent_;
};

/// Indices of the pairs of each cluster, clusters in the order of their first track.
std::vector<std::vector<std::size_t>> clusters(const std::vector<GatedPair>& pairs) {
    std::size_t most = 0;
    for (const GatedPair& pair : pairs) most = std::max(most, pair.detection + 1);
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    Components components(pairs.size());
    std::vector<std::size_t> first_of(most, none);  // a pair of each detection
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (i > 0 && pairs[i - 1].track == pairs[i].track) components.join(i - 1, i);
        std::size_t& first = first_of[pairs[i].detection];
        if (first == none)
            first = i;
        else
            components.join(first, i);
    }
    std::vector<std::vector<std::size_t>> out;
    std::vector<std::size_t> place(pairs.size(), none);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const std::size_t root = components.root(i);
        if (place[root] == none) {
            place[root] = out.size();
            out.emplace_back();
        }
        out[place[root]].push_back(i);
    }
    return out;
}

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
    for (const auto& cluster : clusters(pairs)) solve(pairs, cluster, gate, chosen);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

}  // namespace point_target
