/// Cells by what is predicted: of each prediction those measurements that its shape explains; of the rest, cells by distance.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "covariances.hpp"
#include "distance_groups.hpp"
#include "writer.hpp"

namespace partition {

enum class MemberWeights { likelihood, equal };

/// Parameters that the partitioners by prediction have in common; a plugin derives from this.
struct PredictedCellSettings {
    double threshold = 0;         ///< d0, m
    double gate_probability = 0;  ///< of the gate about each prediction
    double scale = 0;             ///< lambda: the share of the extent that measurements scatter with
    MemberWeights weights = MemberWeights::likelihood;
    Gate gate;

    static Need need() noexcept {
        Need subset = array<double>();  // coordinates of the points looked at
        subset.per_point *= 3;
        return distance_groups_need() + subset + array<double>() + array<std::uint32_t>() + array<std::uint32_t>();
    }

    template <class Plugin>
    static void describe(pelorus::Describe<Plugin>& plugin, const char* gate_probability, const char* on_threshold) {
        plugin.parameter("threshold", &PredictedCellSettings::threshold)
            .unit("m")
            .min(1e-9)
            .max(1e15)
            .doc(on_threshold);
        plugin.parameter("gate_probability", &PredictedCellSettings::gate_probability)
            .initially(gate_probability)
            .above(0)
            .below(1)
            .doc("p: the share of an object's own measurements that its gate lets pass");
        plugin.parameter("scale", &PredictedCellSettings::scale)
            .initially("0.25")
            .min(0)
            .max(1e6)
            .doc("lambda: measurements of an extent X scatter with lambda X; 1/4 for a filled ellipse");
        plugin.parameter("weights", &PredictedCellSettings::weights)
            .initially("likelihood")
            .choices({{"likelihood", "N(e; 0, H P H' + R)/|e|, as published"}, {"equal", "members weigh alike"}})
            .doc("how the members of a prediction's cell weigh");
    }
};

/// Splits one scan. [worker, exclusive] on its memory.
template <int D> class PredictedCells {
public:
    using Covariance = pelorus::Matrix<D>;
    using Point = pelorus::Vector<D>;

    /// `splits`: what a gate holds is partitioned by distance once more, and the part nearest to the prediction is its cell.
    PredictedCells(Memory& memory, const PredictedCellSettings& settings, bool splits, const plr_call& call,
                   const plr_partitioner_split& args)
        : settings_(settings), splits_(splits), call_(call), args_(args) {
        const auto count = static_cast<std::size_t>(args.points.count);
        if (args.covariance.data != nullptr)
            expect_covariances<D>(args.covariance, args.points.count, "covariance of point");
        const plr_predictions& predictions = args.predictions;
        if (predictions.count > 0) {
            pelorus::expect(predictions.mean, D, 1, predictions.count, "predictions.mean");
            expect_finite(predictions.mean, "mean of prediction");
            expect_covariances<D>(predictions.covariance, predictions.count, "covariance of prediction");
            if (predictions.extent.data != nullptr)
                expect_covariances<D>(predictions.extent, predictions.count, "extent of prediction");
        }
        subset_ = memory.take<double>(D * count);
        log_weight_ = memory.take<double>(count);
        chosen_ = memory.take<std::uint32_t>(count);
        is_taken_ = memory.take<std::uint32_t>(count);
        for (std::size_t i = 0; i < count; ++i) is_taken_[i] = 0;
        rest_of_memory_ = &memory;
    }

    void write(Writer& writer) {
        for (std::int64_t prediction = 0; prediction < args_.predictions.count; ++prediction) {
            choose_within_gate(prediction);
            if (splits_ && chosen_count_ > 1) choose_nearest_part(prediction);
            if (chosen_count_ == 0) continue;
            weigh(prediction);
            for (std::uint32_t k = 0; k < chosen_count_; ++k) {
                writer.member(chosen_[k], log_weight_[k]);
                is_taken_[chosen_[k]] = 1;
            }
            writer.cell(prediction);
        }
        chosen_count_ = 0;
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(args_.points.count); ++i)
            if (is_taken_[i] == 0) chosen_[chosen_count_++] = i;
        if (chosen_count_ == 0) return;
        Memory memory = *rest_of_memory_;
        writer.cells(groups_of_chosen(memory), [this](std::uint32_t k) { return chosen_[k]; });
    }

private:
    Point point(std::int64_t i) const noexcept { return pelorus::load<D, 1>(args_.points, i); }
    Point mean(std::int64_t prediction) const noexcept {
        return pelorus::load<D, 1>(args_.predictions.mean, prediction);
    }
    Covariance noise(std::int64_t i) const noexcept { return known_or_zero<D>(args_.covariance, i); }

