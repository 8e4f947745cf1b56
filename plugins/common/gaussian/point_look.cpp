// How a point filter looks at a sensor, and what it learns of a measurement.
#include "point_filter.hpp"

#include "blocks.hpp"

#include <pelorus/sensor.hpp>

namespace gaussian {

using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;

/// What a look needs for a block: factors and images are kept; points, what is seen of them, states and their Cartesian
/// components; the predicted measurement and the innovation, or the cross-covariance.
std::int64_t PointFilter::look_doubles(std::size_t index) const noexcept {
    const SensorInSlot& sensor = sensors_[index];
    const Looker& looker = lookers_[index];
    const std::int64_t p = looker.rule.count(), m = sensor.m;
    const std::int64_t converted = state_is_cartesian_ ? 0 : (n_ + c_) * p;
    const std::int64_t kept = n_ * n_ + image_doubles(static_cast<int>(m), static_cast<int>(n_));
    return kept_items(looker.items) * kept +
           looker.items * ((sensor.c + 2 * m) * p + converted + std::max(2 * m, n_ * m));
}

PointFilter::Seen PointFilter::see_points(const plr_call& call, std::size_t index, const plr_const_view& records,
                                          double* factors, double* memory) const {
    const SensorInSlot& sensor = sensors_[index];
    const Looker& looker = lookers_[index];
    const std::int64_t items = records.count, p = looker.rule.count(), c = sensor.c;
    Seen seen{pelorus::view(memory, c, p, items), {}};
    if (state_is_cartesian_) {
        place(call, looker.rule, looker.rows, records, factors, seen.points);
        return seen;
    }
    const plr_view states = pelorus::view(memory + items * c * p, n_, p, items);
    place(call, looker.rule, looker.rows, records, factors, states);
    auto convert = pelorus::arguments<plr_motion_convert>();
    convert.in = as_const(states);
    convert.out = pelorus::view(memory + items * (c + n_) * p, c_, p, items);
    tolerate(motion_.call(&plr_motion::to_cartesian, call, convert));
    seen.cartesian = as_const(convert.out);
    for (std::int64_t i = 0; i < items; ++i) {
        for (std::int64_t k = 0; k < p; ++k) {
            for (std::int64_t r = 0; r < c; ++r)
                at(seen.points, i)[k * c + r] = at(convert.out, i)[k * c_ + sensor.index[static_cast<std::size_t>(r)]];
        }
    }
    return seen;
}

/// Fills in what a sensor sees of a block of records. `memory` holds look_doubles(sensor), but for what update and project use
/// of it themselves.
void PointFilter::look(const plr_call& call, std::size_t index, const plr_const_view& records, Sight& sight,
                       double* memory) const {
    const SensorInSlot& sensor = sensors_[index];
    const Looker& looker = lookers_[index];
    const int n = static_cast<int>(n_), rows = static_cast<int>(sensor.m);
    const std::int64_t items = records.count, p = looker.rule.count(), m = sensor.m;
    const std::int64_t room = kept_items(looker.items);
    const Points points = points_of(looker.rule);
    sight.factors = memory;
    sight.image = image_of(points, rows, looker.is_linear, memory + room * n_ * n_);
    double* const images = sight.image.kept + room * image_doubles(rows, n);
    double* const values = images + items * m * p;
    const Seen seen = see_points(call, index, records, sight.factors, values + items * m * p);
    auto measure = pelorus::arguments<plr_sensor_measure>();
    measure.cartesian = as_const(seen.points);
    measure.out = pelorus::view(images, m, p, items);
    tolerate(sensor.part.call(&plr_sensor::measure, call, measure));
    auto compare = pelorus::arguments<plr_sensor_residual>();
    compare.measurement = as_const(measure.out);
    compare.reference = plr_const_view{images, m, 1, items, 1, m, m * p};  // of the centre
    compare.out = pelorus::view(values, m, p, items);
    tolerate(sensor.part.call(&plr_sensor::residual, call, compare));

    for (std::int64_t i = 0; i < items && sight.cartesian_cross.data != nullptr && !state_is_cartesian_; ++i)
        add_cartesian_cross(looker.rule, at(seen.cartesian, i), at(compare.out, i), m, at(sight.cartesian_cross, i));
    Outcomes outcomes = still_good(call, items);
    looker.regress(items)({rows, n, static_cast<int>(items), &points, items_of(as_const(measure.out)),
                           items_of(as_const(compare.out)), items_of(sight.predicted), sight.image.kept,
                           outcomes.data()});
    for (std::int64_t i = 0; i < items; ++i) {
        for (const int angle : looker.angles)
            at(sight.predicted, i)[angle] = pelorus::wrap_angle(at(sight.predicted, i)[angle]);
    }
}

/// The covariance of Cartesian components and measurement, sum w (c - c mean)(z - z mean)', c x m.
void PointFilter::add_cartesian_cross(const PointRule& rule, const double* cartesian, const double* values,
                                      std::int64_t m, double* out) const noexcept {
    double shift_c[max_state] = {}, shift_z[max_measurement] = {}, sum = rule.covariance_weights[0];
    std::fill_n(out, c_ * m, 0.0);
    for (std::int64_t p = 1; p < rule.count(); ++p) {
        const double weight = rule.mean_weights[static_cast<std::size_t>(p)];
        const double* const c = cartesian + p * c_;
        const double* const z = values + p * m;
        sum += weight;
        for (std::int64_t r = 0; r < c_; ++r) shift_c[r] += weight * (c[r] - cartesian[r]);
        for (std::int64_t k = 0; k < m; ++k) {
            shift_z[k] += weight * z[k];
            for (std::int64_t r = 0; r < c_; ++r) out[k * c_ + r] += weight * (c[r] - cartesian[r]) * z[k];
        }
    }
    for (std::int64_t k = 0; k < m; ++k) {
        for (std::int64_t r = 0; r < c_; ++r) out[k * c_ + r] += (sum - 2.0) * shift_c[r] * shift_z[k];
    }
}

plr_status PointFilter::project(const plr_call& call, const plr_estimator_project& args) const {
    const std::int64_t m = sensor(args.sensor).m, count = args.measurement.count;
    const auto index = static_cast<std::size_t>(args.sensor);
    check_project(args, m);
    const Scratch scratch(call, look_doubles(index));
    const bool cartesian = args.cartesian_cross.data != nullptr;
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        double* const memory = scratch.data();
        Sight sight;
        sight.predicted = slice(args.measurement, first, items);
        if (cartesian) sight.cartesian_cross = slice(args.cartesian_cross, first, items);
        // The native one is the Cartesian one where the state is Cartesian.
        const plr_view cross = args.cross.data != nullptr ? slice(args.cross, first, items)
                               : cartesian                ? pelorus::view(memory, n_, m, items)
                                                          : plr_view{};
        look(block, index, slice(args.record, first, items), sight, memory + lookers_[index].items * n_ * m);
        Outcomes outcomes = still_good(block, items);
        lookers_[index].look(items).project({static_cast<int>(n_), static_cast<int>(m), static_cast<int>(items),
                                             sight.image, sight.factors, items_of(args.covariance, first),
                                             items_of(cross), outcomes.data()});
        return for_good_items(block, items, [&](std::int64_t i) {
            require(outcomes[static_cast<std::size_t>(i)]);
            if (!all_finite(at(sight.predicted, i), m)) require(Outcome::not_finite);
            if (!cartesian) return;
            double* const wanted = at(sight.cartesian_cross, i);
            if (state_is_cartesian_) std::copy_n(at(cross, i), n_ * m, wanted);
            if (!all_finite(wanted, c_ * m)) require(Outcome::not_finite);
        });
    };
    return in_blocks(call, count, body, lookers_[index].items);
}

