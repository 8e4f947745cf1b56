/// estimator.kalman: the Kalman filter, extended where the motion or a sensor is not linear. See README.md.
///
/// The record of a track: [mean (n), covariance or its factor (n x n, column-major), the motion's record].
#pragma once

#include "../../common/gaussian/factor_filter.hpp"
#include "kalman_kernels.hpp"

#include <vector>

#include <pelorus/batch_model.hpp>

namespace kalman {

using namespace batches;

using gaussian::SensorInSlot;

class Kalman : public pelorus::Estimator<Kalman>, public gaussian::FactorFilter {
public:
    static void describe(pelorus::Describe<Kalman>& plugin);
    void setup(const pelorus::Setup& setup);

    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status project(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;
    const void* extension(const char* id) const noexcept;

    gaussian::Form form = gaussian::Form::covariance;
    int iterations = 1;

private:
    /// What is known of a sensor once and for all.
    struct Seen {
        lanes::ByItems<MeasurementKernels> kernels;
        lanes::ByItems<gaussian::LookKernels> by_factors;
        int leading;      // the columns of H from there on are zero
        bool in_order;    // it looks at the first Cartesian components, in their order
        bool can_common;  // one H serves all items, unless they have inputs of their own
    };

    /// How a sensor sees a block of records.
    struct Looks {
        plr_view predicted;  // m x 1 x N
        double* jacobian;    // m x n x N, with respect to the state
        bool common;         // one Jacobian for all items
    };

    std::int64_t look_doubles(const SensorInSlot& sensor) const;
    template <class View> View covariance(const View& records) const noexcept { return spread(records); }
    /// As kernels take them. They have all columns, or, where the sensor tells them itself, those that are not zero.
    gaussian::ItemsIn jacobians(std::int32_t sensor, const Looks& looks) const noexcept {
        const auto which = static_cast<std::size_t>(sensor);
        const std::int64_t columns = tells_columns(seen_[which]) ? seen_[which].leading : n_;
        return {looks.jacobian, looks.common ? 0 : sensors_[which].m * columns};
    }
    bool tells_columns(const Seen& seen) const noexcept { return state_is_cartesian_ && seen.in_order; }

    /// A step of a block of records, as the motion tells it.
    struct Steps {
        plr_view predicted;          // n x 1 x N
        plr_view transition, noise;  // n x n, for each item or one for all
        plr_view record;             // the motion's, advanced
    };
    Steps steps(const plr_call& call, const plr_estimator_predict& args, std::int64_t first, std::int64_t items,
                bool common, double* memory) const;
    plr_status predict_by_blocks(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status predict_fully(const plr_call& call, const plr_estimator_predict& args) const;
    Seen see(const SensorInSlot& sensor) const;
    plr_const_view look(const plr_call& call, std::int32_t sensor, const plr_const_view& records, const Looks& out,
                        double* memory) const;
    // With factors of covariances, or with several linearisations.
    /// The look of a sensor at factors, which are kept.
    struct Whitened {
        double* factors;
        gaussian::Image image;
    };
    std::int64_t kept_doubles(const SensorInSlot& sensor) const noexcept;
    Whitened whiten(const plr_call& call, std::int32_t sensor, const plr_const_view& records, const Looks& looks,
                    double* memory) const;
    plr_status project_by_factors(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update_iterated(const plr_call& call, const plr_estimator_update& args) const;
    /// One linearisation of a block of items: what it starts from, what it makes of it, and what it tells.
    struct Linearisation {
        plr_const_view records, noise, innovation;
        plr_view out, log_likelihood, innovation_covariance;
    };
    plr_status learn(const plr_call& call, std::int32_t sensor, const Looks& looks, const Linearisation& step,
                     double* memory) const;
    void innovate_about(const double* record, const double* point, std::int32_t sensor, const double* jacobian,
                        double* innovation) const;

    std::vector<Seen> seen_;  // of the sensors
    lanes::ByItems<BlockKernel> by_blocks_{};
    lanes::ByItems<FullKernel> fully_{};
};

}  // namespace kalman
