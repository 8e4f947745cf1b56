// The filter's step. With the parameters counted in their deviations, beta ~ N(0, I), the state is x + Sc xi + X beta, where
// Sc Sc' = P - X X' and xi ~ N(0, I) is what would be left if they were known: [Sc X] is a factor of P that has the
// cross-covariance in it. All covariances are sums of squares of such factors.
#include "schmidt.hpp"

#include <limits>

#include <pelorus/sensor.hpp>
#include <pelorus/small_matrix.hpp>

namespace schmidt {

using gaussian::Outcome;
using gaussian::require;
using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;
namespace small = pelorus::small;

namespace {

constexpr int max_state = gaussian::max_state, max_measurement = gaussian::max_measurement;
constexpr int max_joint = max_state + max_considered;
using Square = small::Bounded<max_state, max_state>;
using Joint = small::Bounded<max_state, max_joint>;
using Cross = small::Bounded<max_state, max_considered>;
using Gain = small::Bounded<max_state, max_measurement>;
using Noise = small::Bounded<max_measurement, max_measurement>;
using Slope = small::Bounded<max_measurement, max_state>;
using Seen = small::Bounded<max_measurement, max_joint>;
using Innovation = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_measurement, 1>;

/// By how much of its deviation an input is moved to either side.
constexpr double difference_step = 0.1;

}  // namespace

/// [Sc X], n x (n + q).
void Schmidt::joint_factor(const double* record, double* out) const {
    const double* const p = record + n_;
    const double* const x = cross(record);
    Square left = Eigen::Map<const Square>(p, n_, n_);
    // What the subtraction rounds off counts as unknown.
    const double rounding = 4.0 * static_cast<double>(n_) * std::numeric_limits<double>::epsilon();
    for (std::int64_t k = 0; k < q_; ++k) small::add_outer(-1.0, Eigen::Map<const Gain>(x + k * n_, n_, 1), left);
    for (std::int64_t r = 0; r < n_; ++r) {
        bool depends = false;
        for (std::int64_t k = 0; k < q_; ++k) depends = depends || x[k * n_ + r] != 0.0;
        if (depends) left.data()[r * n_ + r] += rounding * p[r * n_ + r];
    }
    Eigen::Map<Square> factor(out, n_, n_);
    if (!small::cholesky_semidefinite(left, factor))
        throw pelorus::NumericError(
            "the joint covariance of the state and the considered inputs is not positive semidefinite");
    std::copy_n(x, n_ * q_, out + n_ * n_);
}

// -------------------------------------------------------------------------------------------------- prediction

plr_status Schmidt::predict(const plr_call& call, const plr_estimator_predict& args) const {
    check_predict(args);
    const auto stand = [&](const plr_call& here, const plr_estimator_predict& run) { return copy_records(here, run); };
    const auto move = [&](const plr_call& here, const plr_estimator_predict& run) {
        const bool common = is_common(here, run);
        const Scratch scratch(here, block_size * linear_doubles());
        return in_blocks(here, run.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
            const plr_estimator_predict part = part_of(run, first, items);
            const Step told = step(scratch.data() + items * n_ * n_, items, common);
            const plr_view transition = pelorus::view(scratch.data(), n_, n_, common ? 1 : items);
            linearise(block, part, told, transition);
            return for_good_items(block, items, [&](std::int64_t i) {
                Joint joint(n_, n_ + q_), moved(n_, n_ + q_);
                joint_factor(at(part.record, i), joint.data());
                small::multiply(Eigen::Map<const Square>(at(transition, common ? 0 : i), n_, n_), joint, moved);
                Square covariance = Eigen::Map<const Square>(at(told.noise, common ? 0 : i), n_, n_);
                small::symmetrise(covariance);
                small::add_gram(moved, covariance);
                if (!small::all_finite(covariance) || !all_finite(at(told.predicted, i), n_))
                    require(Outcome::not_finite);
                for (std::int64_t r = 0; r < n_; ++r) {
                    if (covariance.data()[r * n_ + r] < 0.0) require(Outcome::prediction_indefinite);
                }
                double* const out = at(part.out, i);
                std::copy_n(at(told.predicted, i), n_, out);
                std::copy_n(covariance.data(), n_ * n_, out + n_);
                std::copy_n(at(told.record, i), motion_record_, out + n_ + n_ * n_);
                std::copy_n(moved.data() + n_ * n_, n_ * q_, cross(out));
            });
        });
    };
    return in_runs(call, args, stand, move);
}

