/// The measurements of a scan, made ready for association: noise, place, time.
#pragma once

#include "measurement_grid.hpp"
#include "models.hpp"

namespace point_target {

struct Detections {
    const SensorModel* sensor = nullptr;
    std::vector<std::uint64_t> ids;
    std::vector<std::int64_t> times;  ///< ns
    std::vector<double> measurement;  ///< m each
    std::vector<double> noise;        ///< m x m each
    std::vector<double> known;        ///< what each tells by itself, in the order of sensor->components
    std::vector<double> covariance;   ///< of that
    std::vector<Point> places;        ///< position; axes that the sensor does not tell are 0
    std::vector<double> deviations;   ///< of the position, m: the root of its covariance's trace

    std::size_t size() const noexcept { return ids.size(); }
    const double* measurement_of(std::size_t i) const { return measurement.data() + i * m(); }
    const double* noise_of(std::size_t i) const { return noise.data() + i * m() * m(); }
    const double* known_of(std::size_t i) const { return known.data() + i * k(); }
    const double* covariance_of(std::size_t i) const { return covariance.data() + i * k() * k(); }
    std::size_t m() const { return static_cast<std::size_t>(sensor->m); }
    std::size_t k() const { return sensor->components.size(); }
};

/// Reads a scan. Measurements that the models cannot work with are left out; answers how many.
/// The scan's covariances are the noise; without them the sensor's own, at the place where the measurement says that the object is.
std::size_t read_scan(Models& models, const plr_scan& scan, std::int64_t time, Detections& out);

}  // namespace point_target
