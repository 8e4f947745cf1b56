/// A simulated sensor: the very model that trackers use, turned round.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/caller.hpp>
#include <pelorus/messages.hpp>
#include <pelorus/parts.hpp>
#include <pelorus/sensor.hpp>
#include <pelorus/small_matrix.hpp>

#include "conversion.hpp"
#include "draws.hpp"
#include "sensor_errors.hpp"
#include "sensor_timing.hpp"
#include "sensor_view.hpp"
#include "site.hpp"
#include "target.hpp"

namespace simulation {

class SimulatedSensor {
public:
    static constexpr int max_components = 16;
    static constexpr std::uint64_t stream_radius = 1000;  ///< of points that are uniform in an ellipsoid

    /// `origin`: latitude, longitude (rad) and height (m) of the scene's axes, where they are told.
    SimulatedSensor(const pelorus::SensorPart& part, const SensorValues& values,
                    const std::optional<std::vector<double>>& origin)
        : part_(part),
          values_(values),
          measurement_(*part.info().measurement),
          cartesian_(*part.info().cartesian),
          timing_(values, part.name()),
          view_(values, measurement_, part.name()),
          number_(number_of(part.name())) {
        if (measurement_.size() > max_components)
            throw pelorus::PartError("sensors", "sensor " + name() + " measures " +
                                                    std::to_string(measurement_.size()) + " components, at most " +
                                                    std::to_string(max_components) + " can be simulated");
        const pelorus::Space axes = pelorus::position_space(3);
        for (int axis = 0; axis < axes.size(); ++axis) axis_components_.push_back(cartesian_.index(axes[axis].name));
        if (part_.info().waveform != nullptr) waveform_ = pelorus::Space(*part_.info().waveform);
        if (values_.clutter > 0) check_box();
        if (values_.converted) conversion_.emplace(part);
        if (values_.site) stand(origin);
    }

    std::string name() const { return part_.name(); }
    const SensorTiming& timing() const noexcept { return timing_; }
    const SensorView& view() const noexcept { return view_; }
    void look_at(std::int64_t time) { view_.move(time); }
    /// Tells its model how it really stands and measures.
    void tell_errors(pelorus::Caller& caller) const {
        if (values_.attitude_error) tell_error(caller, part_, "attitude_error", *values_.attitude_error);
        if (values_.bias) tell_error(caller, part_, "bias", *values_.bias);
    }
    /// What a scan tells of: its measurements, or the positions that they are converted to.
    const pelorus::Space& told() const noexcept { return conversion_ ? conversion_->space() : measurement_; }
    /// Throws PartError unless a recording of positions at the simulation's ticks can stand for what it measures.
    void check_recordable() const {
        if (!cartesian_.same(pelorus::position_space(3)))
            throw pelorus::PartError("sensors", "sensor " + name() + " looks at " + cartesian_.text() +
                                                    "; a recording tells positions x, y, z");
        if (values_.period || values_.jitter > 0)
            throw pelorus::PartError("sensors",
                                     "sensor " + name() + " has a period or jitter of its own; a recording has not");
    }
    std::uint64_t scratch_bytes() const noexcept { return part_.info().scratch_bytes; }

    /// Throws PartError unless the target's states have all that the sensor looks at.
    void check(const Target& target) const {
        for (const auto& component : cartesian_.components())
            if (target.space().index(component.name) < 0)
                throw pelorus::PartError("sensors", "sensor " + name() + " looks at " + component.name +
                                                        ", which target " + target.name() +
                                                        " has not: " + target.space().text());
    }

    /// Takes a command; false: it is not for this sensor. Throws DataError where it is one that cannot be obeyed.
    bool take(const plr_quantity& quantity) {
        const std::string address = quantity.address, what = quantity.name;
        if (address != name() && address != "sensors." + name()) return false;
        if (what == "pointing") {
            view_.take(quantity);
            return true;
        }
        if (what != "waveform") return false;
        if (waveform_.size() == 0)
            throw pelorus::DataError("sensor " + name() + " has no waveform that could be commanded");
        const plr_const_view& v = quantity.numbers;
        if (v.rows != waveform_.size() || v.cols != 1)
            throw pelorus::DataError("the waveform of sensor " + name() + " has " + std::to_string(waveform_.size()) +
                                     " parameters (" + waveform_.text() + "), the command has " +
                                     std::to_string(v.rows * v.cols));
        command_ = Command{{}, quantity.valid_from, quantity.valid_to};
        for (std::int64_t r = 0; r < v.rows; ++r) command_->parameters.push_back(v.data[r * v.row_stride]);
        return true;
    }

