// The filter's step: prediction, the look of a sensor, update.
#include "kalman.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include <pelorus/sensor.hpp>

namespace kalman {

using pelorus::as_const;
using pelorus::NumericError;
using pelorus::Scratch;
using pelorus::slice;

namespace {

void require(Outcome outcome) {
    if (outcome != Outcome::done) throw NumericError(text(outcome));
}

}  // namespace

// -------------------------------------------------------------------------------------------------- prediction

plr_status Kalman::predict(const plr_call& call, const plr_estimator_predict& args) const {
    check_predict(args);
    return in_runs(
        call, args, [&](const plr_call& here, const plr_estimator_predict& run) { return copy_records(here, run); },
        [&](const plr_call& here, const plr_estimator_predict& run) {
            return structure_ != nullptr ? predict_by_blocks(here, run) : predict_fully(here, run);
        });
}

/// F1 and Q1 are asked for once where neighbours share the time step.
plr_status Kalman::predict_by_blocks(const plr_call& call, const plr_estimator_predict& args) const {
    double f1[max_state * max_state], q1[max_state * max_state];
    double last_dt = std::numeric_limits<double>::quiet_NaN();  // differs from every dt
    return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
        const double dt = *at(args.dt, i);
        if (dt != last_dt || call.input_stride != 0) {
            last_dt = std::numeric_limits<double>::quiet_NaN();
            const plr_call here = slice(call, i);
            const bool was_told = call.error->code != PLR_OK;
            const plr_status status = structure_->blocks(motion_.self(), &here, dt, f1, q1);
            // It speaks of a time step; the caller wants to know of which item.
            if (status != PLR_OK && !was_told && call.error->item < 0) call.error->item = call.item_offset + i;
            pelorus::require(status);
            last_dt = dt;
        }
        require(by_blocks_(structure_->block, structure_->dimension, f1, q1, moments_of(at(args.record, i)),
                           moments_of(at(args.out, i))));
    });
}

/// `memory` holds block_size * (n + 2 n n + motion record).
Kalman::Steps Kalman::steps(const plr_call& call, const plr_estimator_predict& args, std::int64_t first,
                            std::int64_t items, bool common, double* memory) const {
    const plr_const_view records = slice(args.record, first, items), dt = slice(args.dt, first, items);
    const std::int64_t asked = common ? 1 : items;
    double* const f = memory + block_size * n_;
    double* const q = f + block_size * n_ * n_;
    const Steps out{pelorus::view(memory, n_, 1, items), pelorus::view(f, n_, n_, asked),
                    pelorus::view(q, n_, n_, asked), pelorus::view(q + block_size * n_ * n_, motion_record_, 1, items)};
    auto propagate = pelorus::arguments<plr_motion_propagate>();
    propagate.dt = dt;
    propagate.state = mean(records);
    propagate.record = motion_record(records);
    propagate.out = out.predicted;
    tolerate(motion_.call(&plr_motion::propagate, call, propagate));

    auto jacobian = pelorus::arguments<plr_motion_jacobian>();
    jacobian.dt = slice(dt, 0, asked);
    jacobian.state = slice(mean(records), 0, asked);
    jacobian.record = slice(motion_record(records), 0, asked);
    jacobian.out = out.transition;
    tolerate(motion_.call(&plr_motion::jacobian, call, jacobian));

    noise(call, dt, slice(args.extent, first, items), records, covariance(records), as_const(out.predicted), out.noise);
    if (common && call.item_status != nullptr && call.item_status[0] != PLR_OK)
        std::fill_n(call.item_status, items, call.item_status[0]);

    advance(call, dt, records, covariance(records), out.record);
    return out;
}

/// A linear motion whose F and Q are common to a block of items is asked for them once.
plr_status Kalman::predict_fully(const plr_call& call, const plr_estimator_predict& args) const {
    constexpr std::uint32_t constant = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE;
    const bool common = (motion_.info().flags & constant) == constant && args.dt.item_stride == 0 &&
                        call.input_stride == 0 && motion_record_ == 0;
    const Scratch scratch(call, block_size * (n_ + 2 * n_ * n_ + motion_record_));
    return in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const Steps told = steps(block, args, first, items, common, scratch.data());
        return for_good_items(block, items, [&](std::int64_t i) {
            const std::int64_t own = common ? 0 : i;
            double* const out = at(args.out, first + i);
            require(fully_(static_cast<int>(n_), at(told.transition, own), at(told.noise, own), at(told.predicted, i),
                           moments_of(at(args.record, first + i)).covariance, moments_of(out)));
            std::copy_n(at(told.record, i), motion_record_, out + n_ + n_ * n_);
        });
    });
}

// ------------------------------------------------------------------------------------------------ measurements

