// How a point filter looks at a sensor, and what it learns of a measurement.
#include "point_filter.hpp"

#include "factors.hpp"

#include <pelorus/sensor.hpp>

namespace gaussian {

using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;

/// What a look needs for an item: points, what is seen, slope, downdate, factor; states and their Cartesian components.
std::int64_t PointFilter::look_doubles(std::size_t index) const noexcept {
    const SensorInSlot& sensor = sensors_[index];
    const std::int64_t p = lookers_[index].rule.count(), m = sensor.m;
    const std::int64_t converted = state_is_cartesian_ ? 0 : (n_ + c_) * p;
    return (sensor.c + 2 * m) * p + m * n_ + m + n_ * n_ + converted + 2 * m;
}

PointFilter::Seen PointFilter::see_points(const plr_call& call, std::size_t index, const plr_const_view& records,
                                          const plr_const_view& factors, double* memory) const {
    const SensorInSlot& sensor = sensors_[index];
    const PointRule& rule = lookers_[index].rule;
    const std::int64_t items = records.count, p = rule.count(), c = sensor.c;
    Seen seen{pelorus::view(memory, c, p, items), {}};
    if (state_is_cartesian_) {
        for (std::int64_t i = 0; i < items; ++i)
            place_points(rule, at(records, i), at(factors, i), n_, sensor.index, at(seen.points, i));
        return seen;
    }
    const plr_view states = pelorus::view(memory + items * c * p, n_, p, items);
    for (std::int64_t i = 0; i < items; ++i)
        place_points(rule, at(records, i), at(factors, i), n_, all_rows_, at(states, i));
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

/// Fills in what a sensor sees of a block of records. `memory` holds look_doubles(sensor) an item.
void PointFilter::look(const plr_call& call, std::size_t index, const plr_const_view& records, Sight& sight,
                       double* memory) const {
    const SensorInSlot& sensor = sensors_[index];
    const Looker& looker = lookers_[index];
    const std::int64_t items = records.count, p = looker.rule.count(), m = sensor.m;
    double* const own = memory;
    double* const slopes = own + items * n_ * n_;
    double* const downdates = slopes + items * m * n_;
    double* const images = downdates + items * m;
    double* const values = images + items * m * p;
    sight.factors = factors(call, records, own);
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

    for (std::int64_t i = 0; i < items; ++i) {
        double* const differences = at(compare.out, i);
        double* const predicted = at(sight.predicted, i);
        if (sight.cartesian_cross.data != nullptr && !state_is_cartesian_)
            add_cartesian_cross(looker.rule, at(seen.cartesian, i), differences, m, at(sight.cartesian_cross, i));
        double shift[max_measurement];
        Image& image = sight.images[static_cast<std::size_t>(i)];
        image = regress(looker.rule, n_, m, differences, shift, slopes + i * m * n_, downdates + i * m);
        if (looker.is_linear) image = Image{image.slope};
        for (std::int64_t r = 0; r < m; ++r) predicted[r] = at(measure.out, i)[r] + shift[r];
        for (const int angle : looker.angles) predicted[angle] = pelorus::wrap_angle(predicted[angle]);
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
    const std::int64_t size = lookers_[index].items;
    const Scratch scratch(call, size * look_doubles(index));
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        Sight sight;
        sight.predicted = slice(args.measurement, first, items);
        if (args.cartesian_cross.data != nullptr) sight.cartesian_cross = slice(args.cartesian_cross, first, items);
        look(block, index, slice(args.record, first, items), sight, scratch.data());
        return for_good_items(block, items, [&](std::int64_t i) {
            const Image& image = sight.images[static_cast<std::size_t>(i)];
            double* const covariance = at(args.covariance, first + i);
            image_covariance(static_cast<int>(m), static_cast<int>(n_), image, covariance);
            if (!all_finite(covariance, m * m) || !all_finite(at(sight.predicted, i), m) ||
                !all_finite(at(sight.factors, i), n_ * n_))
                require(Outcome::not_finite);
            using Square = small::Bounded<max_state, max_state>;
            using Cross = small::Bounded<max_state, max_measurement>;
            const auto cross = [&](double* out) {  // S G'
                small::multiply_transposed(
                    Eigen::Map<const Square>(at(sight.factors, i), n_, n_),
                    Eigen::Map<const small::Bounded<max_measurement, max_state>>(image.slope, m, n_),
                    Eigen::Map<Cross>(out, n_, m));
            };
            if (args.cross.data != nullptr) cross(at(args.cross, first + i));
            if (sight.cartesian_cross.data != nullptr && state_is_cartesian_) cross(at(sight.cartesian_cross, i));
        });
    };
    return in_blocks(call, count, body, size);
}

plr_status PointFilter::update(const plr_call& call, const plr_estimator_update& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const auto index = static_cast<std::size_t>(args.sensor);
    const std::int64_t m = by.m, size = lookers_[index].items;
    check_update(args, m);
    const Scratch scratch(call, size * look_doubles(index));
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        double* const memory = scratch.data();
        Sight sight;
        sight.predicted = pelorus::view(memory, m, 1, items);
        look(block, index, records, sight, memory + 2 * items * m);
        auto compare = pelorus::arguments<plr_sensor_residual>();
        compare.measurement = slice(args.measurement, first, items);
        compare.reference = as_const(sight.predicted);
        compare.out = pelorus::view(memory + items * m, m, 1, items);
        tolerate(by.part.call(&plr_sensor::residual, block, compare));

        return for_good_items(block, items, [&](std::int64_t i) {
            const std::int64_t item = first + i;
            const double* const record = at(records, i);
            double* const out = at(args.out, item);
            const Measured measured{record, at(sight.factors, i), at(args.noise, item), at(compare.out, i)};
            const Updated updated{
                out, out + n_, args.log_likelihood.data == nullptr ? nullptr : at(args.log_likelihood, item),
                args.innovation_covariance.data == nullptr ? nullptr : at(args.innovation_covariance, item)};
            require(lookers_[index].kernel(static_cast<int>(n_), static_cast<int>(m),
                                           sight.images[static_cast<std::size_t>(i)], measured, updated));
            wrap(out);
            if (args.innovation.data != nullptr) std::copy_n(measured.innovation, m, at(args.innovation, item));
            std::copy_n(record + n_ + n_ * n_, motion_record_, out + n_ + n_ * n_);
        });
    };
    return in_blocks(call, args.out.count, body, size);
}

}  // namespace gaussian
