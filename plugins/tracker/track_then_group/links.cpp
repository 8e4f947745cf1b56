#include "links.hpp"

#include <algorithm>
#include <limits>

#include <pelorus/matrix.hpp>

#include "../../common/assignment/clusters.hpp"
#include "../../common/partition/grid.hpp"

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

}  // namespace

std::vector<IndexPair> near_pairs(const std::vector<Member>& members, double distance) {
    std::vector<IndexPair> pairs;
    if (members.size() < 2) return pairs;
    std::vector<double> places;
    for (const Member& member : members) places.insert(places.end(), member.position.begin(), member.position.end());
    const auto count = static_cast<std::int64_t>(members.size());
    std::vector<unsigned char> block(partition::Grid<3>::need().bytes(count));
    partition::Memory memory(block.data(), block.size());
    const partition::Grid<3> grid(memory, pelorus::const_view(places.data(), 3, 1, count), distance);
    const auto compare = [&](std::uint32_t k, std::uint32_t other) {
        const std::size_t a = grid.point(k), b = grid.point(other);
        if (squared_distance(members[a].position, members[b].position) < distance * distance)
            pairs.push_back(std::minmax(a, b));
    };
    for (std::uint32_t cell = 0; cell < grid.cell_count(); ++cell)
        for (std::uint32_t k = grid.begin(cell); k < grid.end(cell); ++k)
            for (std::uint32_t other = k + 1; other < grid.end(cell); ++other) compare(k, other);
    grid.for_near_cells(0, grid.cell_count(), [&](std::uint32_t cell, std::uint32_t near) {
        for (std::uint32_t k = grid.begin(cell); k < grid.end(cell); ++k)
            for (std::uint32_t other = grid.begin(near); other < grid.end(near); ++other) compare(k, other);
    });
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
