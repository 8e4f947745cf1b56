/// One track, and the records of all.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <pelorus/abi/message.h>

#include "measurement_grid.hpp"

namespace point_target {

inline std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

/// What is kept of a track besides its estimator record.
struct Track {
    std::uint64_t id = 0;
    std::int32_t status = PLR_TRACK_TENTATIVE;
    bool has_record = true;                ///< false: a single point that waits for a second one
    bool told = false;                     ///< some entry of it has been published
    std::int64_t time = 0;                 ///< ns, of the record
    std::int64_t seen = 0;                 ///< ns, of the last measurement
    Point place{};                         ///< at that time, m
    double deviation = 0;                  ///< of the place, m
    std::array<double, 9> covariance{};    ///< of the place, of a single point
    std::int32_t hits = 1, scans = 1;      ///< measurements taken, and scans since the first of them
    std::int32_t misses = 0;               ///< scans in a row without a measurement
    std::array<std::uint64_t, 2> begun{};  ///< ids of the measurements that it began with: one, or two of a hypothesis

    bool confirmed() const noexcept { return status != PLR_TRACK_TENTATIVE; }
    template <class Archive> void state(Archive& archive) {
        archive(id, status, has_record, told, time, seen, place, deviation, covariance, hits, scans, misses, begun);
    }
};

/// Tracks in ascending order of id, with their records side by side.
class TrackStore {
public:
    void setup(std::size_t record_size) { record_size_ = record_size; }
    std::size_t size() const noexcept { return tracks_.size(); }
    Track& operator[](std::size_t i) noexcept { return tracks_[i]; }
    const Track& operator[](std::size_t i) const noexcept { return tracks_[i]; }
    double* record(std::size_t i) noexcept { return records_.data() + i * record_size_; }

    void add(const Track& track, const double* record) {
        tracks_.push_back(track);
        if (record != nullptr)
            records_.insert(records_.end(), record, record + record_size_);
        else
            records_.resize(records_.size() + record_size_, 0.0);
    }
    /// Takes those out that are marked (by index).
    void remove(const std::vector<char>& marked) {
        std::size_t to = 0;
        for (std::size_t i = 0; i < tracks_.size(); ++i) {
            if (marked[i] != 0) continue;
            if (to != i) {
                tracks_[to] = tracks_[i];
                std::copy(record(i), record(i) + record_size_, record(to));
            }
            ++to;
        }
        tracks_.resize(to);
        records_.resize(to * record_size_);
    }
    template <class Archive> void state(Archive& archive) { archive(tracks_, records_); }

private:
    std::size_t record_size_ = 0;
    std::vector<Track> tracks_;
    std::vector<double> records_;
};

}  // namespace point_target
