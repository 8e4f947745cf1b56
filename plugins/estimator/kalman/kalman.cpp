// What the filter is made from.
#include "kalman.hpp"

#include <cstring>

namespace kalman {

void Kalman::describe(pelorus::Describe<Kalman>& plugin) {
    plugin.title("Kalman filter, linear and extended")
        .purpose(
            "Mean and covariance of a track, predicted by one motion and updated by any number of sensors. Where the "
            "motion or a sensor is not linear, it is linearised at the newest estimate.")
        .equation(
            "predict: x = f(x), P = F P F' + Q. update: S = H P H' + R, K = P H' S^-1, x = x + K (z - h(x)), P = (I - "
            "K H) P (I - K H)' + K R K'")
        .source(
            "R. E. Kalman, A new approach to linear filtering and prediction problems, Journal of Basic Engineering "
            "82, 35-45, 1960; R. S. Bucy, P. D. Joseph, Filtering for Stochastic Processes with Applications to "
            "Guidance, Wiley 1968 (the form of the update); Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with "
            "Applications to Tracking and Navigation, Wiley 2001, 10.3 (extended)");
    plugin.slot("motion", "motion", 1, 1, "how the state evolves");
    plugin.slot("sensors", "sensor", 1, -1, "what measures it; a scan meets its sensor by name");
}

void Kalman::setup(const pelorus::Setup& setup) {
    setup_filter(setup, gaussian::Form::covariance, info);
    if (structure_ != nullptr) by_blocks_ = blocks_kernel(structure_->block, structure_->dimension);
    fully_ = full_kernel(static_cast<int>(n_));
    std::int64_t doubles = n_ + 2 * n_ * n_ + motion_record_;  // predict
    for (const SensorInSlot& sensor : sensors_) {
        kernels_.push_back(measurement_kernels(static_cast<int>(n_), static_cast<int>(sensor.m)));
        doubles = std::max(doubles, 2 * sensor.m + sensor.m * n_ + look_doubles(sensor));
    }
    info.scratch_bytes = scratch_for(doubles);
}

std::int64_t Kalman::look_doubles(const SensorInSlot& sensor) const {
    const std::int64_t converted = state_is_cartesian_ ? 0 : c_ + c_ * n_;
    return sensor.c + sensor.m * sensor.c + converted;
}

const void* Kalman::extension(const char* id) const noexcept {
    return std::strcmp(id, PLR_ESTIMATOR_MIX) == 0 ? gaussian::mix_table<Kalman>() : nullptr;
}

}  // namespace kalman

PELORUS_PLUGIN(kalman::Kalman, "estimator.kalman");
