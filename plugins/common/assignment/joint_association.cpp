#include "joint_association.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "assignment.hpp"
#include "clusters.hpp"

namespace assignment {

namespace {

constexpr double log_two_pi = 1.8378770664093453;

/// The joint events of one cluster.
class Events {
public:
    Events(const std::vector<LikelihoodRatio>& pairs, const std::vector<std::size_t>& cluster) {
        std::vector<std::size_t> detections;
        for (const std::size_t i : cluster) detections.push_back(pairs[i].detection);
        std::sort(detections.begin(), detections.end());
        detections.erase(std::unique(detections.begin(), detections.end()), detections.end());
        used_.assign(detections.size(), 0);
        for (const std::size_t i : cluster) {
            if (rows_.empty() || rows_.back().track != pairs[i].track)
                rows_.push_back({pairs[i].track, options_.size(), options_.size(), 1, 0});
            const auto at = std::lower_bound(detections.begin(), detections.end(), pairs[i].detection);
            options_.push_back({i, static_cast<std::size_t>(at - detections.begin()), pairs[i].log_ratio, 0});
            rows_.back().end = options_.size();
        }
        scale();
    }

    void weigh(JointWeights& weights) {
        const double total = enumerate(0, 1.0);
        for (const Option& option : options_) weights.pairs[option.pair] = option.sum / total;
        for (const Row& row : rows_) weights.none[row.track] = row.sum / total;
    }

private:
    /// A track may have this detection; `sum`: of the probabilities of all events in which it has.
    struct Option {
        std::size_t pair, detection;
        double factor, sum;
    };
    /// A track: its options stand from `begin` to `end`; `factor` and `sum` are those of no detection.
    struct Row {
        std::size_t track, begin, end;
        double factor, sum;
    };

    /// Turns logarithms into factors, each track's divided by what it has in the likeliest event: that event's product is 1, no
    /// event's is greater, and their sum neither overflows nor vanishes.
    void scale() {
        std::vector<double> costs(rows_.size() * used_.size(), std::numeric_limits<double>::infinity());
        for (std::size_t r = 0; r < rows_.size(); ++r)
            for (std::size_t k = rows_[r].begin; k < rows_[r].end; ++k)
                costs[r * used_.size() + options_[k].detection] = -options_[k].factor;
        const auto best =
            assign(static_cast<std::int64_t>(rows_.size()), static_cast<std::int64_t>(used_.size()), costs, 0.0);
        for (std::size_t r = 0; r < rows_.size(); ++r) {
            const double reference =
                best[r] == unassigned ? 0.0 : -costs[r * used_.size() + static_cast<std::size_t>(best[r])];
            for (std::size_t k = rows_[r].begin; k < rows_[r].end; ++k)
                options_[k].factor = std::exp(options_[k].factor - reference);
            rows_[r].factor = std::exp(-reference);
        }
    }

    /// Sum over all choices of the tracks from `r` on, given those of the tracks before, whose factors multiply to `before`.
    double enumerate(std::size_t r, double before) {
        if (r == rows_.size()) return 1.0;
        Row& row = rows_[r];
        const double missed = row.factor * enumerate(r + 1, before * row.factor);
        row.sum += before * missed;
        double total = missed;
        for (std::size_t k = row.begin; k < row.end; ++k) {
            Option& option = options_[k];
            if (used_[option.detection] != 0) continue;
            used_[option.detection] = 1;
            const double taken = option.factor * enumerate(r + 1, before * option.factor);
            used_[option.detection] = 0;
            option.sum += before * taken;
            total += taken;
        }
        return total;
    }

