/// The calls of an estimator: with plausible arguments for the checks of all models, with given ones for its own.
#pragma once

#include <vector>

#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance {

class EstimatorCalls {
public:
    explicit EstimatorCalls(const Instance& instance_)
        : instance(instance_),
          table(instance_.table<plr_estimator>()),
          info(*table.info(instance_.self())),
          n(info.state->size),
          c(info.cartesian->size),
          axes(axes_of(*info.cartesian)) {}

    // Calls for items as many as the first argument holds, which the caller gives. Outputs are named as in the ABI.
    HotCall init(const std::vector<std::int32_t>& components, const Argument& mean, const Argument& covariance) const;
    HotCall predict(const Argument& dt, const Argument& record) const;
    HotCall project(std::int32_t sensor, const Argument& record) const;
    HotCall update(std::int32_t sensor, const Argument& record, const Argument& measurement,
                   const Argument& noise) const;
    HotCall summary(const Argument& record) const { return moments_call("summary", table.summary, c, record); }
    HotCall moments(const Argument& record) const { return moments_call("moments", table.moments, n, record); }
    HotCall assign(const Argument& record, const Argument& mean, const Argument& covariance) const;
    /// `records` holds all hypotheses of an item side by side.
    HotCall mix(const Argument& weights, const Argument& records) const;
    HotCall probabilities(const Argument& record) const;
    HotCall smoothed(const Argument& record) const;

    const plr_sensor_info& sensor_info(std::int32_t sensor) const;
    std::int64_t measured(std::int32_t sensor) const { return sensor_info(sensor).measurement->size; }
    /// An output as an input of another call.
    static Argument argument(const HotCall& call, const Execution& done, std::size_t output, const std::string& name);
    /// The extent that predict is given where it wants one: a sphere of 5 m.
    Argument extent(std::int64_t count) const;

    const Instance& instance;
    const plr_estimator& table;
    const plr_estimator_info& info;
    const std::int64_t n, c, axes;

private:
    using MomentsFunction = plr_status (*)(const void*, const plr_call*, const plr_estimator_moments*);
    HotCall moments_call(const char* name, MomentsFunction function, std::int64_t size, const Argument& record) const;
};

/// Tracks under way: records that have been started, predicted and updated, each with other numbers.
Argument estimator_records(const EstimatorCalls& calls, Sample& sample, std::int64_t count);
/// A measurement near what the sensor should see of each record, and its noise.
struct Measured {
    Argument measurement, noise;
};
Measured measured_near(const EstimatorCalls& calls, std::int32_t sensor, const Argument& record, Sample& sample);

}  // namespace pelorus::conformance