    /// Whether the scan of this tick never comes.
    bool is_lost(const Draws& draws, std::uint64_t tick, std::int64_t time) const {
        if (timing_.is_out(time)) return true;
        return values_.drop > 0 && draws.uniform(PLR_STREAM_DETECTION, {number_, 0, tick, 0}, 0) < values_.drop;
    }

    /// Measures the objects of a target into the scan; the ids of each object's measurements go to `origins`.
    void measure(pelorus::Caller& caller, const Draws& draws, std::int64_t time, std::uint64_t tick,
                 const Target& target, const std::vector<Object>& objects, std::uint64_t& next_id, bool with_covariance,
                 pelorus::ScanBuilder& scan, std::vector<std::vector<std::uint64_t>*>& origins) const {
        for (std::size_t k = 0; k < objects.size(); ++k) {
            if (objects[k].recorded && objects[k].measured == nullptr) continue;
            const Place place{number_, target.number(), tick, objects[k].index + 1};
            std::vector<std::size_t> numbers;
            const std::vector<double> points = detected_points(draws, place, target, objects[k], numbers);
            add(caller, draws, time, place, points, numbers, objects[k].recorded, next_id, with_covariance, scan,
                origins[k]);
        }
    }

    /// False alarms: a Poisson number of them, uniform in a box of space, each as the sensor would measure a resting point there.
    /// `middle`: of the objects (m); none where there are none, and then nothing is seen about them.
    void add_clutter(pelorus::Caller& caller, const Draws& draws, std::int64_t time, std::uint64_t tick,
                     const std::optional<Middle>& middle, std::uint64_t& next_id, bool with_covariance,
                     pelorus::ScanBuilder& scan) const {
        const bool about_targets = values_.clutter_about == ClutterAbout::targets;
        if (values_.clutter <= 0 || (about_targets && !middle)) return;
        const Middle base = about_targets ? *middle : Middle{};
        const Place count_place{number_, 0, tick, 0}, where{number_, 1, tick, 0};
        std::vector<std::size_t> numbers;
        for (double sum = 0;;) {  // gaps of a Poisson process of rate 1 until its time is over
            sum -= std::log(draws.uniform(PLR_STREAM_CLUTTER, count_place, numbers.size()));
            if (sum > values_.clutter) break;
            numbers.push_back(numbers.size());
        }
        const auto c = static_cast<std::size_t>(cartesian_.size());
        const std::size_t d = values_.clutter_min->size();
        std::vector<double> points(c * numbers.size(), 0.0);
        for (const std::size_t p : numbers)
            for (std::size_t axis = 0; axis < d; ++axis) {
                const double low = (*values_.clutter_min)[axis], high = (*values_.clutter_max)[axis];
                points[p * c + box_components_[axis]] =
                    base[axis] + low + (high - low) * draws.uniform(PLR_STREAM_CLUTTER, where, p * d + axis);
            }
        add(caller, draws, time, {number_, 1, tick, 0}, points, numbers, false, next_id, with_covariance, scan,
            nullptr);
    }

    /// The waveform in force is told with the scan.
    void tell_waveform(std::int64_t time, pelorus::ScanBuilder& scan) const {
        if (waveform_.size() == 0) return;
        std::vector<double> parameters;
        for (const auto& component : waveform_.components()) parameters.push_back(component.prior_mean);
        if (const double* commanded = waveform_at(time)) parameters.assign(commanded, commanded + waveform_.size());
        scan.set_waveform(waveform_, parameters);
    }

    template <class Archive> void state(Archive& archive) {
        archive(command_, view_);
        if constexpr (Archive::reading)
            if (command_ && command_->parameters.size() != static_cast<std::size_t>(waveform_.size()))
                throw pelorus::DataError("the saved waveform of sensor " + name() + " is of another size");
    }

private:
    struct Command {
        std::vector<double> parameters;
        std::int64_t valid_from = 0, valid_to = 0;  // ns
        template <class Archive> void state(Archive& archive) { archive(parameters, valid_from, valid_to); }
    };

    void stand(const std::optional<std::vector<double>>& origin) {
        if (!conversion_ || cartesian_.size() != 3)
            throw pelorus::PartError("sensors",
                                     "sensor " + name() +
                                         " has a site, which is for sensors whose scans tell positions x, y, z "
                                         "(converted: true); others have a position in their models");
        if (!origin)
            throw pelorus::PartError(
                "sensors", "sensor " + name() + " has a site; say by the simulation's `origin` where the scene is");
        for (const double latitude : {values_.site->front(), origin->front()})
            if (!(std::fabs(latitude) <= 2 * std::atan(1.0) * (1 + 1e-15)))
                throw pelorus::PartError("sensors",
                                         "sensor " + name() + ": its site, or the origin, is beyond the poles");
        if (*values_.site != *origin) site_.emplace(*origin, *values_.site);
    }

