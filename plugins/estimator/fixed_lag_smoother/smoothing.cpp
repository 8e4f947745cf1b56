// The step forward, which remembers what a step back needs, and the steps back.
#include <pelorus/sensor.hpp>

#include "fixed_lag_smoother.hpp"

namespace fixed_lag_smoother {

using batches::at;
using batches::expect_packed;
using batches::for_good_items;
using batches::tolerate;
using pelorus::NumericError;
using pelorus::Scratch;
namespace small = pelorus::small;

namespace {

using SquareIn = Eigen::Map<const Square>;
using SquareOut = Eigen::Map<Square>;

}  // namespace

plr_status FixedLagSmoother::predict(const plr_call& call, const plr_estimator_predict& args) const {
    expect_packed(args.dt, 1, 1, args.out.count, "dt");
    expect_record(args.record, args.out.count, "record");
    expect_record(args.out, args.out.count, "out");
    return batches::in_runs(
        call, args,
        [&](const plr_call& here, const plr_estimator_predict& run) { return copy(here, run.record, run.out); },
        [&](const plr_call& here, const plr_estimator_predict& run) { return move(here, run); });
}

plr_status FixedLagSmoother::move(const plr_call& call, const plr_estimator_predict& args) const {
    const plr_status forward = pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
        if (at(args.dt, i)[0] < 0)
            throw pelorus::UnsupportedError("dt is below 0; a smoother tells the past by `smoothed`");
    });
    if (forward < 0) return forward;
    const Scratch scratch(call, batches::block_size * (2 * n_ + 3 * n_ * n_));
    return batches::in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        plr_estimator_predict part = args;
        part.dt = pelorus::slice(args.dt, first, items);
        part.extent = pelorus::slice(args.extent, first, items);
        part.record = pelorus::slice(args.record, first, items);
        part.out = pelorus::slice(args.out, first, items);
        return move_block(block, part, scratch.data());
    });
}

plr_status FixedLagSmoother::move_block(const plr_call& call, const plr_estimator_predict& args, double* memory) const {
    const std::int64_t items = args.out.count;
    const Memory before = moments_in(memory);
    const Memory after = moments_in(memory + batches::block_size * (n_ + n_ * n_));
    double* const transitions = memory + 2 * batches::block_size * (n_ + n_ * n_);
    if (const plr_status copied = copy(call, args.record, args.out); copied < 0) return copied;
    const plr_const_view records = pelorus::as_const(args.out);
    ask_moments(call, records, before);
    auto derive = pelorus::arguments<plr_motion_jacobian>();
    derive.dt = args.dt;
    derive.state = pelorus::const_view(before.mean, n_, 1, items);
    derive.record = motion_record(records);
    derive.out = pelorus::view(transitions, n_, n_, items);
    tolerate(motion_.call(&plr_motion::jacobian, call, derive));
    if (motion_record_ > 0) {
        auto advance = pelorus::arguments<plr_motion_record>();
        advance.dt = args.dt;
        advance.state = derive.state;
        advance.covariance = pelorus::const_view(before.covariance, n_, n_, items);
        advance.record = motion_record(records);
        advance.out = motion_record(args.out);
        tolerate(motion_.call(&plr_motion::advance_record, call, advance));
    }
    plr_estimator_predict own = args;
    own.record = inside(records);
    own.out = inside(args.out);
    tolerate(filter().call(&plr_estimator::predict, call, own));
    ask_moments(call, records, after);
    return for_good_items(call, items, [&](std::int64_t i) {
        remember(at(args.out, i), at(args.dt, i)[0], SquareIn(before.covariance + i * n_ * n_, n_, n_),
                 before.mean + i * n_, SquareIn(transitions + i * n_ * n_, n_, n_), after.mean + i * n_,
                 SquareIn(after.covariance + i * n_ * n_, n_, n_));
    });
}

