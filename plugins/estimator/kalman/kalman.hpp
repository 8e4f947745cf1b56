/// estimator.kalman: the Kalman filter, extended where the motion or a sensor is not linear. See README.md.
///
/// The record of a track: [mean (n), covariance (n x n, column-major), the motion's record].
#pragma once

#include "../../common/batches/batches.hpp"
#include "kalman_kernels.hpp"

#include <vector>

#include <pelorus/batch_model.hpp>

namespace kalman {

using namespace batches;

/// A sensor of the slot, and where among the motion's Cartesian components it finds what it looks at.
struct SensorInSlot {
    pelorus::SensorPart part;
    std::int64_t m = 0, c = 0;
    std::vector<std::int64_t> index;  // [c]
    Kernels kernels{};
};

class Kalman : public pelorus::Estimator<Kalman> {
public:
    static void describe(pelorus::Describe<Kalman>& plugin);
    void setup(const pelorus::Setup& setup);

    plr_status init(const plr_call& call, const plr_estimator_init& args) const;
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status project(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const;
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const;
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const;
    plr_status mix(const plr_call& call, const plr_estimator_mix_args& args) const;
    const void* extension(const char* id) const noexcept;

private:
    /// How a sensor sees a block of records.
    struct Looks {
        plr_view predicted;  // m x 1 x N
        double* jacobian;    // m x n x N, with respect to the state
    };

    void add_sensor(const pelorus::SensorPart& part);
    std::uint64_t scratch_needed() const;
    std::int64_t look_doubles(const SensorInSlot& sensor) const;
    const SensorInSlot& sensor(std::int32_t index) const;

    // The fields of a batch of records.
    template <class View> View mean(const View& records) const noexcept { return field(records, 0, n_, 1); }
    template <class View> View covariance(const View& records) const noexcept { return field(records, n_, n_, n_); }
    template <class View> View motion_record(const View& records) const noexcept {
        return field(records, n_ + n_ * n_, motion_record_, 1);
    }
    Moments moments_of(const double* record) const noexcept { return {record, record + n_}; }
    MomentsOut moments_of(double* record) const noexcept { return {record, record + n_}; }

    void start_item(const plr_estimator_init& args, std::int64_t item, double* x, double* p) const;
    void from_cartesian(const plr_call& call, const plr_const_view& means, const plr_const_view& covariances,
                        const plr_view& records, double* jacobian) const;
    /// A step of a block of records, as the motion tells it.
    struct Steps {
        plr_view predicted;          // n x 1 x N
        plr_view transition, noise;  // n x n, for each item or one for all
        plr_view record;             // the motion's, advanced
    };
    Steps steps(const plr_call& call, const plr_estimator_predict& args, std::int64_t first, std::int64_t items,
                bool common, double* memory) const;
    plr_status copy_records(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status predict_by_blocks(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status predict_fully(const plr_call& call, const plr_estimator_predict& args) const;
    plr_const_view look(const plr_call& call, const SensorInSlot& sensor, const plr_const_view& records,
                        const Looks& out, double* memory) const;
    void cross_of_cartesian(const plr_const_view& jacobian, std::int64_t i, const double* cross, std::int64_t m,
                            double* out) const;
    void wrap(double* mean) const noexcept;
    void mix_item(const plr_estimator_mix_args& args, std::int64_t item) const;

    pelorus::MotionPart motion_;
    std::vector<SensorInSlot> sensors_;
    pelorus::Space state_, cartesian_;
    std::vector<int> angles_;  // indices of the state's components that are angles
    std::int64_t n_ = 0, c_ = 0, motion_record_ = 0;
    bool state_is_cartesian_ = true;
    const plr_motion_structure* structure_ = nullptr;  // where it says all: constant noise, no record
    PredictBlocks by_blocks_ = nullptr;
    PredictFull fully_ = nullptr;
};

}  // namespace kalman
