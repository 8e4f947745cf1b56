/// tracker.group: groups of objects that are close together, each followed as one target with a shape. See README.md.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/innovations.hpp>
#include <pelorus/stage.hpp>

#include "../../common/extended/target_filter.hpp"
#include "association.hpp"
#include "cells.hpp"
#include "lineage.hpp"
#include "starts.hpp"

namespace group {

using extended::Look;
using extended::Moments;
using extended::Records;

enum class Association { by_partitioner, nearest, members };
enum class CentroidNoise { mean, effective };

struct Parameters {
    std::optional<double> threshold;  // m
    std::optional<Association> association;
    double gate_probability = 0.99, start_gate_probability = 0.99;
    double maximum_speed = 0;       // m/s
    double start_acceleration = 0;  // m/s2
    CentroidNoise centroid_noise = CentroidNoise::mean;
    int misses_to_delete = 5;
    double duplicate_distance = 0;  // m
};

/// The cell of each track, an index; none: it has none.
using CellOfTrack = std::vector<std::optional<std::size_t>>;

/// A group that is followed.
struct Track {
    std::uint64_t id = 0;
    std::int64_t time = 0;  ///< ns
    std::int32_t misses = 0;
    std::vector<std::uint64_t> parents;       ///< groups that it came from or that it absorbed, ascending
    std::uint64_t absorber = 0;               ///< group that has taken what is near, since it misses; 0: none
    std::vector<std::uint64_t> measurements;  ///< of its members in this scan; not saved
    bool is_lost = false;                     ///< it is told once more; not saved
    Eigen::VectorXd centre;                   ///< before the last prediction; not saved
    Records records;
    template <class Archive> void state(Archive& archive) { archive(id, time, misses, parents, absorber, records); }
};

class GroupTracker : public pelorus::Stage<GroupTracker>, public Parameters {
public:
    static constexpr const char* kind = "tracker";
    enum Port : std::uint32_t { scans, inputs };           // in
    enum OutPort : std::uint32_t { tracks, innovations };  // out

    static void describe(pelorus::Describe<GroupTracker>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const;

    void on_values(const pelorus::Event& event, const plr_values& values);
    void on_scan(const pelorus::Event& event, const plr_scan& scan);

    template <class Archive> void state(Archive& archive) {
        std::uint32_t layout = filter_->record_version();
        archive(layout, step_, next_id_, newest_, tracks_, starts_, lineage_, caller_);
        if constexpr (Archive::reading) check_state(layout);
    }

private:
    void setup_filter(const pelorus::Setup& setup);
    void setup_threshold(const pelorus::PartitionerPart& partitioner);

    Points points_of(std::int64_t time, const plr_scan& scan);
    void predict(std::int64_t time);
    Predictions predictions() const;
    void update(const Points& points);
    CellOfTrack cells_of_tracks(const Points& points, const Predictions& expected,
                                const std::vector<Cell>& cells) const;
    std::vector<Pair> pairs_by_centre(const Points& points, const Predictions& expected,
                                      const std::vector<Cell>& cells) const;
    std::vector<Pair> pairs_by_members(const Points& points, const Predictions& expected,
                                       const std::vector<Cell>& cells) const;
    void take(Track& track, const Points& points, const Cell& cell, Sighting& sighting);
    void miss(Track& track, const Sighting& sighting);
    void begin(const Points& points, const std::vector<Cell>& cells, const std::vector<bool>& is_taken,
               Sighting& sighting);
    void begin_one(const Start& start, const std::vector<Cell>& cells, Sighting& sighting);
    Records start_records(const Look& look, const Start& start) const;
    Moments start_moments(const Start& start) const;
    void merge_duplicates();
    void end();

    /// While `failure` is being handled: it ends the track, or goes on if it is not one of numbers.
    void give_up(Track& track, const pelorus::Failure& failure);
    void absorb(std::uint64_t survivor, std::uint64_t absorbed);
    void tell(const Track& track, std::int32_t status);
    Look look_at(const Track& track) const;
    void count(const char* name, std::int64_t by) const;
    void warn(const std::string& line) const;
    void check_state(std::uint32_t layout) const;

    std::unique_ptr<extended::TargetFilter> filter_;
    Cells cells_;
    mutable pelorus::Caller caller_;
    std::unique_ptr<pelorus::TracksBuilder> told_;
    pelorus::InnovationsBuilder innovations_;
    const plr_random* random_ = nullptr;
    const plr_diagnostics* diagnostics_ = nullptr;
    const plr_log* log_ = nullptr;
    plr_key key_{};
    std::string frame_;
    double gate_ = 0;
    Association by_ = Association::nearest;

    // What save keeps.
    std::uint64_t step_ = 0, next_id_ = 1;
    std::int64_t newest_ = INT64_MIN;  ///< ns, of the last scan
    std::vector<Track> tracks_;        ///< by id
    Starts starts_;
    Lineage lineage_;
};

}  // namespace group
