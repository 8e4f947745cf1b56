/// analyzer.tracking_error: position, velocity and acceleration of estimates against truth, and their covariances. See README.md.
#pragma once

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/innovations.hpp>
#include <pelorus/truth_pairs.hpp>

#include "moments.hpp"

namespace tracking_error {

class TrackingError : public pelorus::Stage<TrackingError> {
public:
    static constexpr const char* kind = "analyzer";
    static constexpr std::uint32_t state_version = 3;

    static void describe(pelorus::Describe<TrackingError>& plugin) {
        plugin.title("Tracking error")
            .purpose(
                "Compares confirmed tracks with the truth at the same times: errors of position, velocity and "
                "acceleration, bias, and whether the covariances are honest, of the estimates and (where the tracker "
                "tells its innovations) of the predictions. Every track entry is scored against the object nearest to "
                "it. Both must be in the frame of this node.")
            .equation(
                "position: sqrt(mean over runs of |p - p_true|^2) at each time; its RMSE is the mean of that over "
                "time; nees: e' P^-1 e of position and velocity, which is their number (6 in space) where P is right; "
                "nis: e' S^-1 e of an innovation; anees, anis: sums of those over sums of their components, 1 where "
                "all is right, between chi-square quantiles with a probability of `confidence`")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "Wiley 2001, 5.4.2; X. R. Li, Z. Zhao, V. P. Jilkov, Practical measures and test for credibility of "
                "an estimator, Workshop on Estimation, Tracking, and Fusion, 2001 (anees)");
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates");
        plugin.in_port("truth", PLR_MESSAGE_TRUTH, "what really is", PLR_PORT_MANY);
        plugin.in_port("innovations", PLR_MESSAGE_VALUES, "normalised innovations squared of a tracker",
                       PLR_PORT_OPTIONAL);
        plugin.out_port("results", PLR_MESSAGE_TABLE, "the tables by_time, acceleration and innovations, at the end");
        plugin.parameter("acceleration", &TrackingError::acceleration_)
            .initially("false")
            .doc("whether errors of the acceleration are told, in a table of their own");
        plugin.parameter("whole_run", &TrackingError::whole_run_)
            .initially("false")
            .doc("whether root mean square errors of the whole run are told: position_rms, position_rms.x, ...");
        plugin.parameter("confidence", &TrackingError::confidence_)
            .initially("0.95")
            .above(0)
            .below(1)
            .doc("probability with which honest covariances keep within the bounds of anees and anis");
        plugin.parameter("nees_derivatives", &TrackingError::nees_derivatives_)
            .initially("2")
            .min(1)
            .max(3)
            .doc("what nees counts: 1, positions; 2, velocities too; 3, accelerations too; those that both sides tell");
        plugin.parameter("from_scan", &TrackingError::from_scan_)
            .initially("0")
            .min(0)
            .doc("first instant of truth, counted from 0, that is told and enters the scalars");
        plugin.parameter("nees_from_scan", &TrackingError::nees_from_scan_)
            .min(0)
            .doc(
                "the same for nees and anees, where they are to leave out more, as a filter's start; absent: "
                "from_scan");
        plugin.parameter("period", &TrackingError::period_)
            .unit("s")
            .above(0)
            .doc("instants of truth at whole multiples of this alone count: those of a slow sensor beside a fast one");
        plugin.parameter("armse", &TrackingError::armse_)
            .initially("false")
            .doc(
                "whether averaged root mean square errors are told: position_armse of x and y, position_armse_3d of "
                "all "
                "axes");
    }

    void setup(const pelorus::Setup& setup) { frame_ = setup.frame(); }
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const {
        return port == innovations_in ? std::vector<pelorus::Stream>() : pelorus::TruthPairs::streams(frame_);
    }

    void on_tracks(const pelorus::Event&, const plr_tracks& tracks) { pairs_.add(tracks); }
    void on_truth(const pelorus::Event&, const plr_truth& truth) { pairs_.add(truth); }
    void on_values(const pelorus::Event&, const plr_values& values) {
        const std::int64_t found = pelorus::for_each_innovation(values, [&](const pelorus::Innovation& innovation) {
            innovations_[innovation.time].add(innovation.squared, innovation.components);
        });
        if (found == 0) throw pelorus::DataError("tells no " PLR_QUANTITY_INNOVATION);
    }

    void finish(const pelorus::Event& event) {
        publish_errors(event.time);
        publish_accelerations(event.time);
        publish_innovations(event.time);
    }