/// What the sensor should see of a block of records, and how that depends on the state. `memory` holds
/// block_size * look_doubles(sensor). Answers d Cartesian / d state, which lies in it; data NULL where they are the same.
plr_const_view Kalman::look(const plr_call& call, const SensorInSlot& sensor, const plr_const_view& records,
                            const Looks& out, double* memory) const {
    const std::int64_t items = records.count, m = sensor.m, c = sensor.c;
    const plr_view seen = pelorus::view(memory, c, 1, items);
    const plr_view jacobian = pelorus::view(memory + block_size * c, m, c, items);
    auto convert = pelorus::arguments<plr_motion_convert>();
    if (!state_is_cartesian_) {
        double* const rest = memory + block_size * (c + m * c);
        convert.in = mean(records);
        convert.out = pelorus::view(rest, c_, 1, items);
        convert.jacobian = pelorus::view(rest + block_size * c_, c_, n_, items);
        tolerate(motion_.call(&plr_motion::to_cartesian, call, convert));
    }
    const plr_const_view cartesian = state_is_cartesian_ ? mean(records) : as_const(convert.out);
    for (std::int64_t i = 0; i < items; ++i) {
        for (std::int64_t k = 0; k < c; ++k)
            at(seen, i)[k] = at(cartesian, i)[sensor.index[static_cast<std::size_t>(k)]];
    }
    auto measure = pelorus::arguments<plr_sensor_measure>();
    measure.cartesian = as_const(seen);
    measure.out = out.predicted;
    tolerate(sensor.part.call(&plr_sensor::measure, call, measure));
    auto derive = pelorus::arguments<plr_sensor_jacobian>();
    derive.cartesian = as_const(seen);
    derive.out = jacobian;
    tolerate(sensor.part.call(&plr_sensor::jacobian, call, derive));

    // d measurement / d state = (d measurement / d Cartesian) (d Cartesian / d state).
    for (std::int64_t i = 0; i < items; ++i) {
        double* const h = out.jacobian + i * m * n_;
        std::fill_n(h, m * n_, 0.0);
        for (std::int64_t k = 0; k < c; ++k) {
            const double* const column = at(jacobian, i) + k * m;
            const std::int64_t index = sensor.index[static_cast<std::size_t>(k)];
            if (state_is_cartesian_) {
                std::copy_n(column, m, h + index * m);
                continue;
            }
            for (std::int64_t s = 0; s < n_; ++s) {
                const double factor = at(convert.jacobian, i)[s * c_ + index];
                for (std::int64_t r = 0; r < m; ++r) h[s * m + r] += column[r] * factor;
            }
        }
    }
    return as_const(convert.jacobian);
}

/// P H' of the state, n x m, in Cartesian components, c x m.
void Kalman::cross_of_cartesian(const plr_const_view& jacobian, std::int64_t i, const double* cross, std::int64_t m,
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

plr_status Kalman::project(const plr_call& call, const plr_estimator_project& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const Kernels& kernels = kernels_[static_cast<std::size_t>(args.sensor)];
    const std::int64_t count = args.measurement.count;
    const bool crossed = args.cross.data != nullptr, cartesian = args.cartesian_cross.data != nullptr;
    check_project(args, by.m);
    const Scratch scratch(call, block_size * (by.m * n_ + look_doubles(by)));
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        const Looks looks{slice(args.measurement, first, items), scratch.data()};
        const plr_const_view to_cartesian = look(block, by, records, looks, scratch.data() + block_size * by.m * n_);
        return for_good_items(block, items, [&](std::int64_t i) {
            double* const projected = at(args.covariance, first + i);
            std::array<double, max_state * max_measurement> unwanted;
            double* const cross = crossed ? at(args.cross, first + i) : cartesian ? unwanted.data() : nullptr;
            kernels.project(static_cast<int>(n_), static_cast<int>(by.m), moments_of(at(records, i)).covariance,
                            looks.jacobian + i * by.m * n_, projected, cross);
            if (cartesian) cross_of_cartesian(to_cartesian, i, cross, by.m, at(args.cartesian_cross, first + i));
            if (!all_finite(projected, by.m * by.m)) require(Outcome::not_finite);
        });
    });
}

plr_status Kalman::update(const plr_call& call, const plr_estimator_update& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const Kernels& kernels = kernels_[static_cast<std::size_t>(args.sensor)];
    const std::int64_t count = args.out.count, m = by.m;
    check_update(args, m);
    const Scratch scratch(call, block_size * (2 * m + m * n_ + look_doubles(by)));
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        double* const memory = scratch.data();
        const Looks looks{pelorus::view(memory, m, 1, items), memory + 2 * block_size * m};
        look(block, by, records, looks, looks.jacobian + block_size * m * n_);
        auto compare = pelorus::arguments<plr_sensor_residual>();
        compare.measurement = slice(args.measurement, first, items);
        compare.reference = as_const(looks.predicted);
        compare.out = pelorus::view(memory + block_size * m, m, 1, items);
        tolerate(by.part.call(&plr_sensor::residual, block, compare));

        return for_good_items(block, items, [&](std::int64_t i) {
            const std::int64_t item = first + i;
            const double* const record = at(records, i);
            double* const out = at(args.out, item);
            const Measured measured{looks.jacobian + i * m * n_, at(args.noise, item), at(compare.out, i)};
            const Told told{
                args.log_likelihood.data == nullptr ? nullptr : at(args.log_likelihood, item),
                args.innovation_covariance.data == nullptr ? nullptr : at(args.innovation_covariance, item)};
            require(kernels.update(static_cast<int>(n_), static_cast<int>(m), moments_of(record), measured,
                                   moments_of(out), told));
            wrap(out);
            if (args.innovation.data != nullptr) std::copy_n(measured.innovation, m, at(args.innovation, item));
            std::copy_n(record + n_ + n_ * n_, motion_record_, out + n_ + n_ * n_);
        });
    });
}

}  // namespace kalman
