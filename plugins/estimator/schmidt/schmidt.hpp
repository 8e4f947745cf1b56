/// estimator.schmidt: the consider filter of Schmidt. See README.md.
///
/// The record of a track: [mean (n), covariance (n x n, column-major), the motion's record, X (n x q, column-major)]. X is the
/// cross-covariance of the state's error and the considered parameters, each counted in its deviation: C = X D with
/// B = D D, so that P - X X' is the covariance that would be left if the parameters were known.
#pragma once

#include "../../common/gaussian/factor_filter.hpp"

#include <optional>
#include <string>
#include <vector>

namespace schmidt {

using namespace batches;
using gaussian::SensorInSlot;

constexpr int max_considered = 12;

class Schmidt : public pelorus::Estimator<Schmidt>, public gaussian::FactorFilter {
public:
    static void describe(pelorus::Describe<Schmidt>& plugin);
    void setup(const pelorus::Setup& setup);

    plr_status init(const plr_call& call, const plr_estimator_init& args) const;
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status project(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const;
    plr_status mix(const plr_call& call, const plr_estimator_mix_args& args) const;
    const void* extension(const char* id) const noexcept;

    /// A row of the parameter `consider`.
    struct Row {
        std::string input;
        std::optional<int> element;
        double deviation = 0.0;
    };
    std::vector<Row> consider;

private:
    /// An element of an input that is uncertain.
    struct Considered {
        std::size_t sensor;   // whose measurement it enters
        std::int64_t offset;  // into plr_call.inputs
        double deviation;
    };
    /// How a sensor sees a block of records.
    struct Looks {
        plr_view predicted;      // m x 1 x N
        plr_view by_state;       // m x n x N: H
        plr_view by_considered;  // m x q x N: N D, the change of the measurement for a deviation of each parameter
        plr_const_view cartesian_by_state;  // c x n x N, or data NULL
    };
    /// A copy of the inputs of a call, in which single elements are moved.
    struct MovedInputs {
        plr_call call;
        double* values;
        std::int64_t copies;
    };

    void read_inputs(const plr_config& config);
    void add_considered(const plr_config& config, std::size_t row);
    std::size_t sensor_of(const std::string& input, const std::string& where) const;
    std::int64_t look_doubles(const SensorInSlot& sensor) const noexcept;
    std::int64_t inputs_doubles() const noexcept { return considered_.empty() ? 0 : input_size_; }
    double* cross(double* record) const noexcept { return record + cross_at_; }
    const double* cross(const double* record) const noexcept { return record + cross_at_; }

    void joint_factor(const double* record, double* out) const;
    Looks look(const plr_call& call, std::int32_t sensor, const plr_const_view& records, const plr_view& predicted,
               double* memory) const;
    MovedInputs move_inputs(const plr_call& call, std::int64_t items, double* memory) const noexcept;
    void differentiate(const plr_call& call, std::int32_t sensor, const plr_const_view& cartesian, const plr_view& out,
                       double* memory) const;
    void whiten(const double* joint, const Looks& looks, std::int64_t i, std::int64_t m, double* out) const noexcept;
    void learn(const plr_estimator_update& args, std::int64_t item, const Looks& looks, std::int64_t i,
               const double* innovation) const;

    std::vector<Considered> considered_;
    std::vector<double> defaults_;  // of the inputs of this tree, where they lie in plr_call.inputs
    std::int64_t q_ = 0, cross_at_ = 0, input_size_ = 0;
};

}  // namespace schmidt