    template <class Archive> void state(Archive& archive) { archive(pairs_, innovations_); }

private:
    static constexpr std::uint32_t innovations_in = 2;  // the third in port
    struct Counts {
        double estimates = 0, missing = 0, without_truth = 0;
    };

    void publish_errors(std::int64_t time) {
        pelorus::ResultBuilder result("by_time");
        const int axes = pairs_.axes();
        result.column("time", "s", PLR_REDUCE_KEY);
        result.column("position", "m", PLR_REDUCE_ROOT_MEAN_SQUARE);
        result.column("velocity", "m/s", PLR_REDUCE_ROOT_MEAN_SQUARE);
        result.column("nees", "", PLR_REDUCE_MEAN);
        add_consistency(result, "anees");
        result.column("estimates", "", PLR_REDUCE_MEAN);
        result.column("missing", "", PLR_REDUCE_MEAN);
        add_axes(result, "position", "m");
        add_axes(result, "velocity", "m/s");
        if (armse_) result.column("position_xy", "m", PLR_REDUCE_ROOT_MEAN_SQUARE);
        const Counts counts = add_rows(result);
        result.scalar_of_column("position_rmse", "m", "position");
        result.scalar_of_column("velocity_rmse", "m/s", "velocity");
        if (armse_) {
            result.scalar_of_column("position_armse", "m", "position_xy");
            result.scalar_of_column("position_armse_3d", "m", "position");
        }
        for (int k = 0; k < axes; ++k)
            result.scalar_of_column(of_axis("position_bias", k), "m", of_axis("position_bias", k));
        result.scalar_of_column("nees", "", "nees");
        if (whole_run_)
            for (int derivative = 0; derivative < 2; ++derivative) add_run_errors(result, derivative);
        result.scalar("track_count", "", PLR_REDUCE_MEAN, static_cast<double>(pairs_.track_count()));
        result.scalar("estimates", "", PLR_REDUCE_MEAN, counts.estimates);
        result.scalar("missing", "", PLR_REDUCE_MEAN, counts.missing);
        result.scalar("without_truth", "", PLR_REDUCE_MEAN, counts.without_truth);
        publish(0, result.message(time));
    }

    /// Calls function(time, instant, index) for each instant that has truth and counts, from from_scan on.
    template <class Function> void for_each_scored(Function function) const {
        std::int64_t index = 0;
        for (const auto& [time, instant] : pairs_.instants())
            if (!instant.truth.empty() && is_counted(time) && index++ >= from_scan_) function(time, instant, index - 1);
    }
    /// Sample k lies at k periods, rounded to ns.
    bool is_counted(std::int64_t time) const {
        if (!period_) return true;
        const double period = *period_ * 1e9;
        return std::llround(std::round(static_cast<double>(time) / period) * period) == time;
    }

    /// Root mean squares over all pairs of the run: what a single run can tell of its errors.
    void add_run_errors(pelorus::ResultBuilder& result, int derivative) const {
        const std::string name = derivative == 0 ? "position_rms" : "velocity_rms",
                          unit = derivative == 0 ? "m" : "m/s";
        Pairs all;
        for_each_scored([&](std::int64_t, const pelorus::TruthPairs::Instant& instant, std::int64_t) {
            const Pairs pairs = instant.pairs();
            all.insert(all.end(), pairs.begin(), pairs.end());
        });
        const Errors errors(all, pairs_.axes(), derivative);
        result.scalar(name, unit, PLR_REDUCE_ROOT_MEAN_SQUARE, errors.norm);
        for (int k = 0; k < pairs_.axes(); ++k)
            result.scalar(of_axis(name, k), unit, PLR_REDUCE_ROOT_MEAN_SQUARE,
                          errors.axis[static_cast<std::size_t>(k)]);
    }