// ------------------------------------------------------------------------------------------------ measurements

std::int64_t Schmidt::look_doubles(const SensorInSlot& sensor) const noexcept {
    const std::int64_t converted = state_is_cartesian_ ? 0 : c_ + c_ * n_;
    return sensor.c + sensor.m * (sensor.c + n_ + q_ + 2) + converted;
}

/// The inputs of a block, in `memory`: one set where they are common to all items.
Schmidt::MovedInputs Schmidt::move_inputs(const plr_call& call, std::int64_t items, double* memory) const noexcept {
    const bool common = call.inputs == nullptr || call.input_stride == 0;
    MovedInputs out{call, memory, common ? 1 : items};
    for (std::int64_t k = 0; k < out.copies; ++k)
        std::copy_n(call.inputs == nullptr ? defaults_.data() : call.inputs + k * call.input_stride, input_size_,
                    memory + k * input_size_);
    out.call.inputs = memory;
    out.call.input_stride = common ? 0 : input_size_;
    return out;
}

/// N D by central differences, N = d measurement / d input. `memory` holds block_size * (2 m + the inputs).
void Schmidt::differentiate(const plr_call& call, std::int32_t number, const plr_const_view& cartesian,
                            const plr_view& out, double* memory) const {
    const SensorInSlot& by = sensor(number);
    const std::int64_t items = cartesian.count, m = by.m;
    const MovedInputs moved = move_inputs(call, items, memory + 2 * block_size * m);
    for (std::int64_t k = 0; k < q_; ++k) {
        const Considered& considered = considered_[static_cast<std::size_t>(k)];
        const plr_view column = field(out, k * m, m, 1);
        if (considered.sensor != static_cast<std::size_t>(number) || considered.deviation == 0.0) {
            for (std::int64_t i = 0; i < items; ++i) std::fill_n(at(column, i), m, 0.0);
            continue;
        }
        const auto seen_at = [&](double shift, double* predicted) {
            for (std::int64_t c = 0; c < moved.copies; ++c) moved.values[c * input_size_ + considered.offset] += shift;
            auto measure = pelorus::arguments<plr_sensor_measure>();
            measure.cartesian = cartesian;
            measure.out = pelorus::view(predicted, m, 1, items);
            tolerate(by.part.call(&plr_sensor::measure, moved.call, measure));
            return as_const(measure.out);
        };
        const double shift = difference_step * considered.deviation;
        auto compare = pelorus::arguments<plr_sensor_residual>();
        compare.measurement = seen_at(shift, memory);
        compare.reference = seen_at(-2.0 * shift, memory + block_size * m);
        compare.out = column;
        tolerate(by.part.call(&plr_sensor::residual, call, compare));
        move_inputs(call, items, moved.values);
        for (std::int64_t i = 0; i < items; ++i) {
            for (std::int64_t r = 0; r < m; ++r) at(column, i)[r] /= 2.0 * difference_step;
        }
    }
}

