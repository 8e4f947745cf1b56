/// Cells of a scan, as the tracker's partitioner makes them.
#pragma once

#include <cstdint>
#include <vector>

#include <pelorus/abi/parallel.h>
#include <pelorus/caller.hpp>
#include <pelorus/parts.hpp>

#include "../../common/extended/points.hpp"
#include "../../common/partition/request.hpp"

namespace group {

using extended::Points;

/// Groups as they are expected at the time of a scan.
struct Predictions {
    std::vector<std::uint64_t> ids;
    std::vector<double> mean;        ///< d x n, m
    std::vector<double> covariance;  ///< d x d x n, m^2: H P H'
    std::vector<double> extent;      ///< d x d x n, m^2

    std::int64_t count() const noexcept { return static_cast<std::int64_t>(ids.size()); }
    void add(std::uint64_t id, const Eigen::VectorXd& position, const Eigen::MatrixXd& spread,
             const Eigen::MatrixXd& shape);
    Eigen::VectorXd position(std::size_t k, int dimension) const;
    Eigen::MatrixXd spread(std::size_t k, int dimension) const;
    Eigen::MatrixXd shape(std::size_t k, int dimension) const;
};

struct Cell {
    std::int64_t prediction = -1;      ///< index; -1: of none
    std::vector<std::size_t> members;  ///< indices of points
    std::vector<double> weights;       ///< of each member, sum 1
};

/// Calls a partitioner, with memory that grows with what it asks for.
class Cells {
public:
    /// `parallel`: of the host, or nullptr.
    void setup(const pelorus::PartitionerPart& partitioner, const plr_parallel* parallel);

    /// The cells of the likeliest partition, in the partitioner's order.
    std::vector<Cell> split(pelorus::Caller& caller, const plr_call& context, const Points& points,
                            const Predictions& predictions);

private:
    std::vector<Cell> likeliest() const;

    pelorus::PartitionerPart partitioner_;
    const plr_parallel* parallel_ = nullptr;
    partition::Request request_;
};

}  // namespace group
