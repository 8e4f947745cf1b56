#include "cells.hpp"

#include <algorithm>
#include <string>

namespace group {

void Predictions::add(std::uint64_t id, const Eigen::VectorXd& position, const Eigen::MatrixXd& spread,
                      const Eigen::MatrixXd& shape) {
    ids.push_back(id);
    mean.insert(mean.end(), position.data(), position.data() + position.size());
    covariance.insert(covariance.end(), spread.data(), spread.data() + spread.size());
    extent.insert(extent.end(), shape.data(), shape.data() + shape.size());
}

Eigen::VectorXd Predictions::position(std::size_t k, int dimension) const {
    return Eigen::Map<const Eigen::VectorXd>(mean.data() + k * static_cast<std::size_t>(dimension), dimension);
}

Eigen::MatrixXd Predictions::spread(std::size_t k, int dimension) const {
    const auto square = static_cast<std::size_t>(dimension * dimension);
    return Eigen::Map<const Eigen::MatrixXd>(covariance.data() + k * square, dimension, dimension);
}

Eigen::MatrixXd Predictions::shape(std::size_t k, int dimension) const {
    const auto square = static_cast<std::size_t>(dimension * dimension);
    return Eigen::Map<const Eigen::MatrixXd>(extent.data() + k * square, dimension, dimension);
}

void Cells::setup(const pelorus::PartitionerPart& partitioner, const plr_parallel* parallel) {
    partitioner_ = partitioner;
    parallel_ = parallel;
    out_.struct_size = sizeof out_;
}

void Cells::reserve(std::int64_t alternatives, std::int64_t cells, std::int64_t members) {
    const auto grow = [](std::int64_t& capacity, std::int64_t wanted) { capacity = std::max(capacity, wanted); };
    grow(out_.alternative_capacity, alternatives);
    grow(out_.cell_capacity, cells);
    grow(out_.member_capacity, members);
    const auto size = [](std::int64_t n) { return static_cast<std::size_t>(n); };
    alternative_offsets_.resize(size(out_.alternative_capacity) + 1);
    alternative_weights_.resize(size(out_.alternative_capacity));
    cell_offsets_.resize(size(out_.cell_capacity) + 1);
    cell_predictions_.resize(size(out_.cell_capacity));
    member_points_.resize(size(out_.member_capacity));
    member_weights_.resize(size(out_.member_capacity));
    out_.alternative_offsets = alternative_offsets_.data();
    out_.alternative_weights = alternative_weights_.data();
    out_.cell_offsets = cell_offsets_.data();
    out_.cell_predictions = cell_predictions_.data();
    out_.member_points = member_points_.data();
    out_.member_weights = member_weights_.data();
}

plr_scratch Cells::scratch_for(std::int64_t points_and_predictions) {
    constexpr std::size_t line = 64;
    const plr_partitioner_info& info = partitioner_.info();
    const std::uint64_t bytes =
        info.scratch_bytes + info.scratch_bytes_point * static_cast<std::uint64_t>(points_and_predictions);
    if (scratch_.size() < bytes + line) scratch_.resize(static_cast<std::size_t>(bytes) + line);
    const std::size_t past = reinterpret_cast<std::uintptr_t>(scratch_.data()) % line;
    return {scratch_.data() + (line - past) % line, bytes, 0};
}

std::vector<Cell> Cells::split(pelorus::Caller& caller, const plr_call& context, const Points& points,
                               const Predictions& predictions) {
    const std::int64_t n = points.count(), d = points.dimension, count = predictions.count();
    if (n == 0) return {};
    auto args = pelorus::arguments<plr_partitioner_split>();
    args.points = pelorus::const_view(points.positions.data(), d, 1, n);
    args.covariance = pelorus::const_view(points.noise.data(), d, d, n);
    if (count > 0)
        args.predictions = {count, predictions.ids.data(), pelorus::const_view(predictions.mean.data(), d, 1, count),
                            pelorus::const_view(predictions.covariance.data(), d, d, count),
                            pelorus::const_view(predictions.extent.data(), d, d, count)};
    args.parallel = parallel_;
    args.out = &out_;
    plr_scratch scratch = scratch_for(n + count);
    plr_call call = context;
    call.scratch = &scratch;
    reserve(1, n + count, n);
    plr_status status = partitioner_.call(&plr_partitioner::split, call, args);
    if (status == PLR_E_CAPACITY) {  // overlap, or several alternatives
        reserve(out_.alternatives, out_.cells, out_.members);
        scratch.used = 0;
        call.error->code = PLR_OK;
        status = partitioner_.call(&plr_partitioner::split, call, args);
    }
    caller.require(status, "partitioner, split");
    return likeliest();
}

std::vector<Cell> Cells::likeliest() const {
    if (out_.alternatives == 0) return {};
    const auto last = alternative_weights_.begin() + out_.alternatives;
    const auto best =
        static_cast<std::size_t>(std::max_element(alternative_weights_.begin(), last) - alternative_weights_.begin());
    std::vector<Cell> cells;
    for (auto c = static_cast<std::size_t>(alternative_offsets_[best]);
         c < static_cast<std::size_t>(alternative_offsets_[best + 1]); ++c) {
        Cell& cell = cells.emplace_back();
        cell.prediction = cell_predictions_[c];
        for (auto m = static_cast<std::size_t>(cell_offsets_[c]); m < static_cast<std::size_t>(cell_offsets_[c + 1]);
             ++m) {
            cell.members.push_back(static_cast<std::size_t>(member_points_[m]));
            cell.weights.push_back(member_weights_[m]);
        }
    }
    return cells;
}

}  // namespace group
