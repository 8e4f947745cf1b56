/// The Gaussian model that a bound is for: motion and sensors, linearised where the object really is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <pelorus/caller.hpp>
#include <pelorus/parts.hpp>

namespace cramer_rao {

/// An object at one time, in the motion's Cartesian components; what the truth does not tell is at its prior mean.
struct Place {
    std::int64_t time = 0;  ///< ns
    Eigen::VectorXd cartesian;
    Eigen::MatrixXd extent;  ///< d x d, m^2; empty: none
    template <class Archive> void state(Archive& archive) { archive(time, cartesian, extent); }
};

constexpr int most_states = 16, most_measured = 8;  // components

class Models {
public:
    /// Takes the slots `motion` and `sensors`. Throws PartError where they do not suit.
    void setup(const pelorus::Setup& setup);

    const pelorus::Space& cartesian() const noexcept { return cartesian_; }
    struct SensorModel {
        pelorus::SensorPart part;
        pelorus::Space measurement;
        std::vector<int> components;  ///< [c] where its Cartesian components stand among those of the motion, or -1
    };
    const std::vector<SensorModel>& sensors() const noexcept { return sensors_; }
    pelorus::Caller& caller() noexcept { return caller_; }

    /// Index of the sensor of that name (a single unnamed one stands for all). Throws DataError.
    std::size_t sensor_index(const std::string& name) const;

    // All throw Failure where a part fails.
    /// Covariance at the start: the squares of `deviations` by derivative, else of the motion's priors.
    Eigen::MatrixXd start(const Place& place, const std::vector<double>& deviations);
    /// Covariance of the state a step later: F P F' + Q.
    Eigen::MatrixXd predicted(const Place& from, const Place& to, const Eigen::MatrixXd& covariance);
    /// R by the sensor model, of an object at the place.
    Eigen::MatrixXd noise(std::size_t sensor, const Place& place);
    /// H: the sensor's measurement over the state.
    Eigen::MatrixXd jacobian(std::size_t sensor, const Place& place);
    /// The sensor's measurement over the positions x, y, z (those that the motion has).
    Eigen::MatrixXd position_jacobian(std::size_t sensor, const Place& place);
    /// Covariance of the Cartesian components.
    Eigen::MatrixXd to_cartesian(const Place& place, const Eigen::MatrixXd& covariance);
    int axes() const noexcept { return axes_; }

private:
    Eigen::VectorXd state_at(const Place& place, Eigen::MatrixXd* jacobian);
    Eigen::MatrixXd cartesian_over_state(const Place& place);
    Eigen::VectorXd seen(const SensorModel& sensor, const Place& place) const;
    Eigen::MatrixXd cartesian_jacobian(std::size_t sensor, const Place& place);

    pelorus::Caller caller_;
    pelorus::MotionPart motion_;
    pelorus::Space state_, cartesian_;
    bool is_cartesian_ = true;
    int axes_ = 0;
    std::vector<SensorModel> sensors_;
};

}  // namespace cramer_rao