    void check_box() {
        if (!values_.clutter_min || !values_.clutter_max)
            throw pelorus::PartError("sensors",
                                     "sensor " + name() + " has clutter; say where: clutter_min and clutter_max");
        if (values_.clutter_min->size() != values_.clutter_max->size())
            throw pelorus::PartError("sensors",
                                     "clutter_min and clutter_max of sensor " + name() + " differ in length");
        const pelorus::Space axes = pelorus::position_space(static_cast<int>(values_.clutter_min->size()));
        for (int axis = 0; axis < axes.size(); ++axis) {
            const int component = cartesian_.index(axes[axis].name);
            const auto k = static_cast<std::size_t>(axis);
            if (component < 0)
                throw pelorus::PartError(
                    "sensors", "sensor " + name() + " does not look at " + axes[axis].name + " (clutter_min)");
            if (!((*values_.clutter_min)[k] <= (*values_.clutter_max)[k]))
                throw pelorus::PartError("sensors", "clutter_min of sensor " + name() + " is above clutter_max");
            box_components_.push_back(static_cast<std::size_t>(component));
        }
    }

    const double* waveform_at(std::int64_t time) const noexcept {
        return command_ && time >= command_->valid_from && time <= command_->valid_to ? command_->parameters.data()
                                                                                      : nullptr;
    }

    /// Cartesian components (c each) of the points of an object that are detected; `numbers` says which points they are.
    std::vector<double> detected_points(const Draws& draws, const Place& place, const Target& target,
                                        const Object& object, std::vector<std::size_t>& numbers) const {
        const TargetValues& values = target.values();
        const double probability = values_.detection_probability * values.detection_probability;
        const auto points = static_cast<std::size_t>(std::max<std::int64_t>(values.points_per_scan, 1));
        std::vector<double> out;
        for (std::size_t p = 0; p < points; ++p) {
            if (probability < 1 && draws.uniform(PLR_STREAM_DETECTION, place, p) >= probability) continue;
            numbers.push_back(p);
            const std::size_t base = out.size();
            if (object.recorded) {
                out.insert(out.end(), object.measured, object.measured + cartesian_.size());
                continue;
            }
            for (const auto& component : cartesian_.components())
                out.push_back(object.state[target.space().index(component.name)]);
            if (values.points_per_scan == 0) continue;
            const std::vector<double> offset = point_offset(draws, place, target, object, p);
            for (std::size_t axis = 0; axis < offset.size(); ++axis) {
                const int component = axis_components_[axis];
                if (component >= 0) out[base + static_cast<std::size_t>(component)] += offset[axis];
            }
        }
        return out;
    }

    /// Point p of the extent about its centre: N(0, X), or uniform within the ellipsoid.
    static std::vector<double> point_offset(const Draws& draws, const Place& place, const Target& target,
                                            const Object& object, std::size_t p) {
        const int d = target.axes();
        const auto size = static_cast<std::size_t>(d);
        using Square = pelorus::small::Bounded<3, 3>;
        const Square extent = Eigen::Map<const Eigen::MatrixXd>(object.extent, d, d);
        Square root(d, d);
        if (!pelorus::small::cholesky_semidefinite(extent, root))
            throw pelorus::NumericError("the extent of target " + target.name() + " is not positive semidefinite");
        std::vector<double> unit = draws.normals(PLR_STREAM_EXTENT, place, p * size, size), out(size, 0.0);
        if (target.values().spread == Spread::uniform) {
            double square = 0;
            for (const double x : unit) square += x * x;
            const double radius = std::pow(draws.uniform(stream_radius, place, p), 1.0 / d);
            for (double& x : unit) x *= radius / std::sqrt(square);
        }
        for (int col = 0; col < d; ++col)
            for (int row = col; row < d; ++row)
                out[static_cast<std::size_t>(row)] += root(row, col) * unit[static_cast<std::size_t>(col)];
        return out;
    }

