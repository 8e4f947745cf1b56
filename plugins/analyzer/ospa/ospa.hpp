/// analyzer.ospa: OSPA and GOSPA of tracks and truth at each time. See README.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/truth_pairs.hpp>

#include "../../common/partition/group_count.hpp"
#include "set_distance.hpp"

namespace ospa {

class Ospa : public pelorus::Stage<Ospa> {
public:
    static constexpr const char* kind = "analyzer";

    static void describe(pelorus::Describe<Ospa>& plugin) {
        plugin.title("OSPA and GOSPA")
            .purpose(
                "One figure for how far a set of tracks is from the set of objects: where they are, which are missed, "
                "which are false. Every confirmed or coasting track counts, and every object, at each time of the "
                "truth.")
            .equation(
                "OSPA = (1/n (min sum min(d, c)^p + c^p (n - m)))^(1/p), n and m the sizes of the larger and the "
                "smaller set; GOSPA = (sum over pairs of d^p + c^p/2 (missed + false))^(1/p)")
            .source(
                "D. Schuhmacher, B.-T. Vo, B.-N. Vo, A Consistent Metric for Performance Evaluation of Multi-Object "
                "Filters, IEEE Transactions on Signal Processing 56(8), 2008; A. S. Rahmathullah, A. F. Garcia-"
                "Fernandez, L. Svensson, Generalized Optimal Sub-Pattern Assignment Metric, FUSION 2017");
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates");
        plugin.in_port("truth", PLR_MESSAGE_TRUTH, "what really is");
        plugin.out_port("results", PLR_MESSAGE_TABLE, "the table by_time and its scalars, at the end");
        plugin.parameter("cutoff", &Ospa::cutoff_)
            .unit("m")
            .above(0)
            .doc("c: what a missed object or a false track costs; the largest error of position that is told apart");
        plugin.parameter("order", &Ospa::order_)
            .initially("2")
            .min(1)
            .max(64)
            .doc("p: how much more a large error counts than a small one");
        plugin.parameter("group_distance", &Ospa::group_distance_)
            .unit("m")
            .min(1e-9)
            .max(1e15)
            .doc(
                "objects less than so far apart are linked to groups; the middle is then where there are more groups "
                "than one and fewer than objects. Absent: the middle is all the time");
        plugin.parameter("end_from", &Ospa::end_from_)
            .unit("s")
            .doc("first time of the end; absent: the last tenth of the times");
    }

    void setup(const pelorus::Setup& setup) { frame_ = setup.frame(); }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const { return pelorus::TruthPairs::streams(frame_); }

    void on_tracks(const pelorus::Event&, const plr_tracks& tracks) { pairs_.add(tracks); }
    void on_truth(const pelorus::Event&, const plr_truth& truth) { pairs_.add(truth); }

    void finish(const pelorus::Event& event) {
        pelorus::ResultBuilder result("by_time");
        result.column("time", "s", PLR_REDUCE_KEY);
        for (const Column& column : columns()) result.column(column.name, column.unit, PLR_REDUCE_MEAN);
        std::vector<Step> steps;
        double without_truth = 0;
        for (const auto& [time, instant] : pairs_.instants()) {
            if (instant.truth.empty()) {
                without_truth += static_cast<double>(instant.estimates.size());
                continue;
            }
            steps.push_back(step_of(static_cast<double>(time) * 1e-9, instant));
            result.row(cells_of(steps.back()));
        }
        for (const Column& column : columns()) result.scalar_of_column(column.name, column.unit, column.name);
        add_parts(result, steps);
        result.scalar("without_truth", "", PLR_REDUCE_MEAN, without_truth);
        publish(0, result.message(event.time));
    }

    template <class Archive> void state(Archive& archive) { archive(pairs_); }

private:
    struct Column {
        const char *name, *unit;
    };
    struct Step {
        double time = 0;  ///< s
        SetDistance distance;
        std::int64_t objects = 0, estimates = 0;
        bool is_middle = false;
    };

    /// In the order of cells_of, after the time.
    static const std::vector<Column>& columns() {
        static const std::vector<Column> all{{"ospa", "m"},
                                             {"ospa_localisation", "m"},
                                             {"ospa_cardinality", "m"},
                                             {"gospa", "m"},
                                             {"gospa_localisation", "m"},
                                             {"gospa_missed", "m"},
                                             {"gospa_false", "m"},
                                             {"missed", ""},
                                             {"false", ""},
                                             {"objects", ""},
                                             {"estimates", ""}};
        return all;
    }
    static std::vector<double> cells_of(const Step& step) {
        const SetDistance& d = step.distance;
        return {step.time,
                d.ospa,
                d.ospa_localisation,
                d.ospa_cardinality,
                d.gospa,
                d.gospa_localisation,
                d.gospa_missed,
                d.gospa_false,
                static_cast<double>(d.missed),
                static_cast<double>(d.false_ones),
                static_cast<double>(step.objects),
                static_cast<double>(step.estimates)};
    }

    static std::vector<Point> points_of(const std::vector<pelorus::TruthPairs::Sample>& samples) {
        std::vector<Point> out;
        for (const auto& sample : samples) {
            Point point{};
            std::copy_n(sample.moments.begin(), sample.axes, point.begin());
            out.push_back(point);
        }
        return out;
    }

    Step step_of(double time, const pelorus::TruthPairs::Instant& instant) const {
        const std::vector<Point> objects = points_of(instant.truth), estimates = points_of(instant.estimates);
        Step step{time, set_distance(objects, estimates, cutoff_, order_), static_cast<std::int64_t>(objects.size()),
                  static_cast<std::int64_t>(estimates.size()), true};
        if (group_distance_) {
            const std::int64_t groups = partition::group_count(objects, *group_distance_);
            step.is_middle = groups > 1 && groups < step.objects;
        }
        return step;
    }

    /// Figures of the middle and of the end, one of each run.
    void add_parts(pelorus::ResultBuilder& result, const std::vector<Step>& steps) const {
        constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
        double sum = 0, count = 0, path = 0, end_sum = 0, end_count = 0;
        const Step* before = nullptr;
        for (std::size_t k = 0; k < steps.size(); ++k) {
            const Step& step = steps[k];
            if (step.is_middle) {
                sum += step.distance.ospa;
                count += 1;
                if (before != nullptr) path += std::fabs(step.distance.ospa - before->distance.ospa);
                before = &step;
            }
            if (end_from_ ? step.time >= *end_from_ : k + std::max<std::size_t>(1, steps.size() / 10) >= steps.size()) {
                end_sum += step.distance.ospa;
                end_count += 1;
            }
        }
        const double middle = count > 0 ? sum / count : nothing, end = end_count > 0 ? end_sum / end_count : nothing;
        result.scalar("middle", "m", PLR_REDUCE_MEAN, middle);
        result.scalar("middle_pooled", "m", PLR_REDUCE_MEAN, middle, 0, count);
        result.scalar("middle_path", "m", PLR_REDUCE_MEAN, count > 0 ? path : nothing);
        result.scalar("end_mean", "m", PLR_REDUCE_MEAN, end);
        result.scalar("end_median", "m", PLR_REDUCE_QUANTILE, end, 0.5);
    }

    double cutoff_ = 0, order_ = 2;                    // m, -
    std::optional<double> group_distance_, end_from_;  // m, s
    std::string frame_;
    pelorus::TruthPairs pairs_;
};

}  // namespace ospa