    std::vector<Option> options_;
    std::vector<Row> rows_;
    std::vector<char> used_;  // by detection
};

/// How many joint events a cluster would have if detections could be shared.
double count_events(const std::vector<LikelihoodRatio>& pairs, const std::vector<std::size_t>& cluster) {
    double events = 1, options = 1;
    for (std::size_t i = 0; i < cluster.size(); ++i) {
        ++options;
        if (i + 1 < cluster.size() && pairs[cluster[i + 1]].track == pairs[cluster[i]].track) continue;
        events *= options;
        options = 1;
    }
    return events;
}

/// By pair of the cluster: its weight if its track were alone (PDA).
std::vector<double> lonely_weights(const std::vector<LikelihoodRatio>& pairs) {
    std::vector<double> weights;
    for (std::size_t first = 0, end = 0; first < pairs.size(); first = end) {
        double largest = 0;  // of no detection
        for (end = first; end < pairs.size() && pairs[end].track == pairs[first].track; ++end)
            largest = std::max(largest, pairs[end].log_ratio);
        double total = std::exp(-largest);
        for (std::size_t i = first; i < end; ++i) total += std::exp(pairs[i].log_ratio - largest);
        for (std::size_t i = first; i < end; ++i) weights.push_back(std::exp(pairs[i].log_ratio - largest) / total);
    }
    return weights;
}

/// What is left of a cluster's pairs without the `dropped` weakest, as clusters of indices into all pairs.
std::vector<std::vector<std::size_t>> without(const std::vector<LikelihoodRatio>& pairs,
                                              const std::vector<std::size_t>& cluster,
                                              const std::vector<std::size_t>& weakest_first, std::size_t dropped) {
    std::vector<char> left(cluster.size(), 1);
    for (std::size_t k = 0; k < dropped; ++k) left[weakest_first[k]] = 0;
    std::vector<LikelihoodRatio> kept;
    std::vector<std::size_t> which;
    for (std::size_t k = 0; k < cluster.size(); ++k) {
        if (left[k] == 0) continue;
        kept.push_back(pairs[cluster[k]]);
        which.push_back(cluster[k]);
    }
    auto parts = clusters(kept);
    for (auto& part : parts)
        for (std::size_t& i : part) i = which[i];
    return parts;
}

/// The parts of a cluster that is too large, the fewest of its weakest pairs left out; by bisection.
std::vector<std::vector<std::size_t>> split(const std::vector<LikelihoodRatio>& pairs,
                                            const std::vector<std::size_t>& cluster, double most_events,
                                            std::size_t& dropped) {
    std::vector<LikelihoodRatio> own;
    for (const std::size_t i : cluster) own.push_back(pairs[i]);
    const std::vector<double> weights = lonely_weights(own);
    std::vector<std::size_t> weakest_first(cluster.size());
    std::iota(weakest_first.begin(), weakest_first.end(), std::size_t{0});
    std::stable_sort(weakest_first.begin(), weakest_first.end(),
                     [&](std::size_t a, std::size_t b) { return weights[a] < weights[b]; });
    std::size_t few = 0, enough = cluster.size();
    while (enough - few > 1) {
        const std::size_t middle = few + (enough - few) / 2;
        const auto parts = without(pairs, cluster, weakest_first, middle);
        const bool small = std::all_of(parts.begin(), parts.end(),
                                       [&](const auto& part) { return count_events(pairs, part) <= most_events; });
        (small ? enough : few) = middle;
    }
    dropped += enough;
    return without(pairs, cluster, weakest_first, enough);
}

}  // namespace

double log_detection_ratio(double squared_distance, double log_determinant, int components,
                           const DetectionModel& model) {
    const double log_density = -0.5 * (squared_distance + log_determinant + components * log_two_pi);
    return log_density + std::log(model.detection_probability) - std::log(model.clutter_density) -
           std::log1p(-model.detection_probability * model.gate_probability);
}

JointWeights associate_jointly(const std::vector<LikelihoodRatio>& pairs, std::size_t tracks, double most_events) {
    JointWeights weights;
    weights.pairs.assign(pairs.size(), 0.0);
    weights.none.assign(tracks, 1.0);
    for (const auto& cluster : clusters(pairs)) {
        if (count_events(pairs, cluster) <= most_events) {
            Events(pairs, cluster).weigh(weights);
            continue;
        }
        for (const auto& part : split(pairs, cluster, most_events, weights.dropped)) Events(pairs, part).weigh(weights);
    }
    return weights;
}

}  // namespace assignment
