// What the smoother is made from, and the calls that it hands on to its filter.
#include "fixed_lag_smoother.hpp"

#include <cmath>
#include <cstring>

#include <pelorus/abi/record.h>

namespace fixed_lag_smoother {

using batches::at;
using batches::expect_packed;
using pelorus::PartError;
using pelorus::Scratch;

void FixedLagSmoother::describe(pelorus::Describe<FixedLagSmoother>& plugin) {
    plugin.title("Fixed-lag smoother")
        .purpose(
            "Any filter, which besides its estimate tells those of the last steps, improved by all that has been "
            "measured since. For users who can wait: a track some steps old, with smaller errors.")
        .equation(
            "C_k = P_k F' P_(k+1|k)^-1, x_k|K = x_k + C_k (x_(k+1)|K - x_(k+1|k)), P_k|K = D_k + C_k P_(k+1)|K C_k', "
            "D_k = P_k - C_k P_(k+1|k) C_k'")
        .source(
            "H. E. Rauch, F. Tung, C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, AIAA "
            "Journal 3(8), 1445-1450, 1965 (the step back); B. D. O. Anderson, J. B. Moore, Optimal "
            "Filtering, Prentice-Hall 1979, chapter 7 (fixed lag)");
    plugin.slot("estimator", "estimator", 1, 1, "the filter");
    plugin.slot("motion", "motion", 1, 1, "how neighbouring times are related: the filter's motion");
    plugin.parameter("lag", &FixedLagSmoother::lag_)
        .initially("5")
        .min(1)
        .max(100)
        .doc("how many steps (predictions by dt > 0) it looks back");
}

void FixedLagSmoother::setup(const pelorus::Setup& setup) {
    hold(setup.part<pelorus::EstimatorPart>("estimator"), 1);
    motion_ = setup.part<pelorus::MotionPart>("motion");
    const plr_estimator_info& held = filter().info();
    const pelorus::Space state(*held.state), cartesian(*held.cartesian);
    const pelorus::Space moved(*motion_.info().state), told(*motion_.info().cartesian);
    if (!state.same(moved) || !cartesian.same(told))
        throw PartError("motion", motion_.id() + " moves " + moved.text() + ", the filter's state is " + state.text());
    n_ = state.size();
    c_ = cartesian.size();
    if (n_ > max_state || c_ > max_state)
        throw PartError("estimator", filter().id() + " has " + std::to_string(std::max(n_, c_)) +
                                         " components, at most " + std::to_string(max_state) + " fit this smoother");
    for (int k = 0; k < state.size(); ++k)
        if (state[k].angle) angles_.push_back(k);
    state_is_cartesian_ = motion_.table().to_cartesian == nullptr;
    own_ = held.record_size;
    motion_record_ = motion_.info().record_size;
    step_size_ = 1 + 2 * n_ + 2 * n_ * n_;
    smoothed_ = {sizeof smoothed_, lag_ + 1,
                 &pelorus::detail::forward<FixedLagSmoother, plr_estimator_smoothed_args, &FixedLagSmoother::smoothed>};

    info.record_size = 1 + own_ + motion_record_ + lag_ * step_size_;
    info.record_version = plr_mix_version(plr_mix_version(1, held.record_version), motion_.info().record_version);
    const std::int64_t doubles = std::max(2 * n_ + 3 * n_ * n_, n_ + n_ * n_ + c_ * n_);
    info.scratch_bytes = static_cast<std::uint64_t>(batches::block_size * doubles) * sizeof(double) +
                         std::max(held.scratch_bytes, motion_.info().scratch_bytes) + 2 * 64;
}

const void* FixedLagSmoother::extension(const char* id) const noexcept {
    return std::strcmp(id, PLR_ESTIMATOR_SMOOTHED) == 0 ? &smoothed_ : nullptr;
}

/// A record comes from a file, too.
void FixedLagSmoother::examine(const double* record) const {
    const double steps = record[0];
    if (!(steps >= 0 && steps <= lag_ && steps == std::floor(steps)))
        throw pelorus::NumericError("the record is not one of this estimator");
}

void FixedLagSmoother::ask_moments(const plr_call& call, const plr_const_view& records, const Memory& out) const {
    auto ask = pelorus::arguments<plr_estimator_moments>();
    ask.record = inside(records);
    ask.mean = pelorus::view(out.mean, n_, 1, records.count);
    ask.covariance = pelorus::view(out.covariance, n_, n_, records.count);
    batches::tolerate(filter().call(&plr_estimator::moments, call, ask));
}

plr_status FixedLagSmoother::init(const plr_call& call, const plr_estimator_init& args) const {
    const std::int64_t count = args.record.count;
    expect_record(args.record, count, "record");
    plr_estimator_init start = args;
    start.record = inside(args.record);
    const plr_status status = filter().call(&plr_estimator::init, call, start);
    if (status < 0) return status;
    for (std::int64_t i = 0; i < count; ++i) {
        double* const record = at(args.record, i);
        record[0] = 0;
        std::fill(record + 1 + own_, record + info.record_size, 0.0);
    }
    if (motion_record_ > 0) {
        const Scratch scratch(call, batches::block_size * (n_ + n_ * n_));
        const plr_status started =
            batches::in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
                start_motion(block, pelorus::slice(args.record, first, items), scratch.data());
                return static_cast<plr_status>(PLR_OK);
            });
        if (started < 0) return started;
    }
    return batches::for_good_items(call, count, [](std::int64_t) {});
}

void FixedLagSmoother::start_motion(const plr_call& call, const plr_view& records, double* memory) const {
    const Memory state = moments_in(memory);
    ask_moments(call, pelorus::as_const(records), state);
    auto start = pelorus::arguments<plr_motion_record>();
    start.state = pelorus::const_view(state.mean, n_, 1, records.count);
    start.covariance = pelorus::const_view(state.covariance, n_, n_, records.count);
    start.out = motion_record(records);
    batches::tolerate(motion_.call(&plr_motion::init_record, call, start));
}

}  // namespace fixed_lag_smoother
