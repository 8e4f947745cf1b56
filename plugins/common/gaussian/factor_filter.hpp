/// A Gaussian filter whose prediction works on factors of covariances, whether its records hold them or not: with S S' = P,
/// the factor of F P F' + Q is the triangle of [F S, G], Q = G G'.
#pragma once

#include "step_kernels.hpp"

namespace gaussian {

class FactorFilter : public Filter {
protected:
    /// A prediction of a block of records, but for its covariance.
    struct Step {
        plr_view predicted;  // n x 1 x N
        plr_view noise;      // n x n or n x g, for each item or one for all
        plr_view record;     // the motion's, advanced
    };

    /// After setup_filter.
    void setup_factors();
    /// Scratch memory of a prediction that calls none of a derived filter's own, in doubles an item.
    std::int64_t linear_doubles() const noexcept { return step_doubles() + n_ * n_; }
    std::int64_t step_doubles() const noexcept;

    /// The factor of a record's covariance: its own, or worked out into `memory`, n x n.
    const double* factor(const double* record, double* memory) const;
    /// The same for a block of records, into `memory`, n x n an item; 0 where there is none, and the item has failed.
    plr_const_view factors(const plr_call& call, const plr_const_view& records, double* memory) const;

    /// Of a motion that offers a structure: F1 and Q1 are asked for once where neighbours share the time step.
    plr_status predict_structured(const plr_call& call, const plr_estimator_predict& args) const;
    /// By F at the mean. F is asked for once, and so is Q, where both are common to a block of items.
    plr_status predict_linearised(const plr_call& call, const plr_estimator_predict& args) const;

    /// Items first .. first + items - 1 of a prediction.
    static plr_estimator_predict part_of(const plr_estimator_predict& args, std::int64_t first,
                                         std::int64_t items) noexcept;
    /// Whether F and Q of a linear motion are common to all items of a call.
    bool is_common(const plr_call& call, const plr_estimator_predict& args) const noexcept;
    /// The predicted mean and F at the mean, for each item of a block or, where `transition` holds one, for all; and what
    /// noise_and_record tells.
    void linearise(const plr_call& call, const plr_estimator_predict& args, const Step& step,
                   const plr_view& transition) const;
    /// `memory` holds step_doubles() an item.
    Step step(double* memory, std::int64_t items, bool common) const;
    /// What the motion tells of a step once its mean is known. The covariances that it may want follow the step in memory.
    void noise_and_record(const plr_call& call, const plr_estimator_predict& args, const Step& step) const;
    /// The record of item i after the step.
    void finish(const Step& step, const Image& image, std::int64_t i, double* out) const;

private:
    MotionNoise noise_of(const Step& step, std::int64_t i) const noexcept;

    PredictSpread predict_ = nullptr;
    const plr_motion_noise_factor* noise_factor_ = nullptr;
};

}  // namespace gaussian
