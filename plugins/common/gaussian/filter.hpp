/// What every Gaussian filter of one motion shares: its slots, its record, and the calls around its step.
///
/// The record of a track: [mean (n), covariance or its factor (n x n, column-major), the motion's record]. A factor is lower
/// triangular, S with P = S S'. A filter derives from this and from pelorus::Estimator<itself>, calls setup_filter in its
/// setup, and has predict, project and update of its own; init, summary, moments and assign are those here.
#pragma once

#include "../batches/batches.hpp"
#include "items.hpp"

#include <string>
#include <vector>

#include <pelorus/batch_model.hpp>
#include <pelorus/setup.hpp>

namespace gaussian {

using namespace batches;

/// What the record holds beside the mean.
enum class Form { covariance, square_root };

/// A sensor of the slot, and where among the motion's Cartesian components it finds what it looks at.
struct SensorInSlot {
    pelorus::SensorPart part;
    std::int64_t m = 0, c = 0;
    std::vector<std::int64_t> index;  // [c]
};

class Filter {
public:
    plr_status init(const plr_call& call, const plr_estimator_init& args) const;
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const;
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const;
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const;
    plr_status mix(const plr_call& call, const plr_estimator_mix_args& args) const;

protected:
    /// Reads the slots `motion` and `sensors`, refuses what does not fit, and fills `info` but for scratch_bytes.
    void setup_filter(const pelorus::Setup& setup, Form form, plr_estimator_info& info);
    /// Scratch memory for calls that take up to `doubles` doubles a block, and for the parts that they call meanwhile.
    std::uint64_t scratch_for(std::int64_t doubles) const;
    const SensorInSlot& sensor(std::int32_t index) const;

    // Fields of a batch of records.
    template <class View> View mean(const View& records) const noexcept { return field(records, 0, n_, 1); }
    /// The covariance, or its factor.
    template <class View> View spread(const View& records) const noexcept { return field(records, n_, n_, n_); }
    template <class View> View motion_record(const View& records) const noexcept {
        return field(records, n_ + n_ * n_, motion_record_, 1);
    }
    /// The covariances of a block of records: their own field, or worked out from the factors into `memory`,
    /// block_size * n * n.
    plr_const_view covariances(const plr_const_view& records, double* memory) const noexcept;

    /// The motion's noise of a step from `records` to `predicted`, into `out`: n x n, for the first item alone where it is
    /// common to the block.
    void noise(const plr_call& call, const plr_const_view& dt, const plr_const_view& extent,
               const plr_const_view& records, const plr_const_view& covariance, const plr_const_view& predicted,
               const plr_view& out) const;
    plr_motion_noise noise_arguments(const plr_const_view& dt, const plr_const_view& extent,
                                     const plr_const_view& records, const plr_const_view& covariance,
                                     const plr_const_view& predicted, const plr_view& out) const noexcept;
    /// The motion's record after that step, where it has one.
    void advance(const plr_call& call, const plr_const_view& dt, const plr_const_view& records,
                 const plr_const_view& covariance, const plr_view& out) const;
    /// d measurement / d state, m x n, where `by_cartesian` is m x c of the sensor and `cartesian_by_state` c x n of the motion,
    /// or nullptr where the state is Cartesian.
    void derive_by_state(const SensorInSlot& sensor, const double* by_cartesian, const double* cartesian_by_state,
                         double* out) const;
    /// The covariance of Cartesian components and measurement, c x m, from that of the state, n x m. `jacobian` holds
    /// d Cartesian / d state of the items; it is not read where the state is Cartesian.
    void cross_of_cartesian(const plr_const_view& jacobian, std::int64_t i, const double* cross, std::int64_t m,
                            double* out) const;
    /// What dt = 0 does.
    plr_status copy_records(const plr_call& call, const plr_estimator_predict& args) const;
    void check_predict(const plr_estimator_predict& args) const;
    void check_project(const plr_estimator_project& args, std::int64_t m) const;
    void check_update(const plr_estimator_update& args, std::int64_t m) const;
    /// Wraps the angles of a state, or of a difference of states.
    void wrap(double* state) const noexcept;

    pelorus::MotionPart motion_;
    std::vector<SensorInSlot> sensors_;
    pelorus::Space state_, cartesian_;
    std::vector<int> angles_;  // indices of the state's components that are angles
    std::int64_t n_ = 0, c_ = 0, motion_record_ = 0, record_size_ = 0;
    bool state_is_cartesian_ = true;
    Form form_ = Form::covariance;
    const plr_motion_structure* structure_ = nullptr;  // where it says all: constant noise, no record

private:
    void add_sensor(const pelorus::SensorPart& part);
    void start_item(const plr_estimator_init& args, std::int64_t item, double* x, double* p) const;
    void from_cartesian(const plr_call& call, const plr_const_view& means, const plr_const_view& covariances,
                        const plr_view& records, double* jacobian) const;
    void factorise(double* spread) const;
    void covariance_of(const double* spread, double* out) const noexcept;
    void mix_item(const plr_estimator_mix_args& args, std::int64_t item) const;
    void mix_covariances(const double* weights, const double* records, std::int64_t hypotheses, const double* mean,
                         double* out) const;
    void mix_factors(const double* weights, const double* records, std::int64_t hypotheses, const double* mean,
                     double* out) const;
};

/// An extension's table for a filter that derives from Filter.
template <class Derived> const plr_estimator_mix* mix_table() noexcept {
    static constexpr plr_estimator_mix table{sizeof(plr_estimator_mix), 0,
                                             &pelorus::detail::forward<Derived, plr_estimator_mix_args, &Derived::mix>};
    return &table;
}

}  // namespace gaussian
