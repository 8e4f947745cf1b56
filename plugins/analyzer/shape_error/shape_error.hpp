/// analyzer.shape_error: estimated extents against true ones. See README.md.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <pelorus/truth_pairs.hpp>

#include "ellipsoid.hpp"

namespace shape_error {

class ShapeError : public pelorus::Stage<ShapeError> {
public:
    static constexpr const char* kind = "analyzer";

    static void describe(pelorus::Describe<ShapeError>& plugin) {
        plugin.title("Shape error")
            .purpose(
                "Compares the extents of confirmed tracks with those of the objects nearest to them: half axes, "
                "direction of the main axis, the Gaussian-Wasserstein distance, which takes the centre in, and on "
                "request how much of both is common.")
            .equation(
                "half axes: square roots of the eigenvalues of X, the short one the mean of the two smaller; d^2 = |c "
                "- c'|^2 + tr(X + X' "
                "- 2 (X^1/2 X' X^1/2)^1/2); intersection over union: of the ellipses (ellipsoids) themselves")
            .source(
                "Li et al., Radar Science and Technology 23(1), 2025 (half axes and angle); S. Yang, M. Baum, K. "
                "Granstroem, Metrics for "
                "performance evaluation of elliptic extended object tracking methods, MFI 2016 (Gaussian-Wasserstein)");
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates with extents");
        plugin.in_port("truth", PLR_MESSAGE_TRUTH, "what really is, with extents");
        plugin.out_port("results", PLR_MESSAGE_TABLE, "the table by_time and its scalars, at the end");
        plugin.parameter("from_scan", &ShapeError::from_scan_)
            .initially("10")
            .min(0)
            .doc("first instant of truth (they count from 0) that enters the scalars; the table has all of them");
        plugin.parameter("overlap", &ShapeError::overlap_)
            .initially("false")
            .doc("whether intersection_over_union is told, too: in space it takes about a millisecond an estimate");
    }

    void setup(const pelorus::Setup& setup) { frame_ = setup.frame(); }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const { return pelorus::TruthPairs::streams(frame_); }

    void on_tracks(const pelorus::Event&, const plr_tracks& tracks) {
        if (tracks.count > 0 && tracks.extent.data == nullptr) throw pelorus::DataError("these tracks tell no extent");
        pairs_.add(tracks);
    }
    void on_truth(const pelorus::Event&, const plr_truth& truth) {
        if (truth.count > 0 && truth.extent.data == nullptr) throw pelorus::DataError("this truth tells no extent");
        pairs_.add(truth);
    }

    void finish(const pelorus::Event& event) {
        pelorus::ResultBuilder result("by_time");
        result.column("time", "s", PLR_REDUCE_KEY);
        const std::size_t told = overlap_ ? measure_count : measure_count - 1;
        for (std::size_t k = 0; k < told; ++k) result.column(measures()[k].name, measures()[k].unit, PLR_REDUCE_MEAN);
        std::array<Mean, measure_count> totals;
        std::int64_t index = 0;
        for (const auto& [time, instant] : pairs_.instants()) {
            if (instant.truth.empty()) continue;
            const std::array<Mean, measure_count> here = means(instant);
            std::vector<double> cells{static_cast<double>(time) * 1e-9};
            for (std::size_t k = 0; k < told; ++k) {
                cells.push_back(here[k].value());
                if (index >= from_scan_) totals[k].add(here[k]);
            }
            result.row(cells);
            ++index;
        }
        for (std::size_t k = 0; k < told; ++k)
            result.scalar(measures()[k].name, measures()[k].unit, PLR_REDUCE_MEAN, totals[k].value(), 0,
                          totals[k].count);
        result.scalar("scored", "", PLR_REDUCE_MEAN, totals[0].count);
        publish(0, result.message(event.time));
    }

    template <class Archive> void state(Archive& archive) { archive(pairs_); }

private:
    struct Measure {
        const char *name, *unit;
    };
    static constexpr std::size_t measure_count = 7;
    /// In the order of values_of; the last one is told on request.
    static const std::array<Measure, measure_count>& measures() {
        static const std::array<Measure, measure_count> all{{{"minor_axis_error", "m"},
                                                             {"major_axis_error", "m"},
                                                             {"axis_angle", "deg"},
                                                             {"minor_axis_bias", "m"},
                                                             {"major_axis_bias", "m"},
                                                             {"gaussian_wasserstein", "m"},
                                                             {"intersection_over_union", ""}}};
        return all;
    }
    static std::array<double, measure_count> values_of(const Difference& d) {
        return {std::fabs(d.short_axis), std::fabs(d.long_axis),   d.axis_angle, d.short_axis, d.long_axis,
                d.gaussian_wasserstein,  d.intersection_over_union};
    }

    struct Mean {
        double sum = 0, count = 0;
        void add(double value) {
            if (!std::isfinite(value)) return;
            sum += value;
            count += 1;
        }
        void add(const Mean& other) {
            sum += other.sum;
            count += other.count;
        }
        double value() const { return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN(); }
    };

    std::array<Mean, measure_count> means(const pelorus::TruthPairs::Instant& instant) const {
        std::array<Mean, measure_count> out;
        for (const auto& pair : instant.pairs()) {
            const auto found = compare(*pair.estimate, *pair.truth);
            if (!found) continue;
            const auto values = values_of(*found);
            for (std::size_t k = 0; k < measure_count; ++k) out[k].add(values[k]);
        }
        return out;
    }

    std::optional<Difference> compare(const pelorus::TruthPairs::Sample& estimate,
                                      const pelorus::TruthPairs::Sample& truth) const {
        const int d = estimate.extent_dimension();
        if (d == 0 || d != truth.extent_dimension() || d != truth.axes) return std::nullopt;
        const double *centre = estimate.moments.data(), *extent = estimate.extent.data();
        const double *true_centre = truth.moments.data(), *true_extent = truth.extent.data();
        return d == 2 ? difference<2>(centre, extent, true_centre, true_extent, overlap_)
                      : difference<3>(centre, extent, true_centre, true_extent, overlap_);
    }

    std::int64_t from_scan_ = 10;
    bool overlap_ = false;
    std::string frame_;
    pelorus::TruthPairs pairs_;
};

}  // namespace shape_error
