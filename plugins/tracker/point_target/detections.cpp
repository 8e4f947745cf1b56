#include "detections.hpp"

#include <cmath>

#include <pelorus/messages.hpp>

namespace point_target {

namespace {

std::size_t count_of(const plr_scan& scan) { return static_cast<std::size_t>(scan.measurements.count); }

/// Packs a batch of matrices.
void pack(const plr_const_view& from, std::vector<double>& to) {
    to.clear();
    for (std::int64_t i = 0; i < from.count; ++i)
        for (std::int64_t c = 0; c < from.cols; ++c)
            for (std::int64_t r = 0; r < from.rows; ++r)
                to.push_back(from.data[i * from.item_stride + c * from.col_stride + r * from.row_stride]);
}

/// The sensor's own noise where it depends on the place: there where the measurement, taken as exact, says that the object is.
void own_noise(Models& models, const SensorModel& sensor, const plr_scan& scan, Detections& out, Failures& failed) {
    const std::size_t n = count_of(scan), m = out.m(), known = static_cast<std::size_t>(sensor.known);
    if (sensor.constant_noise) return models.noise(sensor, n, nullptr, scan, out.noise.data(), failed);
    if (!sensor.locates())
        throw pelorus::DataError("the scan has no covariances, and the noise of sensor " + sensor.name +
                                 " depends on a place that its measurements do not tell");
    const plr_sensor_info& info = sensor.part.info();
    const pelorus::Space inverse(*info.inverse), looked_at(*info.cartesian);
    std::vector<double> exact(n * m * m, 0.0), means(n * known), covariances(n * known * known);
    models.invert(sensor, n, out.measurement.data(), exact.data(), means.data(), covariances.data(), failed);
    const Failures unplaced = failed;
    const auto c = static_cast<std::size_t>(looked_at.size());
    std::vector<double> places(n * c, 0.0);
    for (std::size_t j = 0; j < c; ++j) {
        const int place = inverse.index(looked_at[static_cast<int>(j)].name);
        for (std::size_t i = 0; place >= 0 && i < n; ++i)
            places[i * c + j] = unplaced[i] != 0 ? 0.0 : means[i * known + static_cast<std::size_t>(place)];
    }
    models.noise(sensor, n, places.data(), scan, out.noise.data(), failed);
    for (std::size_t i = 0; i < n; ++i) failed[i] = failed[i] != 0 || unplaced[i] != 0 ? 1 : 0;
}

/// Places of all detections by the sensor's inverse.
void locate(Models& models, const SensorModel& sensor, Detections& out, Failures& failed) {
    const std::size_t n = out.ids.size(), known = static_cast<std::size_t>(sensor.known), k = out.k();
    std::vector<double> means(n * known), covariances(n * known * known);
    models.invert(sensor, n, out.measurement.data(), out.noise.data(), means.data(), covariances.data(), failed);
    out.known.assign(n * k, 0.0);
    out.covariance.assign(n * k * k, 0.0);
    out.places.assign(n, Point{});
    out.deviations.assign(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        const double* mean = means.data() + i * known;
        const double* covariance = covariances.data() + i * known * known;
        for (std::size_t a = 0; a < k; ++a) {
            const auto from = static_cast<std::size_t>(sensor.order[a]);
            out.known[i * k + a] = mean[from];
            for (std::size_t b = 0; b < k; ++b)
                out.covariance[(i * k + b) * k + a] =
                    covariance[static_cast<std::size_t>(sensor.order[b]) * known + from];
        }
        double trace = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            if (sensor.axis[a] < 0) continue;
            const auto from = static_cast<std::size_t>(sensor.axis[a]);
            out.places[i][a] = mean[from];
            trace += covariance[from * known + from];
        }
        out.deviations[i] = std::sqrt(trace);
        if (!std::isfinite(out.places[i][0] + out.places[i][1] + out.places[i][2] + trace)) failed[i] = 1;
    }
}

template <class T> void keep(std::vector<T>& values, std::size_t width, const Failures& failed) {
    if (values.empty()) return;
    std::size_t to = 0;
    for (std::size_t i = 0; i < failed.size(); ++i) {
        if (failed[i] != 0) continue;
        for (std::size_t k = 0; k < width; ++k) values[to * width + k] = values[i * width + k];
        ++to;
    }
    values.resize(to * width);
}

}  // namespace

std::size_t read_scan(Models& models, const plr_scan& scan, std::int64_t time, Detections& out) {
    const SensorModel& sensor = models.sensor(scan.sensor);
    const std::size_t n = count_of(scan);
    out = Detections{};
    out.sensor = &sensor;
    if (n == 0) return 0;
    if (scan.measurements.rows != sensor.m)
        throw pelorus::DataError("a measurement has " + std::to_string(scan.measurements.rows) +
                                 " components, sensor " + sensor.name + " has " + std::to_string(sensor.m));
    out.ids.assign(scan.ids, scan.ids + n);
    if (scan.times != nullptr)
        out.times.assign(scan.times, scan.times + n);
    else
        out.times.assign(n, time);
    pack(scan.measurements, out.measurement);
    Failures bad(n, 0), failed;
    if (scan.covariances.data != nullptr) {
        pack(scan.covariances, out.noise);
    } else {
        out.noise.assign(n * out.m() * out.m(), 0.0);
        own_noise(models, sensor, scan, out, bad);
    }
    if (sensor.locates()) {
        locate(models, sensor, out, failed);
        for (std::size_t i = 0; i < n; ++i) bad[i] = bad[i] != 0 || failed[i] != 0 ? 1 : 0;
    }
    const std::size_t m = out.m(), k = out.k();
    keep(out.ids, 1, bad);
    keep(out.times, 1, bad);
    keep(out.measurement, m, bad);
    keep(out.noise, m * m, bad);
    keep(out.known, k, bad);
    keep(out.covariance, k * k, bad);
    keep(out.places, 1, bad);
    keep(out.deviations, 1, bad);
    return n - out.size();
}

}  // namespace point_target
