// What a point filter is made from, and its prediction.
#include "point_filter.hpp"

#include "factors.hpp"

#include <limits>

namespace gaussian {

using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;

namespace {

using Square = small::Bounded<max_state, max_state>;

/// Items of a block, so that its points fit into some 100 kB.
std::int64_t items_of(const PointRule& rule) noexcept {
    return std::clamp<std::int64_t>(512 / rule.count(), 1, block_size);
}

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

void PointFilter::setup_points(const PointRule& rule, plr_estimator_info& info) {
    rule_ = rule;
    items_ = items_of(rule);
    predict_ = predict_kernel(form_, static_cast<int>(n_));
    for (std::int64_t r = 0; r < n_; ++r) all_rows_.push_back(r);
    if (form_ == Form::square_root) noise_factor_ = motion_.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);

    std::int64_t doubles = step_doubles() + n_ * n_;  // a linear motion
    doubles = std::max(doubles, items_ * (step_doubles() + 2 * n_ * rule.count() + n_ * n_ + n_) / block_size + 1);
    for (const SensorInSlot& sensor : sensors_) {
        Looker looker;
        const std::int64_t last = *std::max_element(sensor.index.begin(), sensor.index.end());
        looker.rule = leading_rule(rule, state_is_cartesian_ ? last + 1 : n_);
        looker.items = items_of(looker.rule);
        looker.kernel = update_kernel(form_, static_cast<int>(n_), static_cast<int>(sensor.m));
        looker.is_linear = state_is_cartesian_ && (sensor.part.info().flags & PLR_SENSOR_LINEAR) != 0;
        const pelorus::Space measurement(*sensor.part.info().measurement);
        for (int r = 0; r < measurement.size(); ++r) {
            if (measurement[r].angle) looker.angles.push_back(r);
        }
        lookers_.push_back(std::move(looker));
        const std::size_t here = lookers_.size() - 1;
        doubles = std::max(doubles, lookers_[here].items * look_doubles(here) / block_size + 1);
    }
    info.scratch_bytes = scratch_for(doubles);
}

/// What a step needs for an item, besides points.
std::int64_t PointFilter::step_doubles() const noexcept {
    const std::int64_t noise = noise_factor_ != nullptr ? n_ * noise_factor_->columns : n_ * n_;
    return n_ + noise + n_ * n_ + motion_record_;
}

/// The factor of a record's covariance: its own, or worked out into `memory`, n x n.
const double* PointFilter::factor(const double* record, double* memory) const {
    if (form_ == Form::square_root) return record + n_;
    Eigen::Map<Square> s(memory, n_, n_);
    if (!small::cholesky_semidefinite(Eigen::Map<const Square>(record + n_, n_, n_), s))
        require(Outcome::covariance_indefinite);
    return memory;
}

/// The same for a block of records, into `memory`, n x n an item; 0 where there is none, and the item has failed.
plr_const_view PointFilter::factors(const plr_call& call, const plr_const_view& records, double* memory) const {
    if (form_ == Form::square_root) return spread(records);
    const plr_view out = pelorus::view(memory, n_, n_, records.count);
    tolerate(for_good_items(call, records.count, [&](std::int64_t i) {
        Square own = Square::Zero(n_, n_);
        std::copy_n(own.data(), n_ * n_, at(out, i));
        std::copy_n(factor(at(records, i), own.data()), n_ * n_, at(out, i));
    }));
    return as_const(out);
}

plr_status PointFilter::predict(const plr_call& call, const plr_estimator_predict& args) const {
    check_predict(args);
    const bool is_linear = (motion_.info().flags & PLR_MOTION_LINEAR) != 0;
    return in_runs(
        call, args, [&](const plr_call& here, const plr_estimator_predict& run) { return copy_records(here, run); },
        [&](const plr_call& here, const plr_estimator_predict& run) {
            if (structure_ != nullptr) return predict_by_blocks(here, run);
            return is_linear ? predict_linear(here, run) : predict_points(here, run);
        });
}

/// F1 and Q1 are asked for once where neighbours share the time step.
plr_status PointFilter::predict_by_blocks(const plr_call& call, const plr_estimator_predict& args) const {
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

/// `memory` holds step_doubles() an item.
PointFilter::Step PointFilter::step(double* memory, std::int64_t items, bool common) const {
    const std::int64_t columns = noise_factor_ != nullptr ? noise_factor_->columns : n_;
    double* const noise = memory + items * n_;
    double* const record = noise + items * n_ * columns;
    return {pelorus::view(memory, n_, 1, items), pelorus::view(noise, n_, columns, common ? 1 : items),
            pelorus::view(record, motion_record_, 1, items)};
}

/// What the motion tells of a step once its mean is known. The covariances that it may want follow the step in memory.
void PointFilter::noise_and_record(const plr_call& call, const plr_estimator_predict& args, const Step& step) const {
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

MotionNoise PointFilter::noise_of(const Step& step, std::int64_t i) const noexcept {
    const double* const data = at(step.noise, step.noise.count == 1 ? 0 : i);
    if (noise_factor_ == nullptr) return {data, MotionNoise::Kind::covariance, 0};
    return {data, MotionNoise::Kind::factor, noise_factor_->columns};
}

/// The record of item i after the step.
void PointFilter::finish(const Step& step, const Image& image, std::int64_t i, double* out) const {
    if (!all_finite(at(step.predicted, i), n_)) require(Outcome::not_finite);
    require(predict_(static_cast<int>(n_), image, noise_of(step, i), out + n_));
    std::copy_n(at(step.predicted, i), n_, out);
    std::copy_n(at(step.record, i), motion_record_, out + n_ + n_ * n_);
}

/// F is asked for once, and so is Q, where both are common to a block of items.
plr_status PointFilter::predict_linear(const plr_call& call, const plr_estimator_predict& args) const {
    const bool common = (motion_.info().flags & PLR_MOTION_CONSTANT_NOISE) != 0 && args.dt.item_stride == 0 &&
                        call.input_stride == 0 && motion_record_ == 0;
    const Scratch scratch(call, block_size * (step_doubles() + n_ * n_));
    return in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        plr_estimator_predict part = args;
        part.dt = slice(args.dt, first, items);
        part.extent = slice(args.extent, first, items);
        part.record = slice(args.record, first, items);
        const Step told = step(scratch.data() + items * n_ * n_, items, common);
        auto propagate = pelorus::arguments<plr_motion_propagate>();
        propagate.dt = part.dt;
        propagate.state = mean(part.record);
        propagate.record = motion_record(part.record);
        propagate.out = told.predicted;
        tolerate(motion_.call(&plr_motion::propagate, block, propagate));
        auto jacobian = pelorus::arguments<plr_motion_jacobian>();
        const std::int64_t asked = common ? 1 : items;
        jacobian.dt = slice(part.dt, 0, asked);
        jacobian.state = slice(propagate.state, 0, asked);
        jacobian.record = slice(propagate.record, 0, asked);
        jacobian.out = pelorus::view(scratch.data(), n_, n_, asked);
        tolerate(motion_.call(&plr_motion::jacobian, block, jacobian));
        noise_and_record(block, part, told);
        if (common && block.item_status != nullptr && block.item_status[0] != PLR_OK)
            std::fill_n(block.item_status, items, block.item_status[0]);
        return for_good_items(block, items, [&](std::int64_t i) {
            Square own(n_, n_), slope(n_, n_);
            const double* const s = factor(at(part.record, i), own.data());
            small::multiply(Eigen::Map<const Square>(at(jacobian.out, common ? 0 : i), n_, n_),
                            Eigen::Map<const Square>(s, n_, n_), slope);
            finish(told, Image{slope.data()}, i, at(args.out, first + i));
        });
    });
}

plr_status PointFilter::predict_points(const plr_call& call, const plr_estimator_predict& args) const {
    const std::int64_t p = rule_.count(), own_doubles = 2 * n_ * p + n_ * n_ + n_;
    const Scratch scratch(call, items_ * (step_doubles() + own_doubles));
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        plr_estimator_predict part = args;
        part.dt = slice(args.dt, first, items);
        part.extent = slice(args.extent, first, items);
        part.record = slice(args.record, first, items);
        double* const memory = scratch.data();
        const plr_view points = pelorus::view(memory, n_, p, items);
        const plr_view moved = pelorus::view(memory + items * n_ * p, n_, p, items);
        double* const slopes = memory + 2 * items * n_ * p;
        double* const downdates = slopes + items * n_ * n_;
        const Step told = step(memory + items * own_doubles, items, false);
        const plr_const_view roots = factors(block, part.record, slopes);  // which are made later
        for (std::int64_t i = 0; i < items; ++i)
            place_points(rule_, at(part.record, i), at(roots, i), n_, all_rows_, at(points, i));
        auto propagate = pelorus::arguments<plr_motion_propagate>();
        propagate.dt = part.dt;
        propagate.state = as_const(points);
        propagate.record = motion_record(part.record);
        propagate.out = moved;
        propagate.mean = mean(part.record);
        tolerate(motion_.call(&plr_motion::propagate, block, propagate));

        std::array<Image, block_size> images;
        for (std::int64_t i = 0; i < items; ++i) {
            double* const values = at(moved, i);
            double* const predicted = at(told.predicted, i);
            std::copy_n(values, n_, predicted);
            for (std::int64_t k = 1; k < p; ++k) {
                for (std::int64_t r = 0; r < n_; ++r) values[k * n_ + r] -= predicted[r];
                wrap(values + k * n_);
            }
            double shift[max_state];
            images[static_cast<std::size_t>(i)] =
                regress(rule_, n_, n_, values, shift, slopes + i * n_ * n_, downdates + i * n_);
            for (std::int64_t r = 0; r < n_; ++r) predicted[r] += shift[r];
            wrap(predicted);
        }
        noise_and_record(block, part, told);
        return for_good_items(block, items, [&](std::int64_t i) {
            finish(told, images[static_cast<std::size_t>(i)], i, at(args.out, first + i));
        });
    };
    return in_blocks(call, args.out.count, body, items_);
}

}  // namespace gaussian
