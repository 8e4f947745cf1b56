/// A scan as Cartesian points with covariances, whatever the sensor measures.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <pelorus/caller.hpp>
#include <pelorus/parts.hpp>

namespace extended {

/// The points of one object in one scan.
struct Points {
    std::int64_t time = 0;     ///< ns
    std::uint64_t sensor = 0;  ///< index in the estimator's (or joint extent's) list
    int dimension = 0;
    std::vector<double> positions;  ///< d x n, m
    std::vector<double> noise;      ///< d x d x n, m^2: of each point by itself
    std::vector<std::uint64_t> ids;
    std::vector<double> weights;  ///< of each point, sum 1; empty: 1/n each. Never saved
    Eigen::MatrixXd common;  ///< d x d, m^2: of an error that all have in common; empty: there is none. Never saved

    std::int64_t count() const noexcept { return static_cast<std::int64_t>(ids.size()); }
    /// How many points the centroid is worth: n, or 1 / sum w^2 where they are weighted.
    double number() const noexcept {
        if (weights.empty()) return static_cast<double>(ids.size());
        double squares = 0;
        for (const double weight : weights) squares += weight * weight;
        return 1 / squares;
    }
    /// Weighted mean of the points, d.
    Eigen::VectorXd centroid() const {
        return mean_of(Eigen::Map<const Eigen::MatrixXd>(positions.data(), dimension, count()));
    }
    /// Weighted mean covariance of the points, d x d.
    Eigen::MatrixXd mean_noise() const {
        const Eigen::VectorXd mean =
            mean_of(Eigen::Map<const Eigen::MatrixXd>(noise.data(), dimension * dimension, count()));
        return Eigen::Map<const Eigen::MatrixXd>(mean.data(), dimension, dimension);
    }
    /// The same points, whose noise is taken to be, by that share, one error of all of them.
    Points with_common(double share) const {
        Points out = *this;
        if (share > 0 && count() > 0) out.common = share * mean_noise();
        for (double& element : out.noise) element *= 1 - share;
        return out;
    }
    /// Keeps the points whose mark is set; not for weighted points.
    void keep(const std::vector<bool>& marks) {
        std::vector<std::size_t> kept;
        for (std::size_t k = 0; k < marks.size(); ++k)
            if (marks[k]) kept.push_back(k);
        *this = some(kept);
    }
    Eigen::VectorXd position(std::size_t k) const {
        return Eigen::Map<const Eigen::VectorXd>(positions.data() + k * static_cast<std::size_t>(dimension), dimension);
    }
    /// R of one point, d x d.
    Eigen::MatrixXd noise_of(std::size_t k) const {
        const auto d = static_cast<std::size_t>(dimension);
        return Eigen::Map<const Eigen::MatrixXd>(noise.data() + k * d * d, dimension, dimension);
    }
    /// Those of the points with these indices, of the given weights (none: 1/n each).
    Points some(const std::vector<std::size_t>& which, std::vector<double> of_weights = {}) const {
        Points out;
        out.time = time;
        out.sensor = sensor;
        out.dimension = dimension;
        out.weights = std::move(of_weights);
        const auto d = static_cast<std::ptrdiff_t>(dimension);
        for (const std::size_t k : which) {
            const auto at = static_cast<std::ptrdiff_t>(k);
            out.positions.insert(out.positions.end(), positions.begin() + at * d, positions.begin() + (at + 1) * d);
            out.noise.insert(out.noise.end(), noise.begin() + at * d * d, noise.begin() + (at + 1) * d * d);
            out.ids.push_back(ids[k]);
        }
        return out;
    }
    /// Whether these can be points of one of so many sensors: what a saved state must keep to.
    bool is_of(int axes, std::size_t sensors) const {
        const auto d = static_cast<std::size_t>(axes);
        return dimension == axes && sensor < sensors && positions.size() == ids.size() * d &&
               noise.size() == positions.size() * d;
    }
    template <class Archive> void state(Archive& archive) { archive(time, sensor, dimension, positions, noise, ids); }

private:
    Eigen::VectorXd mean_of(const Eigen::Map<const Eigen::MatrixXd>& columns) const {
        if (weights.empty()) return columns.rowwise().mean();
        return columns.lazyProduct(Eigen::Map<const Eigen::VectorXd>(weights.data(), count()));
    }
};

/// Points as the ABI wants them: one object. Valid as long as the points.
class PointsView {
public:
    explicit PointsView(const Points& points) : offsets_{0, points.count()} {
        const std::int64_t d = points.dimension, n = points.count();
        raw_ = {offsets_, pelorus::const_view(points.positions.data(), d, 1, n),
                pelorus::const_view(points.noise.data(), d, d, n),
                points.weights.empty() ? pelorus::absent_view() : pelorus::const_view(points.weights.data(), 1, 1, n)};
    }
    PointsView(const PointsView&) = delete;
    PointsView& operator=(const PointsView&) = delete;
    const plr_extent_points& c() const noexcept { return raw_; }

private:
    std::int64_t offsets_[2];
    plr_extent_points raw_{};
};

/// One sensor of the tracker: turns its scans into points.
class SensorOfPoints {
public:
    /// Throws PartError (slot `slot`) where a measurement of the sensor is no position in `dimension` axes.
    SensorOfPoints(const plr_part& part, int dimension, const std::string& slot) : part_(part), dimension_(dimension) {
        const plr_sensor_info& info = part_.info();
        measurement_ = pelorus::Space(*info.measurement);
        cartesian_ = pelorus::Space(*info.cartesian);
        if ((info.flags & PLR_SENSOR_CAN_INVERT) == 0 || info.inverse == nullptr)
            throw pelorus::PartError(slot, "sensor " + part_.name() + " (" + part_.id() +
                                               ") cannot turn a measurement into a position; this tracker needs that");
        inverse_ = pelorus::Space(*info.inverse);
        const pelorus::Space wanted = pelorus::position_space(dimension);
        for (int axis = 0; axis < dimension; ++axis) {
            const int from = inverse_.index(wanted[axis].name), to = cartesian_.index(wanted[axis].name);
            if (from < 0 || to < 0)
                throw pelorus::PartError(
                    slot, "sensor " + part_.name() + " (" + part_.id() + ") tells no " + wanted[axis].name);
            from_inverse_.push_back(from);
            in_cartesian_.push_back(to);
        }
    }

