// Which cell is whose: how tracker.group brings its groups to the cells of a scan.
#include <map>

#include "association.hpp"
#include "group_tracker.hpp"

namespace group {

namespace {

/// Pairs that have neither side yet.
std::vector<Pair> open_pairs(const std::vector<Pair>& pairs, const CellOfTrack& taken) {
    std::vector<Pair> open;
    for (const Pair& pair : pairs) {
        bool is_open = !taken[pair.left];
        for (const auto& cell : taken) is_open = is_open && cell != pair.right;
        if (is_open) open.push_back(pair);
    }
    return open;
}

void take_nearest(std::vector<Pair> pairs, CellOfTrack& out) {
    for (const Pair& pair : nearest_first(std::move(pairs))) out[pair.left] = pair.right;
}

}  // namespace

CellOfTrack GroupTracker::cells_of_tracks(const Points& points, const Predictions& expected,
                                          const std::vector<Cell>& cells) const {
    CellOfTrack out(tracks_.size());
    if (by_ == Association::by_partitioner) {
        for (std::size_t c = 0; c < cells.size(); ++c)
            if (cells[c].prediction >= 0) out[static_cast<std::size_t>(cells[c].prediction)] = c;
        return out;
    }
    if (by_ == Association::members) take_nearest(pairs_by_members(points, expected, cells), out);
    take_nearest(open_pairs(pairs_by_centre(points, expected, cells), out), out);
    return out;
}

/// By e' (H P H' + mean R)^-1 e of the plain centres, within the gate.
std::vector<Pair> GroupTracker::pairs_by_centre(const Points& points, const Predictions& expected,
                                                const std::vector<Cell>& cells) const {
    const int d = filter_->dimension();
    std::vector<Pair> pairs;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const Points members = points.some(cells[c].members);
        const Eigen::VectorXd centre = members.centroid();
        const Eigen::MatrixXd noise = members.mean_noise();
        for (std::size_t k = 0; k < tracks_.size(); ++k) {
            const double squared = squared_distance(centre - expected.position(k, d), expected.spread(k, d) + noise);
            if (squared < gate_) pairs.push_back({k, c, squared});
        }
    }
    return pairs;
}

/// By how many of the members that a group had in the last scan are in a cell now, most first. Each is carried on as the group's centre
/// has moved, and is the nearest point there, within the gate of both points' noise, H P H' and a quarter of the extent: which member it is
/// does not matter, and a centre that has jumped, because members came or went, tells little of where they move.
std::vector<Pair> GroupTracker::pairs_by_members(const Points& points, const Predictions& expected,
                                                 const std::vector<Cell>& cells) const {
    const int d = filter_->dimension();
    std::vector<std::size_t> cell_of_point(points.ids.size());
    for (std::size_t c = 0; c < cells.size(); ++c)
        for (const std::size_t member : cells[c].members) cell_of_point[member] = c;
    std::vector<Pair> pairs;
    for (std::size_t k = 0; k < tracks_.size(); ++k) {
        const Points before = lineage_.members_of(tracks_[k].id);
        const Eigen::VectorXd shift = expected.position(k, d) - tracks_[k].centre;
        const Eigen::MatrixXd spread = expected.spread(k, d) + expected.shape(k, d) / 4;
        std::map<std::size_t, double> votes;
        for (std::size_t m = 0; m < before.ids.size(); ++m) {
            const auto heir = nearest_point(before.position(m) + shift, before.noise_of(m) + spread, points, gate_);
            if (heir) votes[cell_of_point[*heir]] += 1;
        }
        for (const auto& [cell, count] : votes) pairs.push_back({k, cell, -count});
    }
    return pairs;
}

}  // namespace group