/// Puts a step in front of the others; the oldest goes.
void FixedLagSmoother::remember(double* record, double dt, const Square& before, const double* mean,
                                const Square& transition, const double* predicted, const Square& after) const {
    double* const first = step(record, 0).dt;
    std::copy_backward(first, first + (lag_ - 1) * step_size_, first + lag_ * step_size_);
    record[0] = std::min(record[0] + 1, static_cast<double>(lag_));
    const Step<double> here = step(record, 0);
    *here.dt = dt;
    std::copy_n(mean, n_, here.filtered);
    std::copy_n(predicted, n_, here.predicted);

    // C' = P_(k+1|k)^-1 F P_k. Where P_(k+1|k) is singular the raised pivots of cholesky_semidefinite stand for the inverse on
    // what varies; a component that does not vary has a zero row in F P_k, too.
    Square root(n_, n_);
    if (!small::cholesky(after, root) && !small::cholesky_semidefinite(after, root))
        throw NumericError("the predicted covariance is not positive semidefinite");
    for (std::int64_t k = 0; k < n_; ++k)
        if (root(k, k) == 0.0) root(k, k) = 1.0;
    Square gain_transposed(n_, n_);
    small::multiply(transition, before, gain_transposed);
    small::cholesky_solve(root, gain_transposed);
    SquareOut gain(here.gain, n_, n_);
    gain = gain_transposed.transpose();

    // D = (I - C F) P_k (I - C F)' + C Q C' with Q = P_(k+1|k) - F P_k F': Joseph's form of P_k - C P_(k+1|k) C'.
    Square share(n_, n_), noise(n_, n_), rest(n_, n_);
    small::multiply(gain, transition, share);
    share = -share;
    share.diagonal().array() += 1.0;
    small::symmetric_product(transition, before, noise);
    noise = after - noise;
    SquareOut given_next(here.given_next, n_, n_);
    small::symmetric_product(share, before, given_next);
    small::symmetric_product(gain, noise, rest);
    given_next += rest;
    if (!small::all_finite(gain) || !small::all_finite(given_next))
        throw NumericError("the smoother's gain is not finite");
}

/// From the smoothed moments after a step to those before it.
void FixedLagSmoother::step_back(const double* record, std::int64_t index, double* mean, double* covariance) const {
    const Step<const double> over = step(record, index);
    Column correction(n_, 1), moved(n_, 1);
    for (std::int64_t k = 0; k < n_; ++k) correction(k) = mean[k] - over.predicted[k];
    for (const int k : angles_) correction(k) = pelorus::wrap_angle(correction(k));
    const SquareIn gain(over.gain, n_, n_);
    small::multiply(gain, correction, moved);
    for (std::int64_t k = 0; k < n_; ++k) mean[k] = over.filtered[k] + moved(k);
    for (const int k : angles_) mean[k] = pelorus::wrap_angle(mean[k]);
    const Square after = SquareIn(covariance, n_, n_);
    SquareOut before(covariance, n_, n_);
    small::symmetric_product(gain, after, before);
    before += SquareIn(over.given_next, n_, n_);
}

plr_status FixedLagSmoother::smoothed(const plr_call& call, const plr_estimator_smoothed_args& args) const {
    const std::int64_t count = args.mean.count, most = lag_ + 1;
    expect_record(args.record, count, "record");
    expect_packed(args.known, 1, 1, count, "known");
    expect_packed(args.age, most, 1, count, "age");
    expect_packed(args.mean, c_, most, count, "mean");
    if (args.covariance.data != nullptr) expect_packed(args.covariance, c_, c_ * most, count, "covariance");
    const Scratch scratch(call, batches::block_size * (n_ + n_ * n_ + c_ * n_));
    return batches::in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        plr_estimator_smoothed_args part = args;
        part.record = pelorus::slice(args.record, first, items);
        part.known = pelorus::slice(args.known, first, items);
        part.age = pelorus::slice(args.age, first, items);
        part.mean = pelorus::slice(args.mean, first, items);
        part.covariance = pelorus::slice(args.covariance, first, items);
        return smooth_block(block, part, scratch.data());
    });
}

