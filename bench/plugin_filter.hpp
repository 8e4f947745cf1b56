/// The filter of configs/filter.yaml as the host makes it, and its calls for a batch of tracks. A record of it is what
/// plain::Track is, so that both filters work on the same memory.
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
    /// For batches of `count` tracks. Throws Error where the config cannot be built.
    explicit PluginFilter(std::size_t count);
    PluginFilter(const PluginFilter&) = delete;
    PluginFilter& operator=(const PluginFilter&) = delete;

    bool predict(const plain::Track* from, plain::Track* to, double dt);
    bool update(plain::Sensor sensor, const plain::Track* from, const plain::Measurement* measurements,
                plain::Track* to, double* log_likelihood);
    /// What the last failed call told.
    std::string failure() const;

private:
    const plr_call& begin();

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
