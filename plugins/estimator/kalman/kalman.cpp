// What the filter is made from.
#include "kalman.hpp"

#include <algorithm>
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
            "Guidance, Wiley 1968 (the form of the update); T. Kailath, A. H. Sayed, B. Hassibi, Linear Estimation, "
            "Prentice Hall 2000, 12.3 (its array); Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with "
            "Applications to Tracking and Navigation, Wiley 2001, 10.3 (extended); B. M. Bell, F. W. Cathey, The "
            "iterated Kalman filter update as a Gauss-Newton method, IEEE Transactions on Automatic Control 38(2), "
            "294-297, 1993; N. A. Carlson, Fast triangular formulation of the square root filter, AIAA Journal 11(9), "
            "1259-1265, 1973");
    plugin.slot("motion", "motion", 1, 1, "how the state evolves");
    plugin.slot("sensors", "sensor", 1, -1, "what measures it; a scan meets its sensor by name");
    plugin.parameter("form", &Kalman::form)
        .initially("covariance")
        .choices({{"covariance", "records hold covariances; the update is Joseph's"},
                  {"square_root",
                   "records hold factors of covariances, which no rounding makes indefinite; the "
                   "update is an array of rotations"}})
        .doc("what is kept of a track's spread, and computed with");
    plugin.parameter("iterations", &Kalman::iterations)
        .initially("1")
        .min(1)
        .max(20)
        .doc(
            "how often an update linearises the sensor, each time at the newest estimate: Gauss-Newton steps towards "
            "the most probable state; 1: the extended filter");
}

void Kalman::setup(const pelorus::Setup& setup) {
    setup_filter(setup, form, info);
    setup_factors();
    const Kernels &narrow = kernels(lanes::InstructionSet::baseline), &wide = kernels(lanes::best_instruction_set());
    if (structure_ != nullptr)
        by_blocks_ = {narrow.by_blocks(structure_->block, structure_->dimension),
                      wide.by_blocks(structure_->block, structure_->dimension)};
    const int n = static_cast<int>(n_);
    fully_ = {narrow.full(n), wide.full(n)};
    std::int64_t doubles = std::max(n_ + 2 * n_ * n_ + motion_record_, linear_doubles());  // predict
    const std::int64_t copies = iterations > 1 ? record_size_ : 0;
    for (const SensorInSlot& sensor : sensors_) {
        Seen& seen = seen_.emplace_back(see(sensor));
        const int m = static_cast<int>(sensor.m);
        seen.kernels = {narrow.measurement(n, m, seen.leading), wide.measurement(n, m, seen.leading)};
        seen.by_factors =
            gaussian::factor_kernels_by_items([&](const gaussian::FactorKernels& all) { return all.look(n, m); });
        doubles =
            std::max(doubles, copies + kept_doubles(sensor) + 2 * sensor.m + 2 * sensor.m * n_ + look_doubles(sensor));
    }
    info.scratch_bytes = scratch_for(doubles);
}

Kalman::Seen Kalman::see(const SensorInSlot& sensor) const {
    Seen out{{}, {}, static_cast<int>(n_), true, false};
    if (state_is_cartesian_) {
        out.leading = 1 + static_cast<int>(*std::max_element(sensor.index.begin(), sensor.index.end()));
        out.can_common = (sensor.part.info().flags & PLR_SENSOR_LINEAR) != 0;
    }
    for (std::int64_t k = 0; k < sensor.c; ++k)
        out.in_order = out.in_order && sensor.index[static_cast<std::size_t>(k)] == k;
    return out;
}

std::int64_t Kalman::look_doubles(const SensorInSlot& sensor) const {
    const std::int64_t converted = state_is_cartesian_ ? 0 : c_ + c_ * n_;
    return sensor.c + sensor.m * sensor.c + converted;
}

/// Of a look at factors.
std::int64_t Kalman::kept_doubles(const SensorInSlot& sensor) const noexcept {
    return is_root() ? n_ * n_ + gaussian::image_doubles(static_cast<int>(sensor.m), static_cast<int>(n_)) : 0;
}

const void* Kalman::extension(const char* id) const noexcept {
    return std::strcmp(id, PLR_ESTIMATOR_MIX) == 0 ? gaussian::mix_table<Kalman>() : nullptr;
}

}  // namespace kalman

PELORUS_PLUGIN(kalman::Kalman, "estimator.kalman");