    /// Measures points of one object and appends those in view: noise = chol(R) times unit normals; none where the points are
    /// `measured` already.
    void add(pelorus::Caller& caller, const Draws& draws, std::int64_t time, const Place& place,
             std::vector<double> points, std::vector<std::size_t> numbers, bool measured, std::uint64_t& next_id,
             bool with_covariance, pelorus::ScanBuilder& scan, std::vector<std::uint64_t>* origins) const {
        if (numbers.empty()) return;
        if (site_) site_->to_site(points);
        std::vector<double> exact = measurements(caller, time, points);
        keep_in_view(numbers, points, exact);
        if (numbers.empty()) return;
        std::vector<double> noise = noises(caller, time, points);
        const auto size = static_cast<std::size_t>(measurement_.size());
        for (std::size_t k = 0; k < numbers.size() && !measured; ++k) {
            const std::vector<double> unit = values_.shared_error
                                                 ? draws.normals(PLR_STREAM_NOISE, {number_, 0, place.tick, 0}, 0, size)
                                                 : draws.normals(PLR_STREAM_NOISE, place, numbers[k] * size, size);
            disturb(exact.data() + k * size, noise.data() + k * size * size, unit);
        }
        if (conversion_) conversion_->convert(caller, time, exact, noise, static_cast<std::int64_t>(numbers.size()));
        if (site_) site_->to_scene(exact, noise);
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            if (origins != nullptr) origins->push_back(next_id);
            scan.add(next_id++, exact.data() + k * size, with_covariance ? noise.data() + k * size * size : nullptr);
        }
    }

    /// Of points (c each), without noise: m each.
    std::vector<double> measurements(pelorus::Caller& caller, std::int64_t time,
                                     const std::vector<double>& points) const {
        const std::int64_t m = measurement_.size(), c = cartesian_.size(),
                           n = static_cast<std::int64_t>(points.size()) / c;
        std::vector<double> exact(static_cast<std::size_t>(m * n));
        auto measure = pelorus::arguments<plr_sensor_measure>();
        measure.cartesian = pelorus::const_view(points.data(), c, n, 1);
        measure.out = pelorus::view(exact.data(), m, n, 1);
        caller.require(part_.call(&plr_sensor::measure, caller.begin(time, 1), measure),
                       "sensor " + name() + ", measure");
        return exact;
    }

    /// Covariances of the measurements of points (c each), with the waveform in force: m x m each.
    std::vector<double> noises(pelorus::Caller& caller, std::int64_t time, const std::vector<double>& points) const {
        const std::int64_t m = measurement_.size(), c = cartesian_.size(),
                           n = static_cast<std::int64_t>(points.size()) / c;
        std::vector<double> noise(static_cast<std::size_t>(m * m * n));
        auto spread = pelorus::arguments<plr_sensor_noise>();
        spread.cartesian = pelorus::const_view(points.data(), c, 1, n);
        if (const double* waveform = waveform_at(time))
            spread.waveform = pelorus::common_view(waveform, waveform_.size(), 1, n);
        spread.out = pelorus::view(noise.data(), m, m, n);
        caller.require(part_.call(&plr_sensor::noise, caller.begin(time, n), spread), "sensor " + name() + ", noise");
        return noise;
    }

    void keep_in_view(std::vector<std::size_t>& numbers, std::vector<double>& points,
                      std::vector<double>& exact) const {
        if (!view_.is_limited()) return;
        const auto m = static_cast<std::size_t>(measurement_.size()), c = static_cast<std::size_t>(cartesian_.size());
        std::size_t kept = 0;
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            if (!view_.sees(exact.data() + k * m)) continue;
            numbers[kept] = numbers[k];
            std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(k * c), c,
                        points.begin() + static_cast<std::ptrdiff_t>(kept * c));
            std::copy_n(exact.begin() + static_cast<std::ptrdiff_t>(k * m), m,
                        exact.begin() + static_cast<std::ptrdiff_t>(kept * m));
            ++kept;
        }
        numbers.resize(kept);
        points.resize(kept * c);
        exact.resize(kept * m);
    }

    void disturb(double* value, const double* covariance, const std::vector<double>& unit) const {
        const int m = measurement_.size();
        using Square = pelorus::small::Bounded<max_components, max_components>;
        const Square noise = Eigen::Map<const Eigen::MatrixXd>(covariance, m, m);
        Square root(m, m);
        if (!pelorus::small::cholesky_semidefinite(noise, root))
            throw pelorus::NumericError("the noise of sensor " + name() + " is not positive semidefinite");
        for (int row = 0; row < m; ++row) {
            for (int col = 0; col <= row; ++col) value[row] += root(row, col) * unit[static_cast<std::size_t>(col)];
            if (measurement_[row].angle) value[row] = pelorus::wrap_angle(value[row]);
        }
    }

    pelorus::SensorPart part_;
    SensorValues values_;
    pelorus::Space measurement_, cartesian_, waveform_{std::vector<pelorus::Component>{}};
    std::optional<Conversion> conversion_;
    std::optional<Site> site_;  ///< where it is not the scene's origin
    SensorTiming timing_;
    SensorView view_;
    std::uint64_t number_;
    std::vector<int> axis_components_;  ///< where position.x, y, z stand among what it looks at, or -1
    std::vector<std::size_t> box_components_;
    std::optional<Command> command_;
};

}  // namespace simulation
