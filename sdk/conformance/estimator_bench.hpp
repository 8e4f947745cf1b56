/// What the laws of estimators are tried with: a filter, its moments as matrices, and what its motion and sensors say by themselves.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "estimator_calls.hpp"

namespace pelorus::conformance {

struct Gaussian {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
};

class EstimatorBench : public EstimatorCalls {
public:
    explicit EstimatorBench(const Instance& instance);

    /// Makes the call and takes its record. Fails the check unless it goes well.
    Argument run(const HotCall& call) const;
    /// One record, started from Cartesian moments of all components.
    Argument start(const Gaussian& cartesian) const;
    /// `count` tracks that have been started, predicted and updated.
    Argument tracks(Sample& sample, std::int64_t count) const { return estimator_records(*this, sample, count); }
    Argument step(const Argument& record, double dt) const;
    static Argument item_of(const Argument& record, std::int64_t item);

    Gaussian moments_of(const Argument& record) const { return gaussian(moments(record)); }
    Gaussian summary_of(const Argument& record) const { return gaussian(summary(record)); }

    /// What project answers of one record.
    struct Projection {
        Eigen::VectorXd measurement;
        Eigen::MatrixXd covariance, cross, cartesian_cross;
    };
    Projection project_of(std::int32_t sensor, const Argument& record) const;
    /// What update answers of one record.
    struct Updated {
        Argument record;
        double log_likelihood;
        Eigen::VectorXd innovation;
        Eigen::MatrixXd innovation_covariance;
    };
    Updated update_of(std::int32_t sensor, const Argument& record, const Eigen::VectorXd& measurement,
                      const Eigen::MatrixXd& noise) const;

    /// Leaves the check unless the filter has a single motion that is linear, and a Cartesian state.
    void wants_linear_motion() const;
    /// The linear sensors. Leaves the check unless there is one and the filter is one of moments.
    std::vector<std::int32_t> linear_sensors() const;
    struct Step {
        Eigen::MatrixXd transition, noise;
    };
    /// Of the single motion, asked by itself.
    Step motion_step(double dt, const Gaussian& state) const;
    /// d measurement / d state (Cartesian), m x n, asked of the sensor itself.
    Eigen::MatrixXd sensor_jacobian(std::int32_t sensor, const Eigen::VectorXd& cartesian) const;
    /// What stands in the subject's slots of that kind.
    std::vector<const plr_part*> parts(const char* table_id) const;
    std::string state_name(std::int64_t index) const;

private:
    Gaussian gaussian(const HotCall& call) const;
    const plr_part* motion_ = nullptr;  // where there is a single one
};

/// An argument of one item.
Argument given(const std::string& name, const Eigen::MatrixXd& value);
/// The name of a space's component.
std::string component_name(const plr_space& space, std::int64_t index);

}  // namespace pelorus::conformance
