/// The record of a track that a message tells of, for a stage that follows tracks with an estimator like their tracker's.
#pragma once

#include <numeric>
#include <string>
#include <vector>

#include "filter.hpp"

namespace one_track {

/// The tracker's own record where it is told; else one made of the moments, which lacks what a filter remembers besides. Throws
/// DataError for a record of another estimator.
inline Record told_record(Filter& filter, const plr_tracks& tracks, std::int64_t entry, plr_key key) {
    if (tracks.records.data == nullptr) {
        std::vector<std::int32_t> all(static_cast<std::size_t>(filter.cartesian().size()));
        std::iota(all.begin(), all.end(), 0);
        return filter.init({tracks.times[entry], tracks.ids[entry], key}, all,
                           {pelorus::item(tracks.mean, entry), pelorus::item(tracks.covariance, entry)});
    }
    const std::string theirs = tracks.record_of == nullptr ? "?" : tracks.record_of, ours = filter.estimator().id();
    if (theirs != ours || tracks.record_version != filter.record_version() ||
        tracks.records.rows != static_cast<std::int64_t>(filter.record_size()))
        throw pelorus::DataError("the tracks' records are of " + theirs + ", version " +
                                 std::to_string(tracks.record_version) + ", " + std::to_string(tracks.records.rows) +
                                 " numbers; this scheduler's estimator is " + ours + ", version " +
                                 std::to_string(filter.record_version()) + ", " + std::to_string(filter.record_size()) +
                                 " numbers: write it like: tracker.estimator");
    const Eigen::MatrixXd record = pelorus::item(tracks.records, entry);
    return {record.data(), record.data() + record.size()};
}

}  // namespace one_track