    /// The points with e' (lambda X + R)^-1 e < gate, ascending.
    void choose_within_gate(std::int64_t prediction) {
        const Covariance shape = settings_.scale * known_or_zero<D>(args_.predictions.extent, prediction);
        const Point centre = mean(prediction);
        const double gate = settings_.gate(D);
        chosen_count_ = 0;
        for (std::int64_t i = 0; i < args_.points.count; ++i) {
            const Point error = point(i) - centre;
            const Covariance spread = shape + noise(i);
            // e_k^2 / S_kk is never more than e' S^-1 e: most points are far away on some axis. The margin is for rounding.
            bool is_far = false;
            for (int k = 0; k < D; ++k) is_far = is_far || error(k) * error(k) > 1.000001 * gate * spread(k, k);
            if (is_far) continue;
            Covariance root;
            if (!pelorus::small::cholesky(spread, root))
                throw pelorus::NumericError("the gate of prediction " + std::to_string(prediction) + " about point " +
                                            std::to_string(i) + " (extent and noise) is not positive definite");
            if (pelorus::small::inverse_quadratic(root, error) < gate)
                chosen_[chosen_count_++] = static_cast<std::uint32_t>(i);
        }
    }

    /// The chosen points in cells by distance, numbered as they are chosen.
    Groups groups_of_chosen(Memory& memory) {
        for (std::uint32_t k = 0; k < chosen_count_; ++k)
            for (int axis = 0; axis < D; ++axis)
                subset_[D * k + static_cast<unsigned>(axis)] = coordinate(args_.points, chosen_[k], axis);
        return distance_groups<D>(memory, pelorus::const_view(subset_, D, 1, chosen_count_), settings_.threshold,
                                  args_.parallel, call_.error);
    }

    /// Of the chosen ones keeps the part with the least e' (H P H' + mean R)^-1 e, e from the prediction to the part's mean;
    /// the first of equals.
    void choose_nearest_part(std::int64_t prediction) {
        Memory memory = *rest_of_memory_;
        const Groups parts = groups_of_chosen(memory);
        std::uint32_t nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t part = 0; parts.count() > 1 && part < parts.count(); ++part) {
            const double distance = squared_distance_of(parts, part, prediction);
            if (distance < least) {
                least = distance;
                nearest = part;
            }
        }
        const std::uint32_t* const members = parts.begin(nearest);
        chosen_count_ = parts.size(nearest);
        for (std::uint32_t k = 0; k < chosen_count_; ++k)
            chosen_[k] = chosen_[members[k]];  // members ascend: k <= members[k]
    }
    double squared_distance_of(const Groups& parts, std::uint32_t part, std::int64_t prediction) const {
        // Sums of differences to the prediction: coordinates may be much larger.
        Point error = Point::Zero();
        Covariance noises = Covariance::Zero();
        for (std::uint32_t k = 0; k < parts.size(part); ++k) {
            const std::uint32_t i = chosen_[parts.begin(part)[k]];
            error += point(i) - mean(prediction);
            noises += noise(i);
        }
        error /= parts.size(part);
        noises /= parts.size(part);
        return pelorus::small::inverse_quadratic(factor_about(prediction, noises), error);
    }

    /// The Cholesky factor of H P H' + R.
    Covariance factor_about(std::int64_t prediction, const Covariance& noise_there) const {
        Covariance root;
        if (!pelorus::small::cholesky(
                Covariance(pelorus::load<D, D>(args_.predictions.covariance, prediction) + noise_there), root))
            throw pelorus::NumericError("H P H' + R of prediction " + std::to_string(prediction) +
                                        " is not positive definite");
        return root;
    }

    /// Into log_weight_: first the logarithms of N(e; 0, H P H' + R)/max(|e|, 1 mm), then the weights themselves. The densities of
    /// far members are below the smallest double; their ratios are not.
    void weigh(std::int64_t prediction) {
        double largest = -std::numeric_limits<double>::infinity(), sum = 0;
        for (std::uint32_t k = 0; k < chosen_count_; ++k) {
            log_weight_[k] = settings_.weights == MemberWeights::equal ? 0 : log_weight(prediction, chosen_[k]);
            largest = std::max(largest, log_weight_[k]);
        }
        for (std::uint32_t k = 0; k < chosen_count_; ++k) sum += log_weight_[k] = std::exp(log_weight_[k] - largest);
        for (std::uint32_t k = 0; k < chosen_count_; ++k) log_weight_[k] /= sum;
    }
    double log_weight(std::int64_t prediction, std::uint32_t i) const {
        constexpr double nearest = 1e-3;  // m: a member at the centre itself does not outweigh all others for ever
        const Point error = point(i) - mean(prediction);
        return pelorus::small::log_normal(factor_about(prediction, noise(i)), error) -
               std::log(std::max(error.norm(), nearest));
    }

    const PredictedCellSettings& settings_;
    bool splits_;
    const plr_call& call_;
    const plr_partitioner_split& args_;
    double *subset_, *log_weight_;
    std::uint32_t *chosen_, *is_taken_;
    std::uint32_t chosen_count_ = 0;
    const Memory* rest_of_memory_;
};

/// The whole of split(), for both partitioners.
inline plr_status split_by_predictions(const plr_partitioner_info& info, const PredictedCellSettings& settings,
                                       bool splits, const plr_call& call, const plr_partitioner_split& args) {
    expect_points(info, args);
    Writer writer(*args.out);
    if (args.points.count > 0) {
        CallMemory memory(call, PredictedCellSettings::need(), args.points.count);
        by_dimension(args.points.rows, [&](auto dimension) {
            PredictedCells<decltype(dimension)::value>(memory, settings, splits, call, args).write(writer);
        });
        writer.alternative(1);
    }
    return writer.finish();
}

}  // namespace partition
