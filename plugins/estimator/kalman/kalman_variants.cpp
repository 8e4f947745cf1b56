// The filter on factors of covariances, and its update by several linearisations.
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

/// S and G = H S of a block of records; they are kept in `memory`, block_size * kept_doubles(sensor).
Kalman::Whitened Kalman::whiten(const plr_call& call, std::int32_t number, const plr_const_view& records,
                                const Looks& looks, double* memory) const {
    const auto which = static_cast<std::size_t>(number);
    const int n = static_cast<int>(n_), m = static_cast<int>(sensors_[which].m), seen = seen_[which].leading;
    const std::int64_t items = records.count;
    Outcomes outcomes = still_good(call, items);
    const Whitened out{memory, {memory + block_size * n_ * n_, seen, 0, false}};
    state_kernels_(items).slope({n, m, seen, static_cast<int>(items), true, items_of(records), jacobians(number, looks),
                                 out.factors, out.image.kept, outcomes.data()});
    tolerate(settled(call, items, outcomes));
    return out;
}

/// H P H' = G G' and P H' = S G' with G = H S.
plr_status Kalman::project_by_factors(const plr_call& call, const plr_estimator_project& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const Seen& seen = seen_[static_cast<std::size_t>(args.sensor)];
    const std::int64_t m = by.m;
    check_project(args, m);
    const Scratch scratch(call, block_size * (2 * m * n_ + look_doubles(by) + kept_doubles(by)));
    const bool cartesian = args.cartesian_cross.data != nullptr;
    return in_blocks(call, args.measurement.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        double* const rest = scratch.data() + 2 * block_size * m * n_;
        const Looks looks{slice(args.measurement, first, items), scratch.data(),
                          seen.can_common && block.input_stride == 0};
        const plr_const_view to_cartesian = look(block, args.sensor, records, looks, rest);
        const Whitened by_factors = whiten(block, args.sensor, records, looks, rest + block_size * look_doubles(by));

        ItemsOut cross{nullptr, 0};
        if (cartesian) cross = {scratch.data() + block_size * m * n_, m * n_};
        if (args.cross.data != nullptr) cross = items_of(args.cross, first);
        Outcomes outcomes = still_good(block, items);
        seen.by_factors(items).project({static_cast<int>(n_), static_cast<int>(m), static_cast<int>(items),
                                        by_factors.image, by_factors.factors, items_of(args.covariance, first), cross,
                                        outcomes.data()});
        return for_good_items(block, items, [&](std::int64_t i) {
            gaussian::require(outcomes[static_cast<std::size_t>(i)]);
            if (cartesian)
                cross_of_cartesian(to_cartesian, i, cross.first + i * cross.stride, m,
                                   at(args.cartesian_cross, first + i));
        });
    });
}

/// `memory` holds block_size * kept_doubles(sensor).
plr_status Kalman::learn(const plr_call& call, std::int32_t index, const Looks& looks, const Linearisation& step,
                         double* memory) const {
    const auto which = static_cast<std::size_t>(index);
    const int n = static_cast<int>(n_), m = static_cast<int>(sensors_[which].m);
    const std::int64_t items = step.out.count;
    const Seen& seen = seen_[which];
    if (is_root()) {
        const Whitened by_factors = whiten(call, index, step.records, looks, memory);
        Outcomes outcomes = still_good(call, items);
        seen.by_factors(items).update({n, m, static_cast<int>(items), true, false, by_factors.image, by_factors.factors,
                                       items_of(step.records), items_of(step.noise), items_of(step.innovation),
                                       items_of(step.out), items_of(step.log_likelihood),
                                       items_of(step.innovation_covariance), outcomes.data()});
        return settled(call, items, outcomes);
    }
    Outcomes outcomes = still_good(call, items);
    seen.kernels(items).update({n, m, seen.leading, static_cast<int>(items), items_of(step.records),
                                jacobians(index, looks), items_of(step.noise), items_of(step.innovation),
                                items_of(step.out), items_of(step.log_likelihood), items_of(step.innovation_covariance),
                                outcomes.data()});
    return settled(call, items, outcomes);
}