    /// One row an instant that has truth.
    Counts add_rows(pelorus::ResultBuilder& result) const {
        Counts counts;
        for (const auto& [time, instant] : pairs_.instants())
            if (instant.truth.empty()) counts.without_truth += static_cast<double>(instant.estimates.size());
        for_each_scored([&](std::int64_t time, const pelorus::TruthPairs::Instant& instant, std::int64_t index) {
            const Pairs pairs = instant.pairs();
            const Errors position(pairs, pairs_.axes(), 0), velocity(pairs, pairs_.axes(), 1);
            NormalisedSquares squares;
            if (index >= nees_from_scan_.value_or(from_scan_))
                for (const auto& pair : pairs) add_error(pair, static_cast<int>(nees_derivatives_), squares);
            const double estimates = static_cast<double>(instant.estimates.size()),
                         missing = static_cast<double>(instant.missing());
            counts.estimates += estimates;
            counts.missing += missing;
            std::vector<double> cells{seconds(time), position.norm, velocity.norm, squares.mean()};
            add_cells(cells, squares);
            cells.insert(cells.end(), {estimates, missing});
            for (const Errors* errors : {&position, &velocity}) add_cells(cells, *errors);
            if (armse_) cells.push_back(std::hypot(position.axis[0], position.axis.size() > 1 ? position.axis[1] : 0));
            result.row(cells);
        });
        return counts;
    }

    void publish_accelerations(std::int64_t time) {
        if (!acceleration_) return;
        pelorus::ResultBuilder result("acceleration");
        result.column("time", "s", PLR_REDUCE_KEY);
        result.column("acceleration", "m/s2", PLR_REDUCE_ROOT_MEAN_SQUARE);
        add_axes(result, "acceleration", "m/s2");
        for_each_scored([&](std::int64_t when, const pelorus::TruthPairs::Instant& instant, std::int64_t) {
            const Errors errors(instant.pairs(), pairs_.axes(), 2);
            std::vector<double> cells{seconds(when), errors.norm};
            add_cells(cells, errors);
            result.row(cells);
        });
        result.scalar_of_column("acceleration_rmse", "m/s2", "acceleration");
        publish(0, result.message(time));
    }

    void publish_innovations(std::int64_t time) {
        if (innovations_.empty()) return;
        pelorus::ResultBuilder result("innovations");
        result.column("time", "s", PLR_REDUCE_KEY);
        result.column("nis", "", PLR_REDUCE_MEAN);
        add_consistency(result, "anis");
        result.column("innovations", "", PLR_REDUCE_MEAN);
        double count = 0;
        for (const auto& [when, squares] : innovations_) {
            std::vector<double> cells{seconds(when), squares.mean()};
            add_cells(cells, squares);
            cells.push_back(squares.count);
            result.row(cells);
            count += squares.count;
        }
        result.scalar_of_column("nis", "", "nis");
        result.scalar_of_column("anis", "", "anis");
        result.scalar("innovations", "", PLR_REDUCE_MEAN, count);
        publish(0, result.message(time));
    }

    // Columns, and their cells in the same order.
    void add_consistency(pelorus::ResultBuilder& result, const std::string& name) const {
        result.column(name, "", PLR_REDUCE_MEAN);
        result.column(name + "_lower", "", PLR_REDUCE_CHI_SQUARE, (1 - confidence_) / 2);
        result.column(name + "_upper", "", PLR_REDUCE_CHI_SQUARE, (1 + confidence_) / 2);
    }
    static void add_cells(std::vector<double>& cells, const NormalisedSquares& squares) {
        cells.insert(cells.end(), {squares.ratio(), squares.bounded_degrees(), squares.bounded_degrees()});
    }
    void add_axes(pelorus::ResultBuilder& result, const std::string& name, const std::string& unit) const {
        for (int k = 0; k < pairs_.axes(); ++k) result.column(of_axis(name, k), unit, PLR_REDUCE_ROOT_MEAN_SQUARE);
        for (int k = 0; k < pairs_.axes(); ++k) result.column(of_axis(name + "_bias", k), unit, PLR_REDUCE_MEAN);
    }
    static void add_cells(std::vector<double>& cells, const Errors& errors) {
        cells.insert(cells.end(), errors.axis.begin(), errors.axis.end());
        cells.insert(cells.end(), errors.bias.begin(), errors.bias.end());
    }

    static std::string of_axis(const std::string& name, int axis) {
        static const char* const names[] = {".x", ".y", ".z"};
        return name + names[axis];
    }
    static double seconds(std::int64_t time) { return static_cast<double>(time) * 1e-9; }

    bool acceleration_ = false, whole_run_ = false, armse_ = false;
    double confidence_ = 0.95;
    std::int64_t nees_derivatives_ = 2, from_scan_ = 0;
    std::optional<std::int64_t> nees_from_scan_;
    std::optional<double> period_;  // s
    std::string frame_;
    pelorus::TruthPairs pairs_;
    std::map<std::int64_t, NormalisedSquares> innovations_;  // by time, ns
};

}  // namespace tracking_error
