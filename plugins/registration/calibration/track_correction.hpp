/// Tracks of the world as the calibrated sensor sees it, moved to where things are.
#pragma once

#include <array>

#include <Eigen/Core>
#include <pelorus/space.hpp>

#include "sensor_model.hpp"

namespace calibration {

/// A sensor that is turned and stands elsewhere sees a world that is turned and moved as a whole. A filter that believes it follows its
/// targets in that world without noticing, so the errors can be taken off its tracks at the end: unlike corrections of the
/// measurements, which change while they are learnt, that moves no target within the filter.
class TrackCorrection {
public:
    explicit TrackCorrection(const pelorus::Space& space);

    /// Positions, velocities and accelerations; other components stay. `covariance` gains what `estimate.covariance` leaves open.
    void operator()(const Pose& pose, const Estimate& estimate, Eigen::VectorXd& mean,
                    Eigen::MatrixXd& covariance) const;

    /// By how much everything is turned, in the frame.
    static Eigen::Matrix3d turn(const Pose& pose, const BiasVector& biases);

private:
    static constexpr int derivatives = 3;
    using Places = std::array<int, 3>;  ///< of x, y, z in the space; -1: not there

    Eigen::Vector3d gathered(const Eigen::VectorXd& mean, const Places& places) const;

    std::array<Places, derivatives> places_{};
};

}  // namespace calibration