plr_status PointFilter::update(const plr_call& call, const plr_estimator_update& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const auto index = static_cast<std::size_t>(args.sensor);
    const std::int64_t m = by.m, size = lookers_[index].items;
    check_update(args, m);
    const Scratch scratch(call, look_doubles(index));
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        double* const memory = scratch.data();
        Sight sight;
        sight.predicted = pelorus::view(memory, m, 1, items);
        look(block, index, records, sight, memory + 2 * size * m);
        auto compare = pelorus::arguments<plr_sensor_residual>();
        compare.measurement = slice(args.measurement, first, items);
        compare.reference = as_const(sight.predicted);
        compare.out = pelorus::view(memory + size * m, m, 1, items);
        tolerate(by.part.call(&plr_sensor::residual, block, compare));

        Outcomes outcomes = still_good(block, items);
        lookers_[index].look(items).update({static_cast<int>(n_), static_cast<int>(m), static_cast<int>(items),
                                            is_root(), !order_.empty(), sight.image, sight.factors, items_of(records),
                                            items_of(args.noise, first), items_of(as_const(compare.out)),
                                            items_of(args.out, first), items_of(args.log_likelihood, first),
                                            items_of(args.innovation_covariance, first), outcomes.data()});
        return for_good_items(block, items, [&](std::int64_t i) {
            require(outcomes[static_cast<std::size_t>(i)]);
            double* const out = at(args.out, first + i);
            wrap(out);
            if (args.innovation.data != nullptr) std::copy_n(at(compare.out, i), m, at(args.innovation, first + i));
            std::copy_n(at(records, i) + n_ + n_ * n_, motion_record_, out + n_ + n_ * n_);
        });
    };
    return in_blocks(call, args.out.count, body, size);
}

}  // namespace gaussian
