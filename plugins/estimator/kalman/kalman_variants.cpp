// The filter on factors of covariances, and its update by several linearisations.
#include "kalman_blocks.hpp"

#include <algorithm>

#include <pelorus/sensor.hpp>
#include <pelorus/small_matrix.hpp>

namespace kalman {

namespace small = pelorus::small;
using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;

namespace {

using Square = small::Bounded<max_state, max_state>;
using Wide = small::Bounded<max_measurement, max_state>;
using Cross = small::Bounded<max_state, max_measurement>;

}  // namespace

/// H P H' = G G' and P H' = S G' with G = H S.
plr_status Kalman::project_by_factors(const plr_call& call, const plr_estimator_project& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const std::int64_t m = by.m;
    check_project(args, m);
    const Scratch scratch(call, block_size * (m * n_ + look_doubles(by)));
    const bool can_common = seen_[static_cast<std::size_t>(args.sensor)].can_common;
    return in_blocks(call, args.measurement.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        const Looks looks{slice(args.measurement, first, items), scratch.data(), can_common && block.input_stride == 0};
        const plr_const_view to_cartesian =
            look(block, args.sensor, records, looks, scratch.data() + block_size * m * n_);
        const ItemsIn jacobian = jacobians(looks, m);
        return for_good_items(block, items, [&](std::int64_t i) {
            const Eigen::Map<const Square> s(at(spread(records), i), n_, n_);
            Wide g(m, n_);
            small::multiply(Eigen::Map<const Wide>(jacobian.first + i * jacobian.stride, m, n_), s, g);
            Eigen::Map<small::Bounded<max_measurement, max_measurement>> projected(at(args.covariance, first + i), m,
                                                                                   m);
            small::gram(g, projected);
            Cross cross(n_, m);
            small::multiply_transposed(s, g, cross);
            if (!small::all_finite(projected) || !small::all_finite(cross))
                gaussian::require(gaussian::Outcome::not_finite);
            if (args.cross.data != nullptr) std::copy_n(cross.data(), n_ * m, at(args.cross, first + i));
            if (args.cartesian_cross.data != nullptr)
                cross_of_cartesian(to_cartesian, i, cross.data(), m, at(args.cartesian_cross, first + i));
        });
    });
}

plr_status Kalman::learn(const plr_call& call, std::int32_t index, const Looks& looks,
                         const Linearisation& step) const {
    const auto which = static_cast<std::size_t>(index);
    const int n = static_cast<int>(n_), m = static_cast<int>(sensors_[which].m);
    const ItemsIn jacobian = jacobians(looks, m);
    if (form == gaussian::Form::square_root)
        return for_good_items(call, step.out.count, [&](std::int64_t i) {
            learn_by_factors(index, jacobian.first + i * jacobian.stride, step, i);
        });
    Outcomes outcomes = still_good(call, step.out.count);
    seen_[which]
        .kernels(step.out.count)
        .update({n, m, seen_[which].leading, static_cast<int>(step.out.count), items_of(step.records, 0), jacobian,
                 items_of(step.noise, 0), items_of(step.innovation, 0), items_of(step.out, 0),
                 items_of(step.log_likelihood, 0), items_of(step.innovation_covariance, 0), outcomes.data()});
    return for_good_items(call, step.out.count,
                          [&](std::int64_t i) { gaussian::require(outcomes[static_cast<std::size_t>(i)]); });
}

void Kalman::learn_by_factors(std::int32_t index, const double* jacobian, const Linearisation& step,
                              std::int64_t i) const {
    const auto which = static_cast<std::size_t>(index);
    const std::int64_t m = sensors_[which].m;
    const double* const record = at(step.records, i);
    const auto wanted = [&](const plr_view& view) { return view.data == nullptr ? nullptr : at(view, i); };
    Wide g(m, n_);
    small::multiply(Eigen::Map<const Wide>(jacobian, m, n_), Eigen::Map<const Square>(record + n_, n_, n_), g);
    double* const out = at(step.out, i);
    gaussian::require(
        by_factors_[which](static_cast<int>(n_), static_cast<int>(m), gaussian::Image{g.data()},
                           {record, record + n_, at(step.noise, i), at(step.innovation, i)},
                           {out, out + n_, wanted(step.log_likelihood), wanted(step.innovation_covariance)}));
}

/// The innovation for a linearisation at another point than the mean: z - h(x_i) - H_i (x - x_i).
void Kalman::innovate_about(const double* record, const double* point, const double* jacobian, std::int64_t m,
                            double* innovation) const {
    double step[max_state];
    for (std::int64_t r = 0; r < n_; ++r) step[r] = record[r] - point[r];
    wrap(step);
    for (std::int64_t c = 0; c < n_; ++c) {
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
    const Scratch scratch(call, block_size * (copies + 2 * m + m * n_ + look_doubles(by)));
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        double* const memory = scratch.data();
        const Looks looks{pelorus::view(memory, m, 1, items), memory + 2 * block_size * m,
                          seen_[static_cast<std::size_t>(args.sensor)].can_common && block.input_stride == 0};
        double* const rest = looks.jacobian + block_size * m * n_;
        // Iterates; the last one is the result. A single step needs none.
        const plr_view points = pelorus::view(rest + block_size * look_doubles(by), record_size_, 1, items);
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
            const ItemsIn jacobian = jacobians(looks, m);
            for (std::int64_t i = 0; i < items && !is_first; ++i)
                innovate_about(at(step.records, i), at(points, i), jacobian.first + i * jacobian.stride, m,
                               at(compare.out, i));
            step.innovation = as_const(compare.out);
            step.log_likelihood = is_first ? slice(args.log_likelihood, first, items) : plr_view{};
            step.innovation_covariance = is_first ? slice(args.innovation_covariance, first, items) : plr_view{};
            if (iteration + 1 == iterations) step.out = out;
            status = learn(block, args.sensor, looks, step);
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
