/// The call of a partitioner: with plausible arguments for the checks of all models, with given ones for its own.
#pragma once

#include <vector>

#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance {

/// One scan: columns are points, and predictions.
struct ScanToSplit {
    Eigen::MatrixXd points;                   ///< d x M
    std::vector<Eigen::MatrixXd> covariance;  ///< empty: not known
    std::vector<std::uint64_t> ids;           ///< of predictions
    Eigen::MatrixXd mean;                     ///< d x predictions
    std::vector<Eigen::MatrixXd> mean_covariance, extent;
};

/// What a partitioner answered, out of the buffers.
struct Partition {
    std::vector<std::int64_t> alternative_offsets, cell_offsets, cell_predictions, member_points;
    std::vector<double> alternative_weights, member_weights;
};

struct Capacities {
    std::int64_t alternatives = 0, cells = 0, members = 0;
};

class PartitionerCalls {
public:
    explicit PartitionerCalls(const Instance& instance_)
        : instance(instance_), table(instance_.table<plr_partitioner>()), info(*table.info(instance_.self())) {}

    /// Outputs: what is told (alternatives, cells, members), then the six buffers. Whole numbers lie in them as they are.
    HotCall split(const ScanToSplit& scan, const Capacities& capacities, const plr_parallel* parallel = nullptr) const;
    /// What the partitioner says that it needs for a scan. Fails the check if it does not say it.
    Capacities needed(const ScanToSplit& scan) const;
    /// Fails the check unless a split with buffers of just the size needed goes well.
    Partition partition(const ScanToSplit& scan, const plr_parallel* parallel = nullptr) const;
    static Capacities told(const Execution& done);

    const Instance& instance;
    const plr_partitioner& table;
    const plr_partitioner_info& info;
};

/// Some groups of points and some points that stand alone, in d dimensions, with predictions near some of the groups.
ScanToSplit sample_scan_to_split(int dimension, std::int64_t points, std::int64_t predictions, Sample& sample);

}  // namespace pelorus::conformance
