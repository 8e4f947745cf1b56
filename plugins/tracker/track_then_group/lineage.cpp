#include "lineage.hpp"

#include <algorithm>
#include <tuple>

namespace track_then_group {

Ids Lineage::update(std::int64_t time, const std::vector<Ids>& components) {
    forget_missing(components);
    Ids groups(components.size(), 0);
    match(components, false, groups);
    match(components, true, groups);
    begin_groups(components, groups);
    note_parents(components, groups);
    settle_homes(components, groups);
    settle_groups(time, groups);
    return groups;
}

Ids Lineage::parents(std::uint64_t group) const {
    const auto found = groups_.find(group);
    return found == groups_.end() ? Ids{} : Ids(found->second.parents.begin(), found->second.parents.end());
}

void Lineage::forget_missing(const std::vector<Ids>& components) {
    std::map<std::uint64_t, Track> present;
    for (const Ids& component : components)
        for (const std::uint64_t id : component)
            if (const auto known = tracks_.find(id); known != tracks_.end()) present.insert(*known);
    tracks_ = std::move(present);
}

/// Gives components that have no group yet those groups, absorbed or not, that are most at home in them.
void Lineage::match(const std::vector<Ids>& components, bool absorbed, Ids& groups) const {
    std::map<std::uint64_t, std::size_t> sizes;  // tracks at home in each group
    for (const auto& [id, track] : tracks_) ++sizes[track.home];
    struct Overlap {
        std::size_t count;
        std::uint64_t group;
        std::size_t component;
    };
    std::vector<Overlap> overlaps;
    for (std::size_t c = 0; c < components.size(); ++c) {
        if (groups[c] != 0) continue;
        std::map<std::uint64_t, std::size_t> counts;
        for (const std::uint64_t id : components[c])
            if (const auto known = tracks_.find(id); known != tracks_.end()) ++counts[known->second.home];
        for (const auto& [group, count] : counts) {
            const auto known = groups_.find(group);
            if (known == groups_.end() || known->second.absorbed.has_value() != absorbed) continue;
            if (absorbed && (2 * count <= sizes[group] || 2 * count < components[c].size())) continue;
            overlaps.push_back({count, group, c});
        }
    }
    std::sort(overlaps.begin(), overlaps.end(), [](const Overlap& a, const Overlap& b) {
        return std::make_tuple(b.count, a.group, a.component) < std::make_tuple(a.count, b.group, b.component);
    });
    std::set<std::uint64_t> given;
    for (const Overlap& overlap : overlaps)
        if (groups[overlap.component] == 0 && given.insert(overlap.group).second)
            groups[overlap.component] = overlap.group;
}

void Lineage::begin_groups(const std::vector<Ids>& components, Ids& groups) {
    for (std::size_t c = 0; c < components.size(); ++c) {
        if (groups[c] != 0) continue;
        groups[c] = next_id_++;
        groups_[groups[c]] = {};
        for (const std::uint64_t id : components[c]) tracks_[id].home = groups[c];
    }
}

/// A group's parents are the groups that its members were in before, but for those members that come home.
void Lineage::note_parents(const std::vector<Ids>& components, const Ids& groups) {
    for (std::size_t c = 0; c < components.size(); ++c) {
        Group& group = groups_[groups[c]];
        const bool is_back = group.absorbed.has_value();
        for (const std::uint64_t id : components[c]) {
            const auto known = tracks_.find(id);
            if (known == tracks_.end() || known->second.group == 0 || known->second.group == groups[c]) continue;
            if (is_back && known->second.home == groups[c]) continue;
            group.parents.insert(known->second.group);
        }
    }
}

/// A track is at home where it is, unless its home has been absorbed as a whole.
void Lineage::settle_homes(const std::vector<Ids>& components, const Ids& groups) {
    const std::set<std::uint64_t> by_themselves(groups.begin(), groups.end());
    for (std::size_t c = 0; c < components.size(); ++c)
        for (const std::uint64_t id : components[c]) {
            Track& track = tracks_[id];
            track.group = groups[c];
            if (track.home == 0 || by_themselves.count(track.home) != 0) track.home = groups[c];
        }
}

void Lineage::settle_groups(std::int64_t time, const Ids& groups) {
    std::set<std::uint64_t> homes;
    for (const auto& [id, track] : tracks_) homes.insert(track.home);
    const std::set<std::uint64_t> by_themselves(groups.begin(), groups.end());
    ended_.clear();
    for (auto at = groups_.begin(); at != groups_.end();) {
        Group& group = at->second;
        if (by_themselves.count(at->first) != 0) {
            group.absorbed.reset();
        } else if (!group.absorbed) {
            group.absorbed = time;
        }
        if (group.absorbed && (homes.count(at->first) == 0 || time - *group.absorbed >= memory_)) {
            ended_.push_back(at->first);
            at = groups_.erase(at);
        } else {
            ++at;
        }
    }
    for (auto& [id, track] : tracks_)
        if (groups_.count(track.home) == 0) track.home = track.group;
}

}  // namespace track_then_group