    const pelorus::SensorPart& part() const noexcept { return part_; }
    const pelorus::Space& measurement() const noexcept { return measurement_; }
    const pelorus::Space& cartesian() const noexcept { return cartesian_; }
    /// Where the axes of the position stand among the Cartesian components.
    const std::vector<int>& position() const noexcept { return in_cartesian_; }

    /// The points of a scan. A measurement that cannot be converted, or whose noise the sensor cannot tell, is left out; `refused`
    /// counts those.
    Points convert(pelorus::Caller& caller, std::int64_t time, const plr_scan& scan, std::int64_t& refused) const {
        Points points;
        points.time = time;
        points.dimension = dimension_;
        const std::int64_t n = scan.measurements.count;
        if (n == 0) return points;
        const std::int64_t i = inverse_.size();
        ModelNoise own;  // where the scan has none
        plr_const_view noise = scan.covariances;
        if (noise.data == nullptr) {
            own = model_noise(caller, time, scan);
            noise = pelorus::const_view(own.numbers.data(), measurement_.size(), measurement_.size(), n);
        }
        std::vector<double> mean(static_cast<std::size_t>(i * n)), covariance(static_cast<std::size_t>(i * i * n));
        auto args = pelorus::arguments<plr_sensor_invert>();
        args.measurement = scan.measurements;
        args.noise = noise;
        args.mean = pelorus::view(mean.data(), i, 1, n);
        args.covariance = pelorus::view(covariance.data(), i, i, n);
        const plr_call& call = caller.begin(time, n, scan.ids);
        caller.tolerate(part_.call(&plr_sensor::invert, call, args), "sensor " + part_.name() + ", invert");
        for (std::int64_t k = 0; k < n; ++k) {
            const auto item = static_cast<std::size_t>(k);
            if (caller.item_failed(item) || (!own.failed.empty() && own.failed[item])) {
                ++refused;
                continue;
            }
            points.ids.push_back(scan.ids[k]);
            for (const int axis : from_inverse_)
                points.positions.push_back(mean[static_cast<std::size_t>(k * i + axis)]);
            for (const int col : from_inverse_)
                for (const int row : from_inverse_)
                    points.noise.push_back(covariance[static_cast<std::size_t>((k * i + col) * i + row)]);
        }
        return points;
    }

private:
    struct ModelNoise {
        std::vector<double> numbers;  // m x m x n
        std::vector<bool> failed;     // of each measurement
    };
    /// R of each measurement by the sensor model, at the place that the measurement itself tells.
    ModelNoise model_noise(pelorus::Caller& caller, std::int64_t time, const plr_scan& scan) const {
        const std::int64_t n = scan.measurements.count, m = measurement_.size(), c = cartesian_.size(),
                           i = inverse_.size();
        const std::vector<double> none(static_cast<std::size_t>(m * m), 0.0);
        std::vector<double> mean(static_cast<std::size_t>(i * n), 0.0), place(static_cast<std::size_t>(c * n), 0.0);
        auto invert = pelorus::arguments<plr_sensor_invert>();
        invert.measurement = scan.measurements;
        invert.noise = pelorus::common_view(none.data(), m, m, n);
        invert.mean = pelorus::view(mean.data(), i, 1, n);
        const plr_call& first = caller.begin(time, n, scan.ids);
        caller.tolerate(part_.call(&plr_sensor::invert, first, invert), "sensor " + part_.name() + ", invert");
        for (std::int64_t k = 0; k < n; ++k)
            for (std::size_t axis = 0; axis < from_inverse_.size(); ++axis)
                place[static_cast<std::size_t>(k * c + in_cartesian_[axis])] =
                    mean[static_cast<std::size_t>(k * i + from_inverse_[axis])];
        ModelNoise noise;
        noise.numbers.assign(static_cast<std::size_t>(m * m * n), 0.0);
        auto args = pelorus::arguments<plr_sensor_noise>();
        args.cartesian = pelorus::const_view(place.data(), c, 1, n);
        args.snr = scan.snr;
        args.waveform = scan.waveform;
        if (args.waveform.data != nullptr) {  // one for the whole scan
            args.waveform.count = n;
            args.waveform.item_stride = 0;
        }
        args.out = pelorus::view(noise.numbers.data(), m, m, n);
        const plr_call& second = caller.begin(time, n, scan.ids);
        caller.tolerate(part_.call(&plr_sensor::noise, second, args), "sensor " + part_.name() + ", noise");
        for (std::int64_t k = 0; k < n; ++k) noise.failed.push_back(caller.item_failed(static_cast<std::size_t>(k)));
        return noise;
    }

    pelorus::SensorPart part_;
    int dimension_;
    pelorus::Space measurement_, cartesian_, inverse_;
    std::vector<int> from_inverse_, in_cartesian_;
};

}  // namespace extended
