/// The estimator and its sensors as this tracker calls them: whole batches, packed arrays.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/caller.hpp>
#include <pelorus/parts.hpp>

namespace point_target {

constexpr int most_measured = 8;  // components of a measurement

/// A sensor of the estimator, and what a single measurement of it tells.
struct SensorModel {
    pelorus::SensorPart part;
    std::string name;
    int m = 0;                    ///< measurement components
    int known = 0;                ///< components that invert answers; 0: it cannot
    std::vector<int> components;  ///< [known] their indices in the estimator's Cartesian space, ascending
    std::vector<int> order;       ///< [known] where invert has them
    std::array<int, 3> axis{};    ///< where invert has position x, y, z, or -1
    int axes = 0;                 ///< how many of these there are
    bool constant_noise = false;
    double gate = 0;  ///< largest squared distance

    bool locates() const noexcept { return axes > 0; }
};

/// Which items of a batch failed in a call.
using Failures = std::vector<char>;

class Models {
public:
    /// Throws PartError where the parts do not suit a tracker of points.
    void setup(const pelorus::Setup& setup, double gate_probability);

    const std::vector<SensorModel>& sensors() const noexcept { return sensors_; }
    /// The sensor of that name (a single unnamed one stands for all). Throws DataError.
    const SensorModel& sensor(const std::string& name) const;
    std::int32_t index(const SensorModel& sensor) const { return static_cast<std::int32_t>(&sensor - sensors_.data()); }
    const pelorus::Space& cartesian() const noexcept { return cartesian_; }
    int axes() const noexcept { return axes_; }
    /// Where the Cartesian space has velocity x, y, z, or -1.
    int velocity(int axis) const { return velocity_[static_cast<std::size_t>(axis)]; }
    std::size_t record_size() const noexcept { return record_size_; }
    std::uint32_t record_version() const noexcept { return estimator_.info().record_version; }
    pelorus::Caller& caller() noexcept { return caller_; }
    /// Whether a track takes measurements that are older than it is.
    bool takes_late() const noexcept { return (estimator_.info().flags & PLR_ESTIMATOR_OUT_OF_SEQUENCE) != 0; }
    /// Whether the estimator draws random numbers.
    bool draws() const noexcept { return draws_; }
    /// How many times past a record tells of, the newest included; 0: the estimator does not smooth.
    std::size_t smoothed_times() const noexcept {
        return smoothing_ == nullptr ? 0 : static_cast<std::size_t>(smoothing_->most);
    }

    /// Time and step of the scan at hand; the step numbers random draws.
    void begin(std::int64_t time, std::uint64_t step) {
        time_ = time;
        step_ = step;
    }

    // Batches of n items. Arrays are packed; r doubles a record, c a Cartesian mean, m a measurement.
    /// Records on by dt (s), in place.
    void predict(std::size_t n, const std::uint64_t* ids, const double* dt, double* records, Failures& failed);
    /// zhat (m) and H P H' (m x m).
    void project(const SensorModel& sensor, std::size_t n, const std::uint64_t* ids, const double* records,
                 double* measurement, double* covariance, Failures& failed);
    void update(const SensorModel& sensor, std::size_t n, const std::uint64_t* ids, const double* measurement,
                const double* noise, double* records, Failures& failed);
    /// Whether the estimator offers `mix`.
    bool can_mix() const noexcept { return mix_ != nullptr; }
    /// One record from weighted hypotheses (their records side by side) about the item `id`; false where it fails for these.
    bool mix(std::uint64_t id, const std::vector<double>& weights, const double* records, double* out);
    /// Cartesian mean (c) and covariance (c x c).
    void summary(std::size_t n, const std::uint64_t* ids, const double* records, double* mean, double* covariance,
                 Failures& failed);
    /// What is known by now of times past: of each record how many times, k ages (s), k Cartesian means (c) and covariances
    /// (c x c), k = smoothed_times().
    void smoothed(std::size_t n, const std::uint64_t* ids, const double* records, double* known, double* age,
                  double* mean, double* covariance, Failures& failed);
    /// New records from `known` Cartesian components.
    void init(const std::vector<int>& known, std::size_t n, const std::uint64_t* ids, const double* mean,
              const double* covariance, double* records, Failures& failed);
    void residual(const SensorModel& sensor, std::size_t n, const double* measurement, const double* reference,
                  double* out, Failures& failed);
    /// What single measurements tell, in the order of invert: mean (known) and covariance (known x known).
    void invert(const SensorModel& sensor, std::size_t n, const double* measurement, const double* noise, double* mean,
                double* covariance, Failures& failed);
    /// The sensor's own noise (m x m) of objects seen at the Cartesian places (as sensor.cartesian has them; nullptr with constant
    /// noise).
    void noise(const SensorModel& sensor, std::size_t n, const double* places, const plr_scan& scan, double* out,
               Failures& failed);

private:
    void add_sensor(const plr_part& part, double gate_probability);
    const plr_call& start(std::size_t n, const std::uint64_t* ids);
    /// Takes over which items failed numerically, and warns of the first. Throws Failure for any other failure.
    void finish(plr_status status, const char* what, std::size_t n, Failures& failed);
    /// For calls of sensors, whose items are no tracks.
    const plr_call& start(std::size_t n) { return start(n, nullptr); }

    pelorus::Caller caller_;
    bool told_failure_ = false;
    pelorus::EstimatorPart estimator_;
    const plr_estimator_smoothed* smoothing_ = nullptr;
    const plr_estimator_mix* mix_ = nullptr;
    std::vector<SensorModel> sensors_;
    pelorus::Space cartesian_;
    int axes_ = 0;
    std::array<int, 3> velocity_{};
    std::size_t record_size_ = 0;
    const plr_random* random_ = nullptr;
    plr_key key_{};
    bool draws_ = false;
    std::vector<plr_key> keys_;
    std::int64_t time_ = 0;
    std::uint64_t step_ = 0;
};

}  // namespace point_target
