// The filter's step: prediction, the look of a sensor, update.
#include "../../common/gaussian/blocks.hpp"
#include "kalman.hpp"

#include <algorithm>

#include <pelorus/sensor.hpp>

namespace kalman {

using gaussian::items_of;
using gaussian::Outcomes;
using gaussian::settled;
using gaussian::still_good;
using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;

// -------------------------------------------------------------------------------------------------- prediction

plr_status Kalman::predict(const plr_call& call, const plr_estimator_predict& args) const {
    check_predict(args);
    return in_runs(
        call, args, [&](const plr_call& here, const plr_estimator_predict& run) { return copy_records(here, run); },
        [&](const plr_call& here, const plr_estimator_predict& run) {
            if (form == gaussian::Form::square_root)
                return structure_ != nullptr ? predict_structured(here, run) : predict_linearised(here, run);
            return structure_ != nullptr ? predict_by_blocks(here, run) : predict_fully(here, run);
        });
}

plr_status Kalman::predict_by_blocks(const plr_call& call, const plr_estimator_predict& args) const {
    const std::int64_t size = structure_->block * structure_->block;
    const Scratch scratch(call, 2 * size * block_items);
    Blocks blocks(scratch.data(), size);
    return in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        ask_for_blocks(block, slice(args.dt, first, items), blocks);
        Outcomes outcomes = still_good(block, items);
        by_blocks_(items)({structure_->block, structure_->dimension, blocks.upper_triangular, blocks.common >= items,
                           static_cast<int>(items), blocks.transition, blocks.noise, items_of(args.record, first),
                           items_of(args.out, first), outcomes.data()});
        return settled(block, items, outcomes);
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
        Outcomes outcomes = still_good(block, items);
        fully_(items)({static_cast<int>(n_), static_cast<int>(items), items_of(as_const(told.transition), 0, common),
                       items_of(as_const(told.noise), 0, common), items_of(as_const(told.predicted), 0),
                       items_of(args.record, first), items_of(args.out, first), outcomes.data()});
        return for_good_items(block, items, [&](std::int64_t i) {
            require(outcomes[static_cast<std::size_t>(i)]);
            std::copy_n(at(told.record, i), motion_record_, at(args.out, first + i) + n_ + n_ * n_);
        });
    });
}

// ------------------------------------------------------------------------------------------------ measurements

/// What the sensor should see of a block of records, and how that depends on the state. `memory` holds
/// block_size * look_doubles(sensor). Answers d Cartesian / d state, which lies in it; data NULL where they are the same.
plr_const_view Kalman::look(const plr_call& call, std::int32_t number, const plr_const_view& records, const Looks& out,
                            double* memory) const {
    const SensorInSlot& sensor = sensors_[static_cast<std::size_t>(number)];
    const std::int64_t items = records.count, m = sensor.m, c = sensor.c;
    const plr_view gathered = pelorus::view(memory, c, 1, items);
    auto convert = pelorus::arguments<plr_motion_convert>();
    if (!state_is_cartesian_) {
        double* const rest = memory + block_size * (c + m * c);
        convert.in = mean(records);
        convert.out = pelorus::view(rest, c_, 1, items);
        convert.jacobian = pelorus::view(rest + block_size * c_, c_, n_, items);
        tolerate(motion_.call(&plr_motion::to_cartesian, call, convert));
    }
    const plr_const_view cartesian = state_is_cartesian_ ? mean(records) : as_const(convert.out);
    const bool in_order = seen_[static_cast<std::size_t>(number)].in_order;
    const bool tells_columns = this->tells_columns(seen_[static_cast<std::size_t>(number)]);
    for (std::int64_t i = 0; i < items && !in_order; ++i) {
        for (std::int64_t k = 0; k < c; ++k)
            at(gathered, i)[k] = at(cartesian, i)[sensor.index[static_cast<std::size_t>(k)]];
    }
    const plr_const_view seen = in_order ? field(cartesian, 0, c, 1) : as_const(gathered);
    auto measure = pelorus::arguments<plr_sensor_measure>();
    measure.cartesian = seen;
    measure.out = out.predicted;
    tolerate(sensor.part.call(&plr_sensor::measure, call, measure));

    // Where the sensor is linear and nothing else differs between items, one H serves all.
    const std::int64_t asked = out.common ? 1 : items;
    auto derive = pelorus::arguments<plr_sensor_jacobian>();
    derive.cartesian = slice(seen, 0, asked);
    derive.out = pelorus::view(tells_columns ? out.jacobian : memory + block_size * c, m, c, asked);
    const plr_status derived = sensor.part.call(&plr_sensor::jacobian, call, derive);
    tolerate(derived);
    if (out.common && derived != PLR_OK && call.item_status != nullptr)
        std::fill_n(call.item_status, items, call.item_status[0]);

    for (std::int64_t i = 0; i < asked && !tells_columns; ++i)
        derive_by_state(sensor, at(derive.out, i), state_is_cartesian_ ? nullptr : at(convert.jacobian, i),
                        out.jacobian + i * m * n_);
    return as_const(convert.jacobian);
}