/// `memory` holds block_size * (look_doubles(sensor) + the inputs).
Schmidt::Looks Schmidt::look(const plr_call& call, std::int32_t number, const plr_const_view& records,
                             const plr_view& predicted, double* memory) const {
    const SensorInSlot& by = sensor(number);
    const std::int64_t items = records.count, m = by.m, c = by.c;
    double* const slopes = memory + block_size * c;
    double* const by_state = slopes + block_size * m * c;
    double* const by_considered = by_state + block_size * m * n_;
    double* rest = by_considered + block_size * m * q_;
    Looks out{predicted, pelorus::view(by_state, m, n_, items), pelorus::view(by_considered, m, q_, items), {}};
    plr_const_view cartesian = mean(records);
    if (!state_is_cartesian_) {
        auto convert = pelorus::arguments<plr_motion_convert>();
        convert.in = mean(records);
        convert.out = pelorus::view(rest, c_, 1, items);
        convert.jacobian = pelorus::view(rest + block_size * c_, c_, n_, items);
        rest += block_size * (c_ + c_ * n_);
        tolerate(motion_.call(&plr_motion::to_cartesian, call, convert));
        cartesian = as_const(convert.out);
        out.cartesian_by_state = as_const(convert.jacobian);
    }
    const plr_view gathered = pelorus::view(memory, c, 1, items);
    for (std::int64_t i = 0; i < items; ++i) {
        for (std::int64_t k = 0; k < c; ++k)
            at(gathered, i)[k] = at(cartesian, i)[by.index[static_cast<std::size_t>(k)]];
    }
    auto measure = pelorus::arguments<plr_sensor_measure>();
    measure.cartesian = as_const(gathered);
    measure.out = predicted;
    tolerate(by.part.call(&plr_sensor::measure, call, measure));
    auto derive = pelorus::arguments<plr_sensor_jacobian>();
    derive.cartesian = as_const(gathered);
    derive.out = pelorus::view(slopes, m, c, items);
    tolerate(by.part.call(&plr_sensor::jacobian, call, derive));
    for (std::int64_t i = 0; i < items; ++i)
        derive_by_state(by, at(derive.out, i), state_is_cartesian_ ? nullptr : at(out.cartesian_by_state, i),
                        at(out.by_state, i));
    if (q_ > 0) differentiate(call, number, as_const(gathered), out.by_considered, rest);
    return out;
}

/// What is seen of [Sc X] and the parameters: G = [H Sc, H X + N D], m x (n + q), so that S = G G' + R.
void Schmidt::whiten(const double* joint, const Looks& looks, std::int64_t i, std::int64_t m,
                     double* out) const noexcept {
    small::multiply(Eigen::Map<const Slope>(at(looks.by_state, i), m, n_), Eigen::Map<const Joint>(joint, n_, n_ + q_),
                    Eigen::Map<Seen>(out, m, n_ + q_));
    const double* const own = at(looks.by_considered, i);
    for (std::int64_t e = 0; e < m * q_; ++e) out[m * n_ + e] += own[e];
}

plr_status Schmidt::project(const plr_call& call, const plr_estimator_project& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const std::int64_t m = by.m;
    check_project(args, m);
    const Scratch scratch(call, block_size * (look_doubles(by) + inputs_doubles()));
    return in_blocks(call, args.measurement.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        const Looks looks = look(block, args.sensor, records, slice(args.measurement, first, items), scratch.data());
        return for_good_items(block, items, [&](std::int64_t i) {
            Joint joint(n_, n_ + q_);
            Seen seen(m, n_ + q_);
            joint_factor(at(records, i), joint.data());
            whiten(joint.data(), looks, i, m, seen.data());
            double* const covariance = at(args.covariance, first + i);
            small::gram(seen, Eigen::Map<Noise>(covariance, m, m));
            Gain cross(n_, m);
            small::multiply_transposed(joint, seen, cross);
            if (!all_finite(at(looks.predicted, i), m) || !all_finite(covariance, m * m) || !small::all_finite(cross))
                require(Outcome::not_finite);
            if (args.cross.data != nullptr) std::copy_n(cross.data(), n_ * m, at(args.cross, first + i));
            if (args.cartesian_cross.data != nullptr)
                cross_of_cartesian(looks.cartesian_by_state, i, cross.data(), m, at(args.cartesian_cross, first + i));
        });
    });
}

