// What a filter is made from, and what its step asks of its parts.
#include "filter.hpp"

#include <pelorus/abi/record.h>
#include <pelorus/sensor.hpp>
#include <pelorus/small_matrix.hpp>

namespace gaussian {

using pelorus::PartError;
namespace small = pelorus::small;

void Filter::setup_filter(const pelorus::Setup& setup, Form form, plr_estimator_info& info) {
    form_ = form;
    motion_ = setup.part<pelorus::MotionPart>("motion");
    const plr_motion_info& motion = motion_.info();
    state_ = pelorus::Space(*motion.state);
    cartesian_ = pelorus::Space(*motion.cartesian);
    n_ = state_.size();
    c_ = cartesian_.size();
    motion_record_ = motion.record_size;
    record_size_ = n_ + n_ * n_ + motion_record_;
    state_is_cartesian_ = motion_.table().to_cartesian == nullptr;
    if (n_ > max_state || c_ > max_state)
        throw PartError("motion", motion_.id() + " has " + std::to_string(std::max(n_, c_)) + " components, at most " +
                                      std::to_string(max_state) + " fit this filter");
    if (state_is_cartesian_ && !state_.same(cartesian_))
        throw PartError("motion", motion_.id() + " does not convert its state (" + state_.text() +
                                      ") to its Cartesian components (" + cartesian_.text() + ")");
    for (int i = 0; i < state_.size(); ++i) {
        if (state_[i].angle) angles_.push_back(i);
    }
    if ((motion.flags & PLR_MOTION_CONSTANT_NOISE) != 0 && motion_record_ == 0)
        structure_ = motion_.extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
    if (structure_ != nullptr && structure_->block * structure_->dimension != n_)
        throw PartError("motion", motion_.id() + " offers a structure that does not fit its state");

    const auto parts = setup.parts<pelorus::SensorPart>("sensors");
    for (const auto& part : parts) add_sensor(part);
    if (sensors_.empty()) throw PartError("sensors", "slot sensors is empty, one sensor at least is needed");

    info.flags = PLR_ESTIMATOR_ASSIGNABLE;
    if ((motion.flags & PLR_MOTION_BACKWARD) != 0) info.flags |= PLR_ESTIMATOR_BACKWARD;
    if ((motion.flags & PLR_MOTION_USES_EXTENT) != 0) info.flags |= PLR_ESTIMATOR_USES_EXTENT;
    info.state = state_.c();
    info.cartesian = cartesian_.c();
    info.record_size = record_size_;
    info.record_version = plr_mix_version(form == Form::covariance ? 1 : 2, motion.record_version);
    info.sensor_count = static_cast<std::uint32_t>(sensors_.size());
    info.sensors = &parts.front().raw();
}

void Filter::add_sensor(const pelorus::SensorPart& part) {
    SensorInSlot sensor;
    sensor.part = part;
    const pelorus::Space looks_at(*part.info().cartesian);
    sensor.m = part.info().measurement->size;
    sensor.c = looks_at.size();
    if (sensor.m > max_measurement)
        throw PartError("sensors", part.id() + " measures " + std::to_string(sensor.m) + " components, at most " +
                                       std::to_string(max_measurement) + " fit this filter");
    for (const pelorus::Component& component : looks_at.components()) {
        const int index = cartesian_.index(component.name);
        if (index < 0 || cartesian_[index].unit != component.unit)
            throw PartError("sensors", part.id() + " looks at " + component.name + " [" + component.unit + "], which " +
                                           motion_.id() + " does not have: " + cartesian_.text());
        sensor.index.push_back(index);
    }
    sensors_.push_back(std::move(sensor));
}

std::uint64_t Filter::scratch_for(std::int64_t doubles) const {
    // init and summary of a state that is not Cartesian
    if (!state_is_cartesian_) doubles = std::max(doubles, c_ + c_ * c_ + n_ * c_ + n_ * n_);
    std::uint64_t parts = motion_.info().scratch_bytes;
    for (const SensorInSlot& sensor : sensors_) parts = std::max(parts, sensor.part.info().scratch_bytes);
    return static_cast<std::uint64_t>(block_size * doubles) * sizeof(double) + parts + 2 * 64;
}

const SensorInSlot& Filter::sensor(std::int32_t index) const {
    if (index < 0 || static_cast<std::size_t>(index) >= sensors_.size())
        throw pelorus::ArgumentError("sensor: is " + std::to_string(index) + ", expected 0 to " +
                                     std::to_string(sensors_.size() - 1));
    return sensors_[static_cast<std::size_t>(index)];
}

void Filter::check_predict(const plr_estimator_predict& args) const {
    expect_packed(args.dt, 1, 1, args.out.count, "dt");
    expect_packed(args.record, record_size_, 1, args.out.count, "record");
    expect_packed(args.out, record_size_, 1, args.out.count, "out");
}

void Filter::check_project(const plr_estimator_project& args, std::int64_t m) const {
    const std::int64_t count = args.measurement.count;
    expect_packed(args.record, record_size_, 1, count, "record");
    expect_packed(args.measurement, m, 1, count, "measurement");
    expect_packed(args.covariance, m, m, count, "covariance");
    if (args.cross.data != nullptr) expect_packed(args.cross, n_, m, count, "cross");
    if (args.cartesian_cross.data != nullptr) expect_packed(args.cartesian_cross, c_, m, count, "cartesian_cross");
}

void Filter::check_update(const plr_estimator_update& args, std::int64_t m) const {
    const std::int64_t count = args.out.count;
    expect_packed(args.record, record_size_, 1, count, "record");
    expect_packed(args.measurement, m, 1, count, "measurement");
    expect_packed(args.noise, m, m, count, "noise");
    expect_packed(args.out, record_size_, 1, count, "out");
    if (args.log_likelihood.data != nullptr) expect_packed(args.log_likelihood, 1, 1, count, "log_likelihood");
    if (args.innovation.data != nullptr) expect_packed(args.innovation, m, 1, count, "innovation");
    if (args.innovation_covariance.data != nullptr)
        expect_packed(args.innovation_covariance, m, m, count, "innovation_covariance");
}

plr_motion_noise Filter::noise_arguments(const plr_const_view& dt, const plr_const_view& extent,
                                         const plr_const_view& records, const plr_const_view& covariance,
                                         const plr_const_view& predicted, const plr_view& out) const noexcept {
    auto ask = pelorus::arguments<plr_motion_noise>();
    ask.dt = pelorus::slice(dt, 0, out.count);
    ask.state = pelorus::slice(mean(records), 0, out.count);
    ask.covariance = pelorus::slice(covariance, 0, out.count);
    ask.predicted = pelorus::slice(predicted, 0, out.count);
    ask.extent = pelorus::slice(extent, 0, out.count);
    ask.record = pelorus::slice(motion_record(records), 0, out.count);
    ask.out = out;
    return ask;
}

void Filter::noise(const plr_call& call, const plr_const_view& dt, const plr_const_view& extent,
                   const plr_const_view& records, const plr_const_view& covariance, const plr_const_view& predicted,
                   const plr_view& out) const {
    tolerate(motion_.call(&plr_motion::noise, call, noise_arguments(dt, extent, records, covariance, predicted, out)));
}

void Filter::advance(const plr_call& call, const plr_const_view& dt, const plr_const_view& records,
                     const plr_const_view& covariance, const plr_view& out) const {
    if (motion_record_ == 0) return;
    auto advance = pelorus::arguments<plr_motion_record>();
    advance.dt = dt;
    advance.state = mean(records);
    advance.covariance = covariance;
    advance.record = motion_record(records);
    advance.out = out;
    tolerate(motion_.call(&plr_motion::advance_record, call, advance));
}

/// d measurement / d state = (d measurement / d Cartesian) (d Cartesian / d state).
void Filter::derive_by_state(const SensorInSlot& sensor, const double* by_cartesian, const double* cartesian_by_state,
                             double* out) const {
    const std::int64_t m = sensor.m;
    std::fill_n(out, m * n_, 0.0);
    for (std::int64_t k = 0; k < sensor.c; ++k) {
        const double* const column = by_cartesian + k * m;
        const std::int64_t index = sensor.index[static_cast<std::size_t>(k)];
        if (cartesian_by_state == nullptr) {
            std::copy_n(column, m, out + index * m);
            continue;
        }
        for (std::int64_t s = 0; s < n_; ++s) {
            const double factor = cartesian_by_state[s * c_ + index];
            for (std::int64_t r = 0; r < m; ++r) out[s * m + r] += column[r] * factor;
        }
    }
}

/// P H' of the state, n x m, in Cartesian components, c x m.
void Filter::cross_of_cartesian(const plr_const_view& jacobian, std::int64_t i, const double* cross, std::int64_t m,
                                double* out) const {
    if (state_is_cartesian_) {
        std::copy_n(cross, n_ * m, out);
        return;
    }
    using Convert = small::Bounded<max_state, max_state>;
    using Cross = small::Bounded<max_state, max_measurement>;
    small::multiply(Eigen::Map<const Convert>(at(jacobian, i), c_, n_), Eigen::Map<const Cross>(cross, n_, m),
                    Eigen::Map<Cross>(out, c_, m));
}

plr_status Filter::copy_records(const plr_call& call, const plr_estimator_predict& args) const {
    return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
        const double* const from = at(args.record, i);
        if (!all_finite(from, n_ + n_ * n_)) throw pelorus::NumericError(text(Outcome::not_finite));
        if (from != at(args.out, i)) std::copy_n(from, record_size_, at(args.out, i));
    });
}

void Filter::wrap(double* state) const noexcept {
    for (const int index : angles_) state[index] = pelorus::wrap_angle(state[index]);
}

}  // namespace gaussian
