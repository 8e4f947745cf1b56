#include "cells.hpp"

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
    caller.require(request_.split(partitioner_, context, args), "partitioner, split");
    return likeliest();
}

std::vector<Cell> Cells::likeliest() const {
    if (request_.alternatives() == 0) return {};
    std::int64_t best = 0;
    for (std::int64_t a = 1; a < request_.alternatives(); ++a)
        if (request_.weight(a) > request_.weight(best)) best = a;
    std::vector<Cell> cells;
    for (std::int64_t c = request_.first_cell(best); c < request_.first_cell(best + 1); ++c) {
        const std::int64_t* const points = request_.points(c);
        const double* const weights = request_.weights(c);
        cells.push_back(
            {request_.prediction(c), {points, points + request_.size(c)}, {weights, weights + request_.size(c)}});
    }
    return cells;
}

}  // namespace group