/// One item's update: K = [Sc X] G' S^-1, and Joseph's form T T' + K R K' with T = [Sc X] - K G, whose last columns are the new X.
void Schmidt::learn(const plr_estimator_update& args, std::int64_t item, const Looks& looks, std::int64_t i,
                    const double* innovation) const {
    const std::int64_t m = looks.predicted.rows, all = n_ + q_;
    const double* const record = at(args.record, item);
    Joint joint(n_, all), rest(n_, all);
    Seen seen(m, all);
    joint_factor(record, joint.data());
    whiten(joint.data(), looks, i, m, seen.data());

    Noise noise(m, m);
    if (!small::cholesky_semidefinite(Eigen::Map<const Noise>(at(args.noise, item), m, m), noise))
        require(Outcome::noise_indefinite);
    small::Bounded<max_measurement, max_joint + max_measurement> array(m, all + m);
    std::copy_n(seen.data(), m * all, array.data());
    std::copy_n(noise.data(), m * m, array.data() + m * all);
    small::triangularise_rows(array, m);
    const Noise z = Eigen::Map<const Noise>(array.data(), m, m);  // Z Z' = S
    if (!small::all_finite(z)) require(Outcome::not_finite);
    for (std::int64_t r = 0; r < m; ++r) {
        if (!(z.data()[r * m + r] > 0.0)) require(Outcome::innovation_singular);
    }

    Seen weighted = seen;
    Gain gain(n_, m), noise_share(n_, m);
    small::cholesky_solve(z, weighted);
    small::multiply_transposed(joint, weighted, gain);
    small::multiply(gain, seen, rest);
    for (std::int64_t e = 0; e < n_ * all; ++e) rest.data()[e] = joint.data()[e] - rest.data()[e];
    small::multiply(gain, noise, noise_share);
    Square covariance(n_, n_);
    small::gram(rest, covariance);
    small::add_gram(noise_share, covariance);

    double mean[max_state];
    std::copy_n(record, n_, mean);
    for (std::int64_t c = 0; c < m; ++c) {
        for (std::int64_t r = 0; r < n_; ++r) mean[r] += gain.data()[c * n_ + r] * innovation[c];
    }
    if (!all_finite(mean, n_) || !small::all_finite(covariance)) require(Outcome::not_finite);
    wrap(mean);
    double* const out = at(args.out, item);
    std::copy_n(record + n_ + n_ * n_, motion_record_, out + n_ + n_ * n_);
    std::copy_n(mean, n_, out);
    std::copy_n(covariance.data(), n_ * n_, out + n_);
    std::copy_n(rest.data() + n_ * n_, n_ * q_, cross(out));
    if (args.innovation.data != nullptr) std::copy_n(innovation, m, at(args.innovation, item));
    if (args.innovation_covariance.data != nullptr)
        small::gram(z, Eigen::Map<Noise>(at(args.innovation_covariance, item), m, m));
    if (args.log_likelihood.data != nullptr)
        *at(args.log_likelihood, item) = small::log_normal(z, Eigen::Map<const Innovation>(innovation, m, 1));
}

plr_status Schmidt::update(const plr_call& call, const plr_estimator_update& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const std::int64_t m = by.m;
    check_update(args, m);
    const Scratch scratch(call, block_size * (2 * m + look_doubles(by) + inputs_doubles()));
    return in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        double* const memory = scratch.data();
        const Looks looks = look(block, args.sensor, slice(args.record, first, items),
                                 pelorus::view(memory, m, 1, items), memory + 2 * block_size * m);
        auto compare = pelorus::arguments<plr_sensor_residual>();
        compare.measurement = slice(args.measurement, first, items);
        compare.reference = as_const(looks.predicted);
        compare.out = pelorus::view(memory + block_size * m, m, 1, items);
        tolerate(by.part.call(&plr_sensor::residual, block, compare));
        return for_good_items(block, items,
                              [&](std::int64_t i) { learn(args, first + i, looks, i, at(compare.out, i)); });
    });
}

}  // namespace schmidt
