/// estimator.fixed_lag_smoother: a filter that also tells how it was, a fixed number of steps ago. See README.md.
///
/// The record of a track: [steps remembered k, the filter's record, the motion's record, step, step, ..], the newest step first.
/// A step leads from one time to the next: [dt (s), filtered mean before it (n), predicted mean after it (n), gain C (n x n),
/// covariance of the state before it, given the one after it, D (n x n)].
#pragma once

#include <vector>

#include <pelorus/small_matrix.hpp>

#include "../../common/filter_inside/filter_inside.hpp"

namespace fixed_lag_smoother {

constexpr int max_state = 12;
using Square = pelorus::small::Bounded<max_state, max_state>;
using Column = pelorus::small::Bounded<max_state, 1>;

class FixedLagSmoother : public filter_inside::FilterInside<FixedLagSmoother> {
public:
    static void describe(pelorus::Describe<FixedLagSmoother>& plugin);
    void setup(const pelorus::Setup& setup);

    plr_status init(const plr_call& call, const plr_estimator_init& args) const;
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        return update_inside(call, args);
    }
    plr_status smoothed(const plr_call& call, const plr_estimator_smoothed_args& args) const;
    const void* extension(const char* id) const noexcept;
    void examine(const double* record) const;

private:
    /// Where the numbers of a step are.
    template <class Double> struct Step { Double *dt, *filtered, *predicted, *gain, *given_next; };
    template <class Double> Step<Double> step(Double* record, std::int64_t index) const noexcept {
        Double* const first = record + 1 + own_ + motion_record_ + index * step_size_;
        return {first, first + 1, first + 1 + n_, first + 1 + 2 * n_, first + 1 + 2 * n_ + n_ * n_};
    }
    template <class View> View motion_record(const View& records) const noexcept {
        return batches::field(records, 1 + own_, motion_record_, 1);
    }
    /// Room for a block's moments.
    struct Memory {
        double *mean, *covariance;
    };
    Memory moments_in(double* memory) const noexcept { return {memory, memory + batches::block_size * n_}; }

    plr_status move(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status move_block(const plr_call& call, const plr_estimator_predict& args, double* memory) const;
    void remember(double* record, double dt, const Square& before, const double* mean, const Square& transition,
                  const double* predicted, const Square& after) const;
    void start_motion(const plr_call& call, const plr_view& records, double* memory) const;
    void ask_moments(const plr_call& call, const plr_const_view& records, const Memory& out) const;
    void step_back(const double* record, std::int64_t index, double* mean, double* covariance) const;
    void tell(const plr_call& call, const plr_estimator_smoothed_args& args, std::int64_t index, const Memory& state,
              double* jacobian) const;
    plr_status smooth_block(const plr_call& call, const plr_estimator_smoothed_args& args, double* memory) const;

    int lag_ = 5;
    pelorus::MotionPart motion_;
    std::vector<int> angles_;  // of the state
    std::int64_t n_ = 0, c_ = 0, own_ = 0, motion_record_ = 0, step_size_ = 0;
    bool state_is_cartesian_ = true;
    plr_estimator_smoothed smoothed_{};
};

}  // namespace fixed_lag_smoother
