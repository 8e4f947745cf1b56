// Prediction by factors.
#include "factor_filter.hpp"

#include "factors.hpp"

#include <limits>

namespace gaussian {

using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;

namespace {

using Square = small::Bounded<max_state, max_state>;

/// (F1 (x) I) S for d axes.
void multiply_blocks(int blocks, int axes, const double* f1, const double* s, int n, double* out) noexcept {
    std::fill_n(out, n * n, 0.0);
    for (int c = 0; c < n; ++c) {
        const double* const from = s + c * n;
        double* const to = out + c * n;
        for (int k = c / axes; k < blocks; ++k) {  // S is 0 above its diagonal
            for (int r = 0; r < blocks; ++r) {
                const double factor = f1[k * blocks + r];
                for (int axis = 0; axis < axes; ++axis) to[r * axes + axis] += factor * from[k * axes + axis];
            }
        }
    }
}

/// A1 (x) I, n x n.
void expand_blocks(int blocks, int axes, const double* a1, double* out) noexcept {
    const int n = blocks * axes;
    std::fill_n(out, n * n, 0.0);
    for (int c = 0; c < blocks; ++c) {
        for (int r = 0; r < blocks; ++r) {
            for (int axis = 0; axis < axes; ++axis) out[(c * axes + axis) * n + r * axes + axis] = a1[c * blocks + r];
        }
    }
}

}  // namespace

void FactorFilter::setup_factors() {
    predict_ = predict_kernel(form_, static_cast<int>(n_));
    if (form_ == Form::square_root) noise_factor_ = motion_.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
}

/// What a step needs for an item, besides points.
std::int64_t FactorFilter::step_doubles() const noexcept {
    const std::int64_t noise = noise_factor_ != nullptr ? n_ * noise_factor_->columns : n_ * n_;
    return n_ + noise + n_ * n_ + motion_record_;
}

const double* FactorFilter::factor(const double* record, double* memory) const {
    if (form_ == Form::square_root) return record + n_;
    Eigen::Map<Square> s(memory, n_, n_);
    if (!small::cholesky_semidefinite(Eigen::Map<const Square>(record + n_, n_, n_), s))
        require(Outcome::covariance_indefinite);
    return memory;
}

plr_const_view FactorFilter::factors(const plr_call& call, const plr_const_view& records, double* memory) const {
    if (form_ == Form::square_root) return spread(records);
    const plr_view out = pelorus::view(memory, n_, n_, records.count);
    tolerate(for_good_items(call, records.count, [&](std::int64_t i) {
        Square own = Square::Zero(n_, n_);
        std::copy_n(own.data(), n_ * n_, at(out, i));
        std::copy_n(factor(at(records, i), own.data()), n_ * n_, at(out, i));
    }));
    return as_const(out);
}

plr_status FactorFilter::predict_structured(const plr_call& call, const plr_estimator_predict& args) const {
    const int b = structure_->block, d = structure_->dimension, n = static_cast<int>(n_);
    double f1[max_state * max_state], q1[max_state * max_state], noise[max_state * max_state];
    const bool is_root = form_ == Form::square_root;
    const MotionNoise motion_noise{noise, is_root ? MotionNoise::Kind::triangle : MotionNoise::Kind::covariance, 0};
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
            Eigen::Map<Square> q(q1, b, b);
            if (is_root && !small::cholesky_semidefinite(q, q)) require(Outcome::motion_noise_indefinite);
            expand_blocks(b, d, q1, noise);
            last_dt = dt;
        }
        double slope[max_state * max_state], own[max_state * max_state], mean[max_state] = {};
        const double* const record = at(args.record, i);
        multiply_blocks(b, d, f1, factor(record, own), n, slope);
        for (int k = 0; k < b; ++k) {
            for (int r = 0; r < b; ++r) {
                for (int axis = 0; axis < d; ++axis) mean[r * d + axis] += f1[k * b + r] * record[k * d + axis];
            }
        }
        if (!all_finite(mean, n)) require(Outcome::not_finite);
        double* const out = at(args.out, i);
        require(predict_(n, Image{slope}, motion_noise, out + n));
        std::copy_n(mean, n, out);
    });
}

FactorFilter::Step FactorFilter::step(double* memory, std::int64_t items, bool common) const {
    const std::int64_t columns = noise_factor_ != nullptr ? noise_factor_->columns : n_;
    double* const noise = memory + items * n_;
    double* const record = noise + items * n_ * columns;
    return {pelorus::view(memory, n_, 1, items), pelorus::view(noise, n_, columns, common ? 1 : items),
            pelorus::view(record, motion_record_, 1, items)};
}

