/// A sensor in a slot as this stage asks it: about one position at a time, and as it would measure if it were mounted otherwise.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>
#include <pelorus/caller.hpp>
#include <pelorus/parts.hpp>
#include <pelorus/space.hpp>

#include "biases.hpp"

namespace calibration {

/// How a sensor stands in the frame of the stage.
struct Pose {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< m
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< along its own axes -> along the frame's
    template <class Archive> void state(Archive& archive) { archive(position, rotation); }
};

/// Positions in m, in the frame of the stage; in the plane z is 0.
class SensorModel {
public:
    SensorModel() = default;
    /// Throws PartError(slot) for a sensor that does not look at positions alone.
    SensorModel(const pelorus::SensorPart& part, const std::string& slot);

    std::string name() const { return part_.name(); }
    const pelorus::Space& space() const noexcept { return space_; }
    int dimension() const noexcept { return dimension_; }
    bool inverts() const { return (part_.info().flags & PLR_SENSOR_CAN_INVERT) != 0; }
    bool measures_direction() const noexcept { return azimuth_ >= 0 && (dimension_ == 2 || height_ >= 0); }
    bool measures_range() const noexcept { return range_ >= 0; }
    std::uint64_t scratch_bytes() const { return part_.info().scratch_bytes; }

    Eigen::VectorXd measure(pelorus::Caller& caller, const Eigen::Vector3d& position) const;
    /// m x 3
    Eigen::MatrixXd jacobian(pelorus::Caller& caller, const Eigen::Vector3d& position) const;
    Eigen::VectorXd residual(pelorus::Caller& caller, const Eigen::VectorXd& measurement,
                             const Eigen::VectorXd& reference) const;
    /// Of an object at `position`; that of the scan's waveform and signal-to-noise ratio where they are told.
    Eigen::MatrixXd noise(pelorus::Caller& caller, const Eigen::Vector3d& position, const plr_const_view& snr,
                          const plr_const_view& waveform) const;

    struct Fix {
        Eigen::Vector3d position;
        Eigen::Matrix3d covariance;
    };
    /// What a single measurement tells. `noise` absent: the sensor's own, where the measurement says that the object is.
    Fix invert(pelorus::Caller& caller, const Eigen::VectorXd& measurement, const std::optional<Eigen::MatrixXd>& noise,
               const plr_const_view& snr, const plr_const_view& waveform) const;

    /// How the sensor stands, by what it would measure near `position`: where the lines of sight meet, and which axes its angles
    /// are counted from. At the origin along the axes of the frame where it measures no direction. Throws NumericError.
    Pose pose(pelorus::Caller& caller, const Eigen::Vector3d& position) const;

    /// What it measures with biases (its clock apart), standing so without them, and the derivatives of that.
    Eigen::VectorXd biased(pelorus::Caller& caller, const Eigen::Vector3d& position, const Pose& pose,
                           const BiasVector& biases) const;
    BiasSlope bias_slope(pelorus::Caller& caller, const Eigen::Vector3d& position, const Pose& pose,
                         const BiasVector& biases) const;
    Eigen::MatrixXd biased_jacobian(pelorus::Caller& caller, const Eigen::Vector3d& position, const Pose& pose,
                                    const BiasVector& biases) const;

private:
    const plr_call& begin(pelorus::Caller& caller) const;
    struct Sight {
        Eigen::Vector3d along, across, beside;  ///< of unit length; the latter two perpendicular to the first
    };
    Sight sight(pelorus::Caller& caller, const Eigen::Vector3d& position) const;
    Eigen::Vector3d direction(pelorus::Caller& caller, const Eigen::Vector3d& position) const;

    pelorus::SensorPart part_;
    pelorus::Space space_;
    int dimension_ = 3, range_ = -1, azimuth_ = -1, height_ = -1;  ///< components by meaning, -1: not measured
    bool is_zenith_ = false;
};

/// Rz(yaw) Ry(pitch) Rx(roll): how the sensor is turned, about its own axes, beyond where it is believed to be.
Eigen::Matrix3d misalignment(const BiasVector& biases);

}  // namespace calibration
