#include "lineage.hpp"

#include <algorithm>
#include <set>

#include "association.hpp"

namespace group {

void Lineage::see(Sighting&& newest) {
    constexpr std::size_t kept = 3;  // those of the first two scans of a start, and the one before them
    seen_.push_back(std::move(newest));
    // Of sensors that look at one time a start takes one scan only: times are counted, not scans.
    const auto times = [this] {
        std::set<std::int64_t> all;
        for (const Sighting& sighting : seen_) all.insert(sighting.points.time);
        return all.size();
    };
    while (times() > kept) seen_.pop_front();
}

const Sighting* Lineage::before(std::int64_t time) const {
    const Sighting* found = nullptr;
    for (const Sighting& sighting : seen_)
        if (sighting.points.time < time) found = &sighting;
    return found;
}

/// With r = T01/T13 the point of before is z1 - r (z3 - z1), of covariance (1 + r)^2 R1 + r^2 R3.
std::vector<std::uint64_t> Lineage::parents_of(const Start& start) const {
    const Points& first = start.first.points;
    const Sighting* const then = before(first.time);
    if (then == nullptr) return {};
    const double back = static_cast<double>(first.time - then->points.time) * 1e-9;
    const double ratio = back / (2 * start.half_time);
    std::set<std::uint64_t> parents;
    for (std::size_t k = 0; k < first.ids.size(); ++k) {
        const Eigen::VectorXd was = first.position(k) - back * start.velocity;
        const Eigen::MatrixXd spread =
            (1 + ratio) * (1 + ratio) * first.noise_of(k) + ratio * ratio * start.third.noise;
        const auto nearest = nearest_point(was, spread, then->points, gate_);
        if (!nearest) continue;
        const auto& owners = then->owners[*nearest];
        parents.insert(owners.begin(), owners.end());
    }
    return {parents.begin(), parents.end()};
}

Points Lineage::members_of(std::uint64_t id) const {
    if (seen_.empty()) return {};
    const Sighting& last = seen_.back();
    std::vector<std::size_t> members;
    for (std::size_t k = 0; k < last.owners.size(); ++k)
        if (std::find(last.owners[k].begin(), last.owners[k].end(), id) != last.owners[k].end()) members.push_back(k);
    return last.points.some(members);
}

bool Lineage::is_of(int dimension, std::size_t sensors) const {
    return std::all_of(seen_.begin(), seen_.end(), [&](const Sighting& sighting) {
        return sighting.points.is_of(dimension, sensors) && sighting.owners.size() == sighting.points.ids.size();
    });
}

std::uint64_t owner_of_nearest(const Sighting& sighting, const std::vector<double>& distances, double gate) {
    std::uint64_t owner = 0;
    double least = gate;
    for (std::size_t k = 0; k < distances.size(); ++k) {
        if (!(distances[k] < least) || sighting.owners[k].empty()) continue;
        least = distances[k];
        owner = sighting.owners[k].front();
    }
    return owner;
}

}  // namespace group
