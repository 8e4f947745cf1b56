// Prediction by factors.
#include "factor_filter.hpp"

#include "blocks.hpp"

#include <pelorus/small_matrix.hpp>

namespace gaussian {

using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;
namespace small = pelorus::small;

FactorFilter::Blocks::Blocks(double* memory, std::int64_t size) noexcept
    : transition(memory), noise(memory + size * block_items) {
    dt.fill(std::numeric_limits<double>::quiet_NaN());  // differs from every dt
    std::fill_n(memory, 2 * size * block_items, 0.0);
}

void FactorFilter::setup_factors() {
    const int n = static_cast<int>(n_);
    state_kernels_ = factor_kernels_by_items([&](const FactorKernels& all) { return all.state(n); });
    if (structure_ != nullptr)
        structured_ = factor_kernels_by_items(
            [&](const FactorKernels& all) { return all.by_blocks(structure_->block, structure_->dimension); });
    if (is_root()) noise_factor_ = motion_.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
}

/// What a step needs for an item, besides points.
std::int64_t FactorFilter::step_doubles() const noexcept {
    const std::int64_t noise = noise_factor_ != nullptr ? n_ * noise_factor_->columns : n_ * n_;
    return n_ + noise + n_ * n_ + motion_record_;
}

std::int64_t FactorFilter::linear_doubles() const noexcept {
    const int n = static_cast<int>(n_);
    return image_doubles(n, n) + n_ * n_ + step_doubles();
}

void FactorFilter::ask_for_blocks(const plr_call& call, const plr_const_view& dt, Blocks& blocks) const {
    const int b = structure_->block;
    if (dt.item_stride == 0 && call.input_stride == 0 && dt.count <= blocks.common && *at(dt, 0) == blocks.dt.front())
        return;
    tolerate(pelorus::for_items(call, dt.count, [&](std::int64_t i) {
        const auto lane = static_cast<std::size_t>(i);
        const double now = *at(dt, i);
        if (now == blocks.dt[lane] && call.input_stride == 0) return;
        if (now != blocks.last_dt || call.input_stride != 0) {
            blocks.last_dt = std::numeric_limits<double>::quiet_NaN();
            const plr_call here = slice(call, i);
            const bool was_told = call.error->code != PLR_OK;
            const plr_status status =
                structure_->blocks(motion_.self(), &here, now, blocks.f1.data(), blocks.q1.data());
            // It speaks of a time step; the caller wants to know of which item.
            if (status != PLR_OK && !was_told && call.error->item < 0) call.error->item = call.item_offset + i;
            pelorus::require(status);
            Eigen::Map<small::Bounded<max_state, max_state>> q(blocks.q1.data(), b, b);
            if (is_root() && !small::cholesky_semidefinite(q, q)) require(Outcome::motion_noise_indefinite);
            blocks.last_dt = now;
        }
        for (int e = 0; e < b * b; ++e) {
            const double f = blocks.f1[static_cast<std::size_t>(e)];
            blocks.transition[e * block_items + i] = f;
            blocks.noise[e * block_items + i] = blocks.q1[static_cast<std::size_t>(e)];
            if (e % b > e / b && f != 0.0) blocks.upper_triangular = false;
        }
        blocks.dt[lane] = now;
    }));
    blocks.common = 0;
    while (call.input_stride == 0 && blocks.common < dt.count &&
           blocks.dt[static_cast<std::size_t>(blocks.common)] == blocks.dt.front())
        ++blocks.common;
}

plr_status FactorFilter::predict_structured(const plr_call& call, const plr_estimator_predict& args) const {
    const std::int64_t size = structure_->block * structure_->block;
    const Scratch scratch(call, 2 * size * block_items);
    Blocks blocks(scratch.data(), size);
    return in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        ask_for_blocks(block, slice(args.dt, first, items), blocks);
        Outcomes outcomes = still_good(block, items);
        structured_(items)({structure_->block, structure_->dimension, static_cast<int>(items), is_root(),
                            blocks.transition, blocks.noise, items_of(args.record, first), items_of(args.out, first),
                            outcomes.data()});
        return settled(block, items, outcomes);
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

plr_status FactorFilter::finish(const plr_call& call, const Step& step, const Image& image, const plr_view& out) const {
    const std::int64_t items = out.count;
    const MotionNoise noise{items_of(as_const(step.noise), 0, step.noise.count == 1),
                            noise_factor_ == nullptr ? MotionNoise::Kind::covariance : MotionNoise::Kind::factor,
                            noise_factor_ == nullptr ? 0 : noise_factor_->columns};
    Outcomes outcomes = still_good(call, items);
    state_kernels_(items).spread({static_cast<int>(n_), static_cast<int>(items), is_root(), image, noise,
                                  items_of(as_const(step.predicted)), items_of(out), outcomes.data()});
    return for_good_items(call, items, [&](std::int64_t i) {
        require(outcomes[static_cast<std::size_t>(i)]);
        std::copy_n(at(step.record, i), motion_record_, at(out, i) + n_ + n_ * n_);
    });
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
    const int n = static_cast<int>(n_);
    const Scratch scratch(call, block_size * linear_doubles());
    return in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_estimator_predict part = part_of(args, first, items);
        double* const memory = scratch.data() + block_size * image_doubles(n, n);
        const plr_view transition = pelorus::view(memory, n_, n_, common ? 1 : items);
        const Step told = step(memory + items * n_ * n_, items, common);
        linearise(block, part, told, transition);
        Outcomes outcomes = still_good(block, items);
        state_kernels_(items).slope({n, n, n, static_cast<int>(items), is_root(), items_of(part.record),
                                     items_of(as_const(transition), 0, common), nullptr, scratch.data(),
                                     outcomes.data()});
        tolerate(settled(block, items, outcomes));
        return finish(block, told, Image{scratch.data(), n, 0, false}, part.out);
    });
}

}  // namespace gaussian