plr_status FixedLagSmoother::smooth_block(const plr_call& call, const plr_estimator_smoothed_args& args,
                                          double* memory) const {
    const std::int64_t items = args.mean.count, most = lag_ + 1;
    const bool is_wanted = args.covariance.data != nullptr;
    const plr_status sound = pelorus::for_items(call, items, [&](std::int64_t i) { expect_sound(at(args.record, i)); });
    if (sound < 0) return sound;
    const Memory state = moments_in(memory);
    auto newest = pelorus::arguments<plr_estimator_moments>();
    newest.record = inside(args.record);
    newest.mean = batches::field(args.mean, 0, c_, 1);
    newest.covariance = is_wanted ? batches::field(args.covariance, 0, c_, c_) : pelorus::absent_output();
    tolerate(filter().call(&plr_estimator::summary, call, newest));
    ask_moments(call, args.record, state);
    for (std::int64_t back = 0; back < lag_; ++back) {
        tolerate(for_good_items(call, items, [&](std::int64_t i) {
            const double* const record = at(args.record, i);
            if (static_cast<double>(back) < record[0])
                step_back(record, back, state.mean + i * n_, state.covariance + i * n_ * n_);
        }));
        tell(call, args, back + 1, state, memory + batches::block_size * (n_ + n_ * n_));
    }
    return for_good_items(call, items, [&](std::int64_t i) {
        const double* const record = at(args.record, i);
        const auto known = static_cast<std::int64_t>(record[0]) + 1;
        at(args.known, i)[0] = static_cast<double>(known);
        double* const age = at(args.age, i);
        std::fill_n(age, most, 0.0);
        for (std::int64_t k = 1; k < known; ++k) age[k] = age[k - 1] + *step(record, k - 1).dt;
        std::fill(at(args.mean, i) + known * c_, at(args.mean, i) + most * c_, 0.0);
        if (is_wanted)
            std::fill(at(args.covariance, i) + known * c_ * c_, at(args.covariance, i) + most * c_ * c_, 0.0);
        if (!batches::all_finite(at(args.mean, i), most * c_) ||
            (is_wanted && !batches::all_finite(at(args.covariance, i), most * c_ * c_)))
            throw NumericError("the smoothed mean or covariance is not finite");
    });
}

/// Writes the moments of a block in Cartesian components. `jacobian` holds block_size * c * n.
void FixedLagSmoother::tell(const plr_call& call, const plr_estimator_smoothed_args& args, std::int64_t index,
                            const Memory& state, double* jacobian) const {
    const std::int64_t items = args.mean.count;
    const bool is_wanted = args.covariance.data != nullptr;
    const plr_view means = batches::field(args.mean, index * c_, c_, 1);
    const auto covariance = [&](std::int64_t i) { return at(args.covariance, i) + index * c_ * c_; };
    if (state_is_cartesian_) {
        for (std::int64_t i = 0; i < items; ++i) {
            std::copy_n(state.mean + i * n_, c_, at(means, i));
            if (is_wanted) std::copy_n(state.covariance + i * n_ * n_, c_ * c_, covariance(i));
        }
        return;
    }
    auto convert = pelorus::arguments<plr_motion_convert>();
    convert.in = pelorus::const_view(state.mean, n_, 1, items);
    convert.out = means;
    if (is_wanted) convert.jacobian = pelorus::view(jacobian, c_, n_, items);
    tolerate(motion_.call(&plr_motion::to_cartesian, call, convert));
    if (!is_wanted) return;
    for (std::int64_t i = 0; i < items; ++i) {
        SquareOut out(covariance(i), c_, c_);
        small::symmetric_product(SquareIn(jacobian + i * c_ * n_, c_, n_),
                                 SquareIn(state.covariance + i * n_ * n_, n_, n_), out);
    }
}

}  // namespace fixed_lag_smoother
