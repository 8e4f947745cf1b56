/// Scans as points in space with the covariances of their errors.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include <pelorus/caller.hpp>
#include <pelorus/stage.hpp>

#include "plane_fit.hpp"

namespace plane_motion {

/// Converts by the sensors in the slot `sensors`, matched by name; without any, scans are points already.
class Points {
public:
    /// Throws PartError for a sensor that tells no positions in space.
    void setup(const pelorus::Setup& setup);
    /// What scans may come in.
    std::vector<pelorus::Stream> streams() const;

    /// The scan's measurements as samples. Throws DataError where there are no covariances, or numbers are not finite, and Failure
    /// where a sensor fails.
    std::vector<Sample> read(std::int64_t time, const plr_scan& scan);

    pelorus::Caller& caller() noexcept { return caller_; }

private:
    struct SensorModel {
        pelorus::SensorPart part;
        pelorus::Space measurement, inverse, cartesian;
        int axes[3];  ///< where position.x, .y, .z stand in the inverse
    };
    const SensorModel& sensor_of(const std::string& name) const;
    Sample told(const plr_scan& scan, std::int64_t i) const;
    Sample converted(const SensorModel& sensor, std::int64_t time, const plr_scan& scan, std::int64_t i);
    Eigen::MatrixXd noise(const SensorModel& sensor, std::int64_t time, const plr_scan& scan, std::int64_t i);
    void invert(const SensorModel& sensor, std::int64_t time, const Eigen::VectorXd& z, const Eigen::MatrixXd& noise,
                Eigen::VectorXd& mean, Eigen::MatrixXd& covariance);

    std::vector<SensorModel> sensors_;
    std::string frame_;
    pelorus::Caller caller_;
};

}  // namespace plane_motion
