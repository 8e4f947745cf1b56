/// Where groups come from: whose members a new group's members were, before it began.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "starts.hpp"

namespace group {

/// The points of a scan, and the groups that they were members of.
struct Sighting {
    Points points;
    std::vector<std::vector<std::uint64_t>> owners;  ///< of each point: ids of groups, ascending
    template <class Archive> void state(Archive& archive) { archive(points, owners); }
};

class Lineage {
public:
    /// `gate`: squared statistical distance within which a point may be the one that another has become.
    void setup(double gate) { gate_ = gate; }

    void see(Sighting&& newest);

    /// Ids of the groups that the members of a start were members of in the scan before its first centre, ascending. Each member is
    /// carried back by the start's velocity to that scan and is the nearest point there, if one is within the gate.
    std::vector<std::uint64_t> parents_of(const Start& start) const;

    /// The points of the last scan that were a group's.
    Points members_of(std::uint64_t id) const;

    template <class Archive> void state(Archive& archive) { archive(seen_); }
    bool is_of(int dimension, std::size_t sensors) const;

private:
    const Sighting* before(std::int64_t time) const;

    double gate_ = 0;
    std::deque<Sighting> seen_;  ///< of the last times, oldest first: those that a start spans and the one before
};

/// The owner of the point that is nearest, within the gate; 0: none. `distances`: squared, of each point.
std::uint64_t owner_of_nearest(const Sighting& sighting, const std::vector<double>& distances, double gate);

}  // namespace group
