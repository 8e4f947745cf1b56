/// The filter of configs/filter.yaml (nine states, constant acceleration) or filter_6_states.yaml (constant velocity) as the
/// host makes it, and its calls for a batch of tracks. A record of estimator.kalman is a mean and a covariance, so plain::Track
/// for nine states: all filters work on the same memory. Others have records of the same size.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pelorus/parts.hpp>

#include "graph/graph.hpp"
#include "host/catalog.hpp"
#include "inline/track_filter.hpp"

namespace pelorus::bench {

class PluginFilter {
public:
    /// For batches of `count` tracks; `form` is the estimator's parameter of that name, or nothing: its default. Throws Error where
    /// the config cannot be built.
    PluginFilter(std::size_t count, int states, const std::string& estimator = "estimator.kalman",
                 const std::string& form = {});
    PluginFilter(const PluginFilter&) = delete;
    PluginFilter& operator=(const PluginFilter&) = delete;

    /// Records of means and covariances.
    bool assign(const double* moments, double* to);
    bool predict(const double* from, double* to, double dt);
    bool update(plain::Sensor sensor, const double* from, const plain::Measurement* measurements, double* to,
                double* log_likelihood);
    /// What the last failed call told.
    std::string failure() const;

private:
    const plr_call& begin();
    plr_const_view records(const double* tracks) const;
    plr_view records(double* tracks) const;

    host::Catalog catalog_;
    graph::Graph graph_;
    std::vector<plr_part> models_;  // what estimator_ points into
    EstimatorPart estimator_;
    std::size_t count_;
    std::unique_ptr<unsigned char[]> memory_;
    plr_scratch scratch_{};
    plr_error error_{};
    std::vector<double> inputs_;
    std::vector<plr_status> status_;
    plr_call call_{};
};

}  // namespace pelorus::bench
