/// estimator.kalman: the Kalman filter, extended where the motion or a sensor is not linear. See README.md.
///
/// The record of a track: [mean (n), covariance (n x n, column-major), the motion's record].
#pragma once

#include "../../common/gaussian/filter.hpp"
#include "kalman_kernels.hpp"

#include <vector>

#include <pelorus/batch_model.hpp>

namespace kalman {

using namespace batches;

using gaussian::SensorInSlot;

static_assert(max_state == gaussian::max_state && max_measurement == gaussian::max_measurement);

class Kalman : public pelorus::Estimator<Kalman>, public gaussian::Filter {
public:
    static void describe(pelorus::Describe<Kalman>& plugin);
    void setup(const pelorus::Setup& setup);

    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status project(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;
    const void* extension(const char* id) const noexcept;

private:
    /// How a sensor sees a block of records.
    struct Looks {
        plr_view predicted;  // m x 1 x N
        double* jacobian;    // m x n x N, with respect to the state
    };

    std::int64_t look_doubles(const SensorInSlot& sensor) const;
    template <class View> View covariance(const View& records) const noexcept { return spread(records); }
    Moments moments_of(const double* record) const noexcept { return {record, record + n_}; }
    MomentsOut moments_of(double* record) const noexcept { return {record, record + n_}; }

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
    plr_const_view look(const plr_call& call, const SensorInSlot& sensor, const plr_const_view& records,
                        const Looks& out, double* memory) const;
    void cross_of_cartesian(const plr_const_view& jacobian, std::int64_t i, const double* cross, std::int64_t m,
                            double* out) const;

    std::vector<Kernels> kernels_;  // of the sensors
    PredictBlocks by_blocks_ = nullptr;
    PredictFull fully_ = nullptr;
};

}  // namespace kalman
