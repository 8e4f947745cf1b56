/// What trackers are tried with: one that has seen a feed, and how what it told compares with the targets that were there.
#pragma once

#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

/// An entry of a tracks message, and the tick in which it was told.
struct Entry {
    std::int64_t tick, time;
    std::uint64_t id;
    std::int32_t status, misses;
    std::vector<std::uint64_t> used;
    bool has_list;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    std::vector<std::string> components;
};

bool is_told(const Entry& entry);
/// For messages.
std::string name_of(const Entry& entry);

/// A tracker that has seen a feed.
struct Tracked {
    Tracked(const Bench& bench, const FeedOptions& options, Sample sample);

    StagePlayer player;
    Feed feed;
    std::vector<Entry> entries;
    std::set<std::uint64_t> received;
};

/// Targets without clutter; `gone` on, none is there any more.
FeedOptions quiet(int targets, std::int64_t ticks, std::int64_t gone = INT64_MAX);

/// The position of an entry in the world's axes, those that it has, and its covariance.
void position_of(const Entry& entry, std::vector<int>& axes, Eigen::VectorXd& mean, Eigen::MatrixXd& covariance);

/// The target that an entry is nearest to, and how far it is from it.
int nearest_target(const Feed& feed, const Entry& entry, int targets, double& distance);

/// Whether one entry used measurements of several targets: all of a scan are one extended target to this tracker.
bool takes_all_for_one(const Tracked& tracked);

/// How far a track may be from the target that it follows, in m: ten deviations of a range at 10 km and of an angle there, and the
/// errors of a start. Where no sensor tells the whole position (bearings alone), six deviations of the track's own come on top.
double largest_error(const Tracked& tracked, const Entry& entry);

/// How many sensors' scans a tracker takes; 0: it lives on other trackers' tracks.
std::size_t sensors_of(const Bench& bench);

}  // namespace pelorus::conformance