void FactorFilter::noise_and_record(const plr_call& call, const plr_estimator_predict& args, const Step& step) const {
    const bool is_wanted = (motion_.info().flags & PLR_MOTION_CONSTANT_NOISE) == 0 || motion_record_ > 0;
    const std::int64_t items = args.record.count;
    const plr_const_view covariance = is_wanted ? covariances(args.record, step.record.data + items * motion_record_)
                                                : plr_const_view{nullptr, n_, n_, items, 1, n_, 0};
    const plr_motion_noise ask =
        noise_arguments(args.dt, args.extent, args.record, covariance, as_const(step.predicted), step.noise);
    tolerate(noise_factor_ != nullptr ? noise_factor_->factor(motion_.self(), &call, &ask)
                                      : motion_.call(&plr_motion::noise, call, ask));
    advance(call, args.dt, args.record, covariance, step.record);
}

MotionNoise FactorFilter::noise_of(const Step& step, std::int64_t i) const noexcept {
    const double* const data = at(step.noise, step.noise.count == 1 ? 0 : i);
    if (noise_factor_ == nullptr) return {data, MotionNoise::Kind::covariance, 0};
    return {data, MotionNoise::Kind::factor, noise_factor_->columns};
}

void FactorFilter::finish(const Step& step, const Image& image, std::int64_t i, double* out) const {
    if (!all_finite(at(step.predicted, i), n_)) require(Outcome::not_finite);
    require(predict_(static_cast<int>(n_), image, noise_of(step, i), out + n_));
    std::copy_n(at(step.predicted, i), n_, out);
    std::copy_n(at(step.record, i), motion_record_, out + n_ + n_ * n_);
}

plr_estimator_predict FactorFilter::part_of(const plr_estimator_predict& args, std::int64_t first,
                                            std::int64_t items) noexcept {
    plr_estimator_predict part = args;
    part.dt = slice(args.dt, first, items);
    part.extent = slice(args.extent, first, items);
    part.record = slice(args.record, first, items);
    part.out = slice(args.out, first, items);
    return part;
}

bool FactorFilter::is_common(const plr_call& call, const plr_estimator_predict& args) const noexcept {
    constexpr std::uint32_t constant = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE;
    return (motion_.info().flags & constant) == constant && args.dt.item_stride == 0 && call.input_stride == 0 &&
           motion_record_ == 0;
}

void FactorFilter::linearise(const plr_call& call, const plr_estimator_predict& args, const Step& step,
                             const plr_view& transition) const {
    auto propagate = pelorus::arguments<plr_motion_propagate>();
    propagate.dt = args.dt;
    propagate.state = mean(args.record);
    propagate.record = motion_record(args.record);
    propagate.out = step.predicted;
    tolerate(motion_.call(&plr_motion::propagate, call, propagate));
    auto jacobian = pelorus::arguments<plr_motion_jacobian>();
    const std::int64_t asked = transition.count;
    jacobian.dt = slice(args.dt, 0, asked);
    jacobian.state = slice(propagate.state, 0, asked);
    jacobian.record = slice(propagate.record, 0, asked);
    jacobian.out = transition;
    tolerate(motion_.call(&plr_motion::jacobian, call, jacobian));
    noise_and_record(call, args, step);
    if (asked < args.record.count && call.item_status != nullptr && call.item_status[0] != PLR_OK)
        std::fill_n(call.item_status, args.record.count, call.item_status[0]);
}

plr_status FactorFilter::predict_linearised(const plr_call& call, const plr_estimator_predict& args) const {
    const bool common = is_common(call, args);
    const Scratch scratch(call, block_size * linear_doubles());
    return in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_estimator_predict part = part_of(args, first, items);
        const Step told = step(scratch.data() + items * n_ * n_, items, common);
        const plr_view transition = pelorus::view(scratch.data(), n_, n_, common ? 1 : items);
        linearise(block, part, told, transition);
        return for_good_items(block, items, [&](std::int64_t i) {
            Square own(n_, n_), slope(n_, n_);
            const double* const s = factor(at(part.record, i), own.data());
            small::multiply(Eigen::Map<const Square>(at(transition, common ? 0 : i), n_, n_),
                            Eigen::Map<const Square>(s, n_, n_), slope);
            finish(told, Image{slope.data()}, i, at(part.out, i));
        });
    });
}

}  // namespace gaussian
