/// analyzer.tracking_error: position and velocity of estimates against truth. See README.md.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <pelorus/small_matrix.hpp>
#include <pelorus/truth_pairs.hpp>

namespace tracking_error {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// (e, e)_P^-1 of position and velocity (or position alone, where one side tells no velocity); NaN where P is not positive definite.
inline double normalised_error(const pelorus::TruthPairs::Pair& pair) {
    using Square = pelorus::small::Bounded<6, 6>;
    using Column = pelorus::small::Bounded<6, 1>;
    const auto given = static_cast<Eigen::Index>(pair.estimate->moments.size());
    const auto n = std::min(given, static_cast<Eigen::Index>(pair.truth->moments.size()));
    Square covariance(n, n), root(n, n);
    Column error(n, 1);
    for (Eigen::Index col = 0; col < n; ++col) {
        const auto k = static_cast<std::size_t>(col);
        error(col, 0) = pair.estimate->moments[k] - pair.truth->moments[k];
        for (Eigen::Index row = 0; row < n; ++row)
            covariance(row, col) = pair.estimate->covariance[static_cast<std::size_t>(col * given + row)];
    }
    if (!pelorus::small::cholesky(covariance, root)) return nothing;
    return pelorus::small::inverse_quadratic(root, error);
}

/// The errors of one time: over its pairs, root mean squares and means.
struct Row {
    double position = nothing, velocity = nothing, normalised = nothing;
    std::vector<double> axis, bias;  ///< of the position, an axis

    Row(const std::vector<pelorus::TruthPairs::Pair>& pairs, int axes)
        : axis(static_cast<std::size_t>(axes), nothing), bias(static_cast<std::size_t>(axes), nothing) {
        if (pairs.empty()) return;
        const auto n = static_cast<std::size_t>(axes);
        const double count = static_cast<double>(pairs.size());
        double position_squares = 0, velocity_squares = 0, normalised_sum = 0, velocities = 0;
        std::vector<double> squares(n, 0), sums(n, 0);
        for (const auto& pair : pairs) {
            for (std::size_t k = 0; k < n; ++k) {
                const double error = pair.estimate->moments[k] - pair.truth->moments[k];
                squares[k] += error * error;
                sums[k] += error;
                position_squares += error * error;
            }
            normalised_sum += normalised_error(pair);
            if (!pair.estimate->has_velocity() || !pair.truth->has_velocity()) continue;
            velocities += 1;
            for (std::size_t k = n; k < 2 * n; ++k)
                velocity_squares += std::pow(pair.estimate->moments[k] - pair.truth->moments[k], 2);
        }
        position = std::sqrt(position_squares / count);
        normalised = normalised_sum / count;
        if (velocities > 0) velocity = std::sqrt(velocity_squares / velocities);
        for (std::size_t k = 0; k < n; ++k) {
            axis[k] = std::sqrt(squares[k] / count);
            bias[k] = sums[k] / count;
        }
    }
};

class TrackingError : public pelorus::Stage<TrackingError> {
public:
    static constexpr const char* kind = "analyzer";

    static void describe(pelorus::Describe<TrackingError>& plugin) {
        plugin.title("Tracking error")
            .purpose(
                "Compares confirmed tracks with the truth at the same times: errors of position and velocity, bias, "
                "and whether the "
                "covariances are honest. Every track entry is scored against the object nearest to it. Both must be in "
                "the "
                "frame of this node.")
            .equation(
                "position: sqrt(mean over runs of |p - p_true|^2) at each time; its RMSE is the mean of that over "
                "time; nees: e' P^-1 "
                "e of position and velocity, which is their number (6 in space) where P is right");
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates");
        plugin.in_port("truth", PLR_MESSAGE_TRUTH, "what really is");
        plugin.out_port("results", PLR_MESSAGE_TABLE, "the table by_time and its scalars, at the end");
    }

    void setup(const pelorus::Setup& setup) { frame_ = setup.frame(); }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const { return pelorus::TruthPairs::streams(frame_); }

    void on_tracks(const pelorus::Event&, const plr_tracks& tracks) { pairs_.add(tracks); }
    void on_truth(const pelorus::Event&, const plr_truth& truth) { pairs_.add(truth); }

    void finish(const pelorus::Event& event) {
        static const char* const names[] = {".x", ".y", ".z"};
        pelorus::ResultBuilder result("by_time");
        const int axes = pairs_.axes();
        result.column("time", "s", PLR_REDUCE_KEY);
        result.column("position", "m", PLR_REDUCE_ROOT_MEAN_SQUARE);
        result.column("velocity", "m/s", PLR_REDUCE_ROOT_MEAN_SQUARE);
        result.column("nees", "", PLR_REDUCE_MEAN);
        result.column("estimates", "", PLR_REDUCE_MEAN);
        result.column("missing", "", PLR_REDUCE_MEAN);
        for (int k = 0; k < axes; ++k)
            result.column(std::string("position") + names[k], "m", PLR_REDUCE_ROOT_MEAN_SQUARE);
        for (int k = 0; k < axes; ++k) result.column(std::string("position_bias") + names[k], "m", PLR_REDUCE_MEAN);
        const Counts counts = add_rows(result);
        result.scalar_of_column("position_rmse", "m", "position");
        result.scalar_of_column("velocity_rmse", "m/s", "velocity");
        for (int k = 0; k < axes; ++k)
            result.scalar_of_column(std::string("position_bias") + names[k], "m",
                                    std::string("position_bias") + names[k]);
        result.scalar_of_column("nees", "", "nees");
        result.scalar("track_count", "", PLR_REDUCE_MEAN, static_cast<double>(pairs_.track_count()));
        result.scalar("estimates", "", PLR_REDUCE_MEAN, counts.estimates);
        result.scalar("missing", "", PLR_REDUCE_MEAN, counts.missing);
        result.scalar("without_truth", "", PLR_REDUCE_MEAN, counts.without_truth);
        publish(0, result.message(event.time));
    }

    template <class Archive> void state(Archive& archive) { archive(pairs_); }

private:
    struct Counts {
        double estimates = 0, missing = 0, without_truth = 0;
    };

    /// One row an instant that has truth.
    Counts add_rows(pelorus::ResultBuilder& result) const {
        Counts counts;
        for (const auto& [time, instant] : pairs_.instants()) {
            if (instant.truth.empty()) {
                counts.without_truth += static_cast<double>(instant.estimates.size());
                continue;
            }
            const Row row(instant.pairs(), pairs_.axes());
            const double estimates = static_cast<double>(instant.estimates.size()),
                         missing = static_cast<double>(instant.missing());
            counts.estimates += estimates;
            counts.missing += missing;
            std::vector<double> cells{
                static_cast<double>(time) * 1e-9, row.position, row.velocity, row.normalised, estimates, missing};
            cells.insert(cells.end(), row.axis.begin(), row.axis.end());
            cells.insert(cells.end(), row.bias.begin(), row.bias.end());
            result.row(cells);
        }
        return counts;
    }

    std::string frame_;
    pelorus::TruthPairs pairs_;
};

}  // namespace tracking_error
