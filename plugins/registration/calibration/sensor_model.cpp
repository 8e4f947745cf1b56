#include "sensor_model.hpp"

#include <cmath>

#include <Eigen/LU>
#include <pelorus/matrix.hpp>

namespace calibration {

namespace {

/// Where an object would have to be for a sensor without biases to see it as one with biases does.
Eigen::Vector3d seen_at(const Eigen::Vector3d& position, const Pose& pose, const BiasVector& biases) {
    const Eigen::Vector3d local = pose.rotation.transpose() * (position - pose.position - biases.segment<3>(offset_x));
    return pose.position + pose.rotation * (misalignment(biases).transpose() * local);
}

/// d seen_at / d position
Eigen::Matrix3d turn_back(const Pose& pose, const BiasVector& biases) {
    return pose.rotation * misalignment(biases).transpose() * pose.rotation.transpose();
}

Eigen::Vector3d perpendicular(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

}  // namespace

Eigen::Matrix3d misalignment(const BiasVector& biases) {
    const double cr = std::cos(biases(roll)), sr = std::sin(biases(roll));
    const double cp = std::cos(biases(pitch)), sp = std::sin(biases(pitch));
    const double cy = std::cos(biases(yaw)), sy = std::sin(biases(yaw));
    Eigen::Matrix3d r;
    r << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
        sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
        -sp, cp * sr, cp * cr;
    return r;
}

SensorModel::SensorModel(const pelorus::SensorPart& part, const std::string& slot)
    : part_(part), space_(*part.info().measurement) {
    const pelorus::Space looked_at(*part.info().cartesian);
    dimension_ = looked_at.size();
    if (dimension_ < 2 || dimension_ > 3 || !looked_at.same(pelorus::position_space(dimension_)))
        throw pelorus::PartError(
            slot, "sensor " + part.name() + " looks at " + looked_at.text() + ", positions alone can be compared");
    if (inverts() && !pelorus::Space(*part.info().inverse).same(looked_at))
        throw pelorus::PartError(slot, "sensor " + part.name() + " tells less than a position");
    range_ = space_.index("range");
    azimuth_ = space_.index("azimuth");
    is_zenith_ = space_.index("zenith") >= 0;
    height_ = is_zenith_ ? space_.index("zenith") : space_.index("elevation");
}

const plr_call& SensorModel::begin(pelorus::Caller& caller) const { return caller.begin(0, 1); }

Eigen::VectorXd SensorModel::measure(pelorus::Caller& caller, const Eigen::Vector3d& position) const {
    const Eigen::VectorXd at = position.head(dimension_);
    Eigen::VectorXd out(space_.size());
    auto args = pelorus::arguments<plr_sensor_measure>();
    args.cartesian = pelorus::const_view(at);
    args.out = pelorus::view(out);
    caller.require(part_.call(&plr_sensor::measure, begin(caller), args), "sensor " + name() + ", measure");
    return out;
}

Eigen::MatrixXd SensorModel::jacobian(pelorus::Caller& caller, const Eigen::Vector3d& position) const {
    const Eigen::VectorXd at = position.head(dimension_);
    Eigen::MatrixXd out(space_.size(), dimension_);
    auto args = pelorus::arguments<plr_sensor_jacobian>();
    args.cartesian = pelorus::const_view(at);
    args.out = pelorus::view(out);
    caller.require(part_.call(&plr_sensor::jacobian, begin(caller), args), "sensor " + name() + ", jacobian");
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(space_.size(), 3);
    padded.leftCols(dimension_) = out;
    return padded;
}

Eigen::VectorXd SensorModel::residual(pelorus::Caller& caller, const Eigen::VectorXd& measurement,
                                      const Eigen::VectorXd& reference) const {
    Eigen::VectorXd out(space_.size());
    auto args = pelorus::arguments<plr_sensor_residual>();
    args.measurement = pelorus::const_view(measurement);
    args.reference = pelorus::const_view(reference);
    args.out = pelorus::view(out);
    caller.require(part_.call(&plr_sensor::residual, begin(caller), args), "sensor " + name() + ", residual");
    return out;
}

Eigen::MatrixXd SensorModel::noise(pelorus::Caller& caller, const Eigen::Vector3d& position, const plr_const_view& snr,
                                   const plr_const_view& waveform) const {
    const Eigen::VectorXd at = position.head(dimension_);
    Eigen::MatrixXd out(space_.size(), space_.size());
    auto args = pelorus::arguments<plr_sensor_noise>();
    args.cartesian = pelorus::const_view(at);
    args.snr = snr;
    args.waveform = waveform;
    args.out = pelorus::view(out);
    caller.require(part_.call(&plr_sensor::noise, begin(caller), args), "sensor " + name() + ", noise");
    return out;
}

SensorModel::Fix SensorModel::invert(pelorus::Caller& caller, const Eigen::VectorXd& measurement,
                                     const std::optional<Eigen::MatrixXd>& noise, const plr_const_view& snr,
                                     const plr_const_view& waveform) const {
    const auto with = [&](const Eigen::MatrixXd& errors) {
        Eigen::VectorXd mean(dimension_);
        Eigen::MatrixXd covariance(dimension_, dimension_);
        auto args = pelorus::arguments<plr_sensor_invert>();
        args.measurement = pelorus::const_view(measurement);
        args.noise = pelorus::const_view(errors);
        args.mean = pelorus::view(mean);
        args.covariance = pelorus::view(covariance);
        caller.require(part_.call(&plr_sensor::invert, begin(caller), args), "sensor " + name() + ", invert");
        Fix fix{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
        fix.position.head(dimension_) = mean;
        fix.covariance.topLeftCorner(dimension_, dimension_) = covariance;
        return fix;
    };
    if (noise) return with(*noise);
    const Fix exact = with(Eigen::MatrixXd::Zero(space_.size(), space_.size()));
    return with(this->noise(caller, exact.position, snr, waveform));
}

/// Along: where the direction does not change.
SensorModel::Sight SensorModel::sight(pelorus::Caller& caller, const Eigen::Vector3d& position) const {
    const Eigen::MatrixXd slope = jacobian(caller, position);
    const Eigen::Vector3d across = slope.row(azimuth_).transpose().normalized();
    const Eigen::Vector3d other = dimension_ == 2 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
                                                  : Eigen::Vector3d(slope.row(height_).transpose().normalized());
    const Eigen::Vector3d along = perpendicular(across, other);
    if (!(along.norm() > 1e-9)) throw pelorus::NumericError("sensor " + name() + " has no line of sight there");
    return {along.normalized(), across, perpendicular(along.normalized(), across)};
}

/// Of a position, along the sensor's own axes.
Eigen::Vector3d SensorModel::direction(pelorus::Caller& caller, const Eigen::Vector3d& position) const {
    const Eigen::VectorXd z = measure(caller, position);
    const double height = dimension_ == 2 ? 0 : z(height_);
    const double up = is_zenith_ ? std::cos(height) : std::sin(height);
    const double level = is_zenith_ ? std::sin(height) : std::cos(height);
    return {level * std::cos(z(azimuth_)), level * std::sin(z(azimuth_)), up};
}

Pose SensorModel::pose(pelorus::Caller& caller, const Eigen::Vector3d& position) const {
    Pose out;
    if (!measures_direction()) return out;
    const Sight here = sight(caller, position);
    double apart = 1 + 0.1 * position.norm();
    for (int pass = 0; pass < 2; ++pass) {  // the second one from as far apart as the sensor is away
        const Eigen::Vector3d aside = position + apart * here.across, along = sight(caller, aside).along;
        const Eigen::Matrix3d a = Eigen::Matrix3d::Identity() - here.along * here.along.transpose(),
                              b = Eigen::Matrix3d::Identity() - along * along.transpose();
        out.position = (a + b).inverse() * (a * position + b * aside);
        apart = (position - out.position).norm();
    }
    if (dimension_ == 2) out.position.z() = 0;
    // Three directions, in the frame and along the sensor's axes, tell the rotation.
    Eigen::Matrix3d in_frame, along_axes;
    const Eigen::Vector3d third = dimension_ == 2 ? Eigen::Vector3d(out.position + Eigen::Vector3d::UnitZ())
                                                  : Eigen::Vector3d(position + apart * here.beside);
    const Eigen::Vector3d looked_at[] = {position, position + apart * here.across, third};
    for (int k = 0; k < 3; ++k) {
        in_frame.col(k) = (looked_at[k] - out.position).normalized();
        along_axes.col(k) =
            dimension_ == 2 && k == 2 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : direction(caller, looked_at[k]);
    }
    out.rotation = in_frame * along_axes.inverse();
    if (!out.position.allFinite() || !out.rotation.allFinite())
        throw pelorus::NumericError("lines of sight of sensor " + name() + " do not meet");
    return out;
}

Eigen::VectorXd SensorModel::biased(pelorus::Caller& caller, const Eigen::Vector3d& position, const Pose& pose,
                                    const BiasVector& biases) const {
    Eigen::VectorXd out = measure(caller, seen_at(position, pose, biases));
    if (range_ >= 0) out(range_) += biases(range_bias);
    return out;
}

Eigen::MatrixXd SensorModel::biased_jacobian(pelorus::Caller& caller, const Eigen::Vector3d& position, const Pose& pose,
                                             const BiasVector& biases) const {
    return jacobian(caller, seen_at(position, pose, biases)) * turn_back(pose, biases);
}

BiasSlope SensorModel::bias_slope(pelorus::Caller& caller, const Eigen::Vector3d& position, const Pose& pose,
                                  const BiasVector& biases) const {
    BiasSlope out = BiasSlope::Zero(space_.size(), bias_count);
    const Eigen::MatrixXd slope = jacobian(caller, seen_at(position, pose, biases));
    constexpr double step = 1e-6;  // rad; the rotation is smooth, differences are good to 1e-10
    for (const int angle : {roll, pitch, yaw}) {
        BiasVector up = biases, down = biases;
        up(angle) += step;
        down(angle) -= step;
        const Eigen::Vector3d moved = seen_at(position, pose, up) - seen_at(position, pose, down);
        out.col(angle) = slope * (moved / (2 * step));
    }
    out.middleCols<3>(offset_x) = -slope * turn_back(pose, biases);
    if (range_ >= 0) out(range_, range_bias) = 1;
    return out;
}

}  // namespace calibration
