/// A Gaussian filter whose prediction works on factors of covariances, whether its records hold them or not: with S S' = P,
/// the factor of F P F' + Q is the triangle of [F S, G], Q = G G'.
#pragma once

#include "factor_kernels.hpp"
#include "filter.hpp"

#include <array>
#include <limits>

namespace gaussian {

class FactorFilter : public Filter {
protected:
    /// A prediction of a block of records, but for its covariance.
    struct Step {
        plr_view predicted;  // n x 1 x N
        plr_view noise;      // n x n or n x g, for each item or one for all
        plr_view record;     // the motion's, advanced
    };
    /// F1 and Q1 of the items of a block.
    struct Blocks {
        explicit Blocks(double* memory, std::int64_t size) noexcept;
        std::array<double, max_state * max_state> f1, q1;  // of last_dt
        double last_dt = std::numeric_limits<double>::quiet_NaN();
        std::array<double, block_items> dt;  // for which each item's are there
        bool upper_triangular = true;        // all F1 so far
        std::int64_t common = 0;             // so many items, from the first on, have the same F1 and Q1
        double *transition, *noise;          // element e of item i at e * block_items + i
    };

    /// After setup_filter.
    void setup_factors();
    /// Scratch memory of a prediction that calls none of a derived filter's own, in doubles an item.
    std::int64_t linear_doubles() const noexcept;
    std::int64_t step_doubles() const noexcept;

    /// Of a motion that offers a structure: F1 and Q1 are asked for once where neighbours share the time step. They are laid out
    /// for kernels; where records hold factors, Q1 is replaced by its own.
    void ask_for_blocks(const plr_call& call, const plr_const_view& dt, Blocks& blocks) const;
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
    /// The records of a block after the step.
    plr_status finish(const plr_call& call, const Step& step, const Image& image, const plr_view& out) const;
    bool is_root() const noexcept { return form_ == Form::square_root; }

    lanes::ByItems<StateKernels> state_kernels_{};

private:
    lanes::ByItems<FactorBlockKernel> structured_{};
    const plr_motion_noise_factor* noise_factor_ = nullptr;
};

}  // namespace gaussian
