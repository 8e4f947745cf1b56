#include "models.hpp"

#include <algorithm>

namespace cramer_rao {

namespace {

/// 0, 1, 2, ... for position, velocity, acceleration, jerk; -1 for anything else.
int derivative_of(const std::string& name) {
    static const char* const names[] = {"position.", "velocity.", "acceleration.", "jerk."};
    for (int k = 0; k < 4; ++k)
        if (name.rfind(names[k], 0) == 0) return k;
    return -1;
}

}  // namespace

void Models::setup(const pelorus::Setup& setup) {
    motion_ = setup.part<pelorus::MotionPart>("motion");
    const plr_motion_info& info = motion_.info();
    if (info.record_size > 0)
        throw pelorus::PartError(
            "motion", "is adaptive (" + motion_.id() + "): its noise depends on estimates, and a bound has none");
    state_ = pelorus::Space(*info.state);
    cartesian_ = pelorus::Space(*info.cartesian);
    is_cartesian_ = motion_.table().to_cartesian == nullptr;
    const pelorus::Space positions = pelorus::position_space(3);
    while (axes_ < 3 && cartesian_.index(positions[axes_].name) == axes_) ++axes_;
    if (state_.size() > most_states)
        throw pelorus::PartError("motion", "has " + std::to_string(state_.size()) + " components, at most " +
                                               std::to_string(most_states) + " are possible");
    if (axes_ == 0)
        throw pelorus::PartError("motion", "its components are " + cartesian_.text() + ", expected position.x first");
    std::uint64_t scratch = info.scratch_bytes;
    for (const pelorus::SensorPart& part : setup.parts<pelorus::SensorPart>("sensors")) {
        SensorModel model{part, pelorus::Space(*part.info().measurement), {}};
        if (model.measurement.size() > most_measured)
            throw pelorus::PartError("sensors", "sensor " + part.name() + " measures " +
                                                    std::to_string(model.measurement.size()) + " components, at most " +
                                                    std::to_string(most_measured) + " are possible");
        const pelorus::Space seen(*part.info().cartesian);
        for (const pelorus::Component& component : seen.components())
            model.components.push_back(cartesian_.index(component.name));
        scratch = std::max(scratch, part.info().scratch_bytes);
        sensors_.push_back(std::move(model));
    }
    caller_.setup(setup, static_cast<std::size_t>(scratch) + 4096);
}

std::size_t Models::sensor_index(const std::string& name) const {
    if (sensors_.size() == 1 && sensors_.front().part.name().empty()) return 0;
    for (std::size_t i = 0; i < sensors_.size(); ++i)
        if (sensors_[i].part.name() == name) return i;
    throw pelorus::DataError("there is no sensor " + name + " in the slot `sensors`");
}

Eigen::VectorXd Models::state_at(const Place& place, Eigen::MatrixXd* jacobian) {
    if (is_cartesian_) {
        if (jacobian != nullptr) *jacobian = Eigen::MatrixXd::Identity(state_.size(), state_.size());
        return place.cartesian;
    }
    Eigen::VectorXd state(state_.size());
    auto args = pelorus::arguments<plr_motion_convert>();
    args.in = pelorus::const_view(place.cartesian);
    args.out = pelorus::view(state);
    if (jacobian != nullptr) {
        jacobian->resize(state_.size(), cartesian_.size());
        args.jacobian = pelorus::view(*jacobian);
    }
    caller_.require(motion_.call(&plr_motion::from_cartesian, caller_.begin(place.time, 1), args),
                    "motion, from_cartesian");
    return state;
}

Eigen::MatrixXd Models::cartesian_over_state(const Place& place) {
    if (is_cartesian_) return Eigen::MatrixXd::Identity(cartesian_.size(), state_.size());
    const Eigen::VectorXd state = state_at(place, nullptr);
    Eigen::VectorXd cartesian(cartesian_.size());
    Eigen::MatrixXd jacobian(cartesian_.size(), state_.size());
    auto args = pelorus::arguments<plr_motion_convert>();
    args.in = pelorus::const_view(state);
    args.out = pelorus::view(cartesian);
    args.jacobian = pelorus::view(jacobian);
    caller_.require(motion_.call(&plr_motion::to_cartesian, caller_.begin(place.time, 1), args),
                    "motion, to_cartesian");
    return jacobian;
}

Eigen::MatrixXd Models::start(const Place& place, const std::vector<double>& deviations) {
    Eigen::VectorXd known(cartesian_.size());
    for (int k = 0; k < cartesian_.size(); ++k) {
        const int derivative = derivative_of(cartesian_[k].name);
        const bool told = derivative >= 0 && static_cast<std::size_t>(derivative) < deviations.size();
        known(k) = told ? deviations[static_cast<std::size_t>(derivative)] : cartesian_[k].prior_deviation;
    }
    Eigen::MatrixXd jacobian;
    state_at(place, &jacobian);
    const Eigen::MatrixXd scaled = jacobian.lazyProduct(known.asDiagonal().toDenseMatrix());
    return scaled.lazyProduct(scaled.transpose());
}

Eigen::MatrixXd Models::predicted(const Place& from, const Place& to, const Eigen::MatrixXd& covariance) {
    const double dt = static_cast<double>(to.time - from.time) * 1e-9;
    const int n = state_.size();
    const Eigen::VectorXd before = state_at(from, nullptr), after = state_at(to, nullptr);
    Eigen::MatrixXd transition(n, n), noise(n, n);
    auto slope = pelorus::arguments<plr_motion_jacobian>();
    slope.dt = pelorus::const_view(&dt, 1, 1, 1);
    slope.state = slope.mean = pelorus::const_view(before);
    slope.record = pelorus::const_view(nullptr, 0, 1, 1);
    slope.out = pelorus::view(transition);
    caller_.require(motion_.call(&plr_motion::jacobian, caller_.begin(to.time, 1), slope), "motion, jacobian");
    auto args = pelorus::arguments<plr_motion_noise>();
    args.dt = pelorus::const_view(&dt, 1, 1, 1);
    args.state = pelorus::const_view(before);
    args.covariance = pelorus::const_view(covariance);
    args.predicted = pelorus::const_view(after);
    args.record = pelorus::const_view(nullptr, 0, 1, 1);
    if ((motion_.info().flags & PLR_MOTION_USES_EXTENT) != 0) {
        if (from.extent.size() == 0)
            throw pelorus::DataError("the motion needs the extent of the object, this truth tells none");
        args.extent = pelorus::const_view(from.extent);
    }
    args.out = pelorus::view(noise);
    caller_.require(motion_.call(&plr_motion::noise, caller_.begin(to.time, 1), args), "motion, noise");
    return transition.lazyProduct(covariance.lazyProduct(transition.transpose()).eval()) + noise;
}

Eigen::VectorXd Models::seen(const SensorModel& sensor, const Place& place) const {
    const pelorus::Space space(*sensor.part.info().cartesian);
    Eigen::VectorXd out(space.size());
    for (int k = 0; k < space.size(); ++k) {
        const int from = sensor.components[static_cast<std::size_t>(k)];
        out(k) = from < 0 ? space[k].prior_mean : place.cartesian(from);
    }
    return out;
}

Eigen::MatrixXd Models::noise(std::size_t index, const Place& place) {
    const SensorModel& sensor = sensors_[index];
    const Eigen::VectorXd at = seen(sensor, place);
    Eigen::MatrixXd out(sensor.measurement.size(), sensor.measurement.size());
    auto args = pelorus::arguments<plr_sensor_noise>();
    args.cartesian = pelorus::const_view(at);
    args.out = pelorus::view(out);
    caller_.require(sensor.part.call(&plr_sensor::noise, caller_.begin(place.time, 1), args),
                    "sensor " + sensor.part.name() + ", noise");
    return out;
}

/// Over the motion's Cartesian components.
Eigen::MatrixXd Models::cartesian_jacobian(std::size_t index, const Place& place) {
    const SensorModel& sensor = sensors_[index];
    const Eigen::VectorXd at = seen(sensor, place);
    Eigen::MatrixXd own(sensor.measurement.size(), at.size());
    auto args = pelorus::arguments<plr_sensor_jacobian>();
    args.cartesian = pelorus::const_view(at);
    args.out = pelorus::view(own);
    caller_.require(sensor.part.call(&plr_sensor::jacobian, caller_.begin(place.time, 1), args),
                    "sensor " + sensor.part.name() + ", jacobian");
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(own.rows(), cartesian_.size());
    for (Eigen::Index k = 0; k < at.size(); ++k) {
        const int to = sensor.components[static_cast<std::size_t>(k)];
        if (to >= 0) out.col(to) += own.col(k);
    }
    return out;
}

Eigen::MatrixXd Models::jacobian(std::size_t sensor, const Place& place) {
    return cartesian_jacobian(sensor, place).lazyProduct(cartesian_over_state(place));
}

Eigen::MatrixXd Models::position_jacobian(std::size_t sensor, const Place& place) {
    return cartesian_jacobian(sensor, place).leftCols(axes_);
}

Eigen::MatrixXd Models::to_cartesian(const Place& place, const Eigen::MatrixXd& covariance) {
    const Eigen::MatrixXd slope = cartesian_over_state(place);
    return slope.lazyProduct(covariance.lazyProduct(slope.transpose()).eval());
}

}  // namespace cramer_rao
