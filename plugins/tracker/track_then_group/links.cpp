#include "links.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "../../common/assignment/clusters.hpp"

namespace track_then_group {

namespace {

double squared_distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();

/// Index of the member of that id, or `nobody`.
std::size_t place_of(const std::vector<Member>& members, std::uint64_t id) {
    const auto at = std::lower_bound(members.begin(), members.end(), id,
                                     [](const Member& member, std::uint64_t wanted) { return member.id < wanted; });
    return at != members.end() && at->id == id ? static_cast<std::size_t>(at - members.begin()) : nobody;
}

std::size_t longest_axis(const std::vector<Member>& members) {
    std::size_t best = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto [least, most] =
            std::minmax_element(members.begin(), members.end(),
                                [&](const Member& a, const Member& b) { return a.position[k] < b.position[k]; });
        if (const double span = most->position[k] - least->position[k]; span > longest) longest = span, best = k;
    }
    return best;
}

}  // namespace

std::vector<IndexPair> near_pairs(const std::vector<Member>& members, double distance) {
    std::vector<IndexPair> pairs;
    if (members.size() < 2) return pairs;
    const std::size_t axis = longest_axis(members);
    const auto along = [&](std::size_t i) { return members[i].position[axis]; };
    std::vector<std::size_t> order(members.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return along(a) != along(b) ? along(a) < along(b) : a < b; });
    for (std::size_t i = 0; i < order.size(); ++i)
        for (std::size_t j = i + 1; j < order.size() && along(order[j]) - along(order[i]) < distance; ++j)
            if (squared_distance(members[order[i]].position, members[order[j]].position) < distance * distance)
                pairs.push_back(std::minmax(order[i], order[j]));
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

bool Links::is_within(const Member& a, const Member& b, double scale) const {
    const double reach = scale * rule_.threshold;
    if (!(squared_distance(a.position, b.position) < reach * reach)) return false;
    if (!rule_.velocity_threshold) return true;
    const double most = scale * *rule_.velocity_threshold;
    return squared_distance(a.velocity, b.velocity) < most * most;
}

/// Notes that the contrary of the pair's state holds; whether it has lasted long enough.
bool Links::has_turned(Pair& pair, std::int64_t time) const {
    if (!pair.turning) pair.since = time;
    pair.turning = true;
    return time - pair.since >= rule_.persistence;
}

std::vector<IndexPair> Links::update(std::int64_t time, const std::vector<Member>& members) {
    std::map<Ids, Pair> next;
    for (const auto& [i, j] : near_pairs(members, (1 + rule_.hysteresis) * rule_.threshold)) {
        if (!is_within(members[i], members[j], 1 + rule_.hysteresis)) continue;
        const Ids ids{members[i].id, members[j].id};
        const auto known = pairs_.find(ids);
        Pair pair = known == pairs_.end() ? Pair{} : known->second;
        if (pair.linked)
            pair.turning = false;
        else if (!pair.turning && !is_within(members[i], members[j], 1 - rule_.hysteresis))
            continue;
        else if (has_turned(pair, time))
            pair = {true, false, 0};
        next.emplace(ids, pair);
    }
    for (auto& [ids, pair] : pairs_) {
        if (!pair.linked || next.count(ids) != 0) continue;
        if (place_of(members, ids.first) == nobody || place_of(members, ids.second) == nobody) continue;
        if (!has_turned(pair, time)) next.emplace(ids, pair);
    }
    pairs_ = std::move(next);

    std::vector<IndexPair> linked;
    for (const auto& [ids, pair] : pairs_)
        if (pair.linked) linked.emplace_back(place_of(members, ids.first), place_of(members, ids.second));
    return linked;
}

std::vector<std::vector<std::size_t>> components(std::size_t size, const std::vector<IndexPair>& pairs) {
    assignment::Components joined(size);
    for (const auto& [i, j] : pairs) joined.join(i, j);
    std::vector<std::size_t> place(size, nobody);
    std::vector<std::vector<std::size_t>> out;
    for (std::size_t i = 0; i < size; ++i) {
        std::size_t& at = place[joined.root(i)];
        if (at == nobody) {
            at = out.size();
            out.emplace_back();
        }
        out[at].push_back(i);
    }
    return out;
}

}  // namespace track_then_group
