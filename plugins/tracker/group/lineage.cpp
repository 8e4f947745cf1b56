#include "lineage.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "association.hpp"

namespace group {

void Lineage::see(Sighting&& newest) {
    constexpr std::size_t kept = 3;  // the first two scans of a start, and the one before them
    seen_.push_back(std::move(newest));
    if (seen_.size() > kept) seen_.pop_front();
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
        std::vector<double> distances;
        for (std::size_t p = 0; p < then->points.ids.size(); ++p)
            distances.push_back(squared_distance(then->points.position(p) - was, spread + then->points.noise_of(p)));
        const auto nearest = std::min_element(distances.begin(), distances.end());
        if (nearest == distances.end() || !(*nearest < gate_)) continue;
        const auto& owners = then->owners[static_cast<std::size_t>(nearest - distances.begin())];
        parents.insert(owners.begin(), owners.end());
    }
    return {parents.begin(), parents.end()};
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