plr_status Kalman::project(const plr_call& call, const plr_estimator_project& args) const {
    if (form == gaussian::Form::square_root) return project_by_factors(call, args);
    const SensorInSlot& by = sensor(args.sensor);
    const Seen& seen = seen_[static_cast<std::size_t>(args.sensor)];
    const std::int64_t count = args.measurement.count;
    const bool crossed = args.cross.data != nullptr, cartesian = args.cartesian_cross.data != nullptr;
    check_project(args, by.m);
    const Scratch scratch(call, block_size * (2 * by.m * n_ + look_doubles(by)));
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        double* const rest = scratch.data() + 2 * block_size * by.m * n_;
        const Looks looks{slice(args.measurement, first, items), scratch.data(),
                          seen.can_common && block.input_stride == 0};
        const plr_const_view to_cartesian = look(block, args.sensor, records, looks, rest);

        ItemsOut cross{nullptr, 0};
        if (cartesian) cross = {scratch.data() + block_size * by.m * n_, by.m * n_};
        if (crossed) cross = items_of(args.cross, first);
        Outcomes outcomes = still_good(block, items);
        seen.kernels(items).project({static_cast<int>(n_), static_cast<int>(by.m), seen.leading,
                                     static_cast<int>(items), items_of(records, 0), jacobians(args.sensor, looks),
                                     items_of(args.covariance, first), cross, outcomes.data()});
        return for_good_items(block, items, [&](std::int64_t i) {
            require(outcomes[static_cast<std::size_t>(i)]);
            if (cartesian)
                cross_of_cartesian(to_cartesian, i, cross.first + i * cross.stride, by.m,
                                   at(args.cartesian_cross, first + i));
        });
    });
}

plr_status Kalman::update(const plr_call& call, const plr_estimator_update& args) const {
    if (form == gaussian::Form::square_root || iterations > 1) return update_iterated(call, args);
    const SensorInSlot& by = sensor(args.sensor);
    const Seen& seen = seen_[static_cast<std::size_t>(args.sensor)];
    const std::int64_t count = args.out.count, m = by.m;
    check_update(args, m);
    const Scratch scratch(call, block_size * (2 * m + m * n_ + look_doubles(by)));
    const bool is_all =
        angles_.empty() && motion_record_ == 0 && args.innovation.data == nullptr;  // that a kernel tells
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        double* const memory = scratch.data();
        const Looks looks{pelorus::view(memory, m, 1, items), memory + 2 * block_size * m,
                          seen.can_common && block.input_stride == 0};
        look(block, args.sensor, records, looks, looks.jacobian + block_size * m * n_);
        auto compare = pelorus::arguments<plr_sensor_residual>();
        compare.measurement = slice(args.measurement, first, items);
        compare.reference = as_const(looks.predicted);
        compare.out = pelorus::view(memory + block_size * m, m, 1, items);
        tolerate(by.part.call(&plr_sensor::residual, block, compare));

        Outcomes outcomes = still_good(block, items);
        seen.kernels(items).update({static_cast<int>(n_), static_cast<int>(m), seen.leading, static_cast<int>(items),
                                    items_of(records, 0), jacobians(args.sensor, looks), items_of(args.noise, first),
                                    items_of(as_const(compare.out), 0), items_of(args.out, first),
                                    items_of(args.log_likelihood, first), items_of(args.innovation_covariance, first),
                                    outcomes.data()});
        if (is_all && gaussian::all_done(outcomes, items)) return static_cast<plr_status>(PLR_OK);
        return for_good_items(block, items, [&](std::int64_t i) {
            require(outcomes[static_cast<std::size_t>(i)]);
            double* const out = at(args.out, first + i);
            wrap(out);
            if (args.innovation.data != nullptr) std::copy_n(at(compare.out, i), m, at(args.innovation, first + i));
            std::copy_n(at(records, i) + n_ + n_ * n_, motion_record_, out + n_ + n_ * n_);
        });
    });
}

}  // namespace kalman