/// The innovation for a linearisation at another point than the mean: z - h(x_i) - H_i (x - x_i).
void Kalman::innovate_about(const double* record, const double* point, std::int32_t number, const double* jacobian,
                            double* innovation) const {
    const auto which = static_cast<std::size_t>(number);
    const std::int64_t m = sensors_[which].m;
    double step[max_state];
    for (std::int64_t r = 0; r < n_; ++r) step[r] = record[r] - point[r];
    wrap(step);
    for (int c = 0; c < seen_[which].leading; ++c) {
        for (std::int64_t r = 0; r < m; ++r) innovation[r] -= jacobian[c * m + r] * step[c];
    }
}

/// x_i+1 = x + K_i (z - h(x_i) - H_i (x - x_i)), x_0 = x: Gauss-Newton steps on the posterior's logarithm (Bell, Cathey 1993). What an
/// update tells besides is of the first linearisation, at the prediction.
plr_status Kalman::update_iterated(const plr_call& call, const plr_estimator_update& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const std::int64_t m = by.m;
    check_update(args, m);
    const std::int64_t copies = iterations > 1 ? record_size_ : 0;
    const Scratch scratch(call, block_size * (copies + 2 * m + m * n_ + look_doubles(by) + kept_doubles(by)));
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        double* const memory = scratch.data();
        const Looks looks{pelorus::view(memory, m, 1, items), memory + 2 * block_size * m,
                          seen_[static_cast<std::size_t>(args.sensor)].can_common && block.input_stride == 0};
        double* const rest = looks.jacobian + block_size * m * n_;
        // Iterates; the last one is the result. A single step needs none.
        double* const kept = rest + block_size * look_doubles(by);
        const plr_view points = pelorus::view(kept + block_size * kept_doubles(by), record_size_, 1, items);
        const plr_view out = slice(args.out, first, items);
        Linearisation step{slice(args.record, first, items), slice(args.noise, first, items), {}, points, {}, {}};
        for (std::int64_t i = 0; i < items && iterations > 1; ++i)
            std::copy_n(at(step.records, i), record_size_, at(points, i));

        plr_status status = PLR_OK;
        for (int iteration = 0; iteration < iterations; ++iteration) {
            const bool is_first = iteration == 0;
            look(block, args.sensor, is_first ? step.records : as_const(points), looks, rest);
            auto compare = pelorus::arguments<plr_sensor_residual>();
            compare.measurement = slice(args.measurement, first, items);
            compare.reference = as_const(looks.predicted);
            compare.out = pelorus::view(memory + block_size * m, m, 1, items);
            tolerate(by.part.call(&plr_sensor::residual, block, compare));
            const ItemsIn jacobian = jacobians(args.sensor, looks);
            for (std::int64_t i = 0; i < items && !is_first; ++i)
                innovate_about(at(step.records, i), at(points, i), args.sensor, jacobian.first + i * jacobian.stride,
                               at(compare.out, i));
            step.innovation = as_const(compare.out);
            step.log_likelihood = is_first ? slice(args.log_likelihood, first, items) : plr_view{};
            step.innovation_covariance = is_first ? slice(args.innovation_covariance, first, items) : plr_view{};
            if (iteration + 1 == iterations) step.out = out;
            status = learn(block, args.sensor, looks, step, kept);
            if (status < 0) return status;
            status = for_good_items(block, items, [&](std::int64_t i) {
                wrap(at(step.out, i));
                if (is_first && args.innovation.data != nullptr)
                    std::copy_n(at(compare.out, i), m, at(args.innovation, first + i));
            });
        }
        const std::int64_t own = n_ + n_ * n_;
        tolerate(for_good_items(block, items, [&](std::int64_t i) {
            std::copy_n(at(step.records, i) + own, motion_record_, at(out, i) + own);
        }));
        return status;
    };
    return in_blocks(call, args.out.count, body);
}

}  // namespace kalman
