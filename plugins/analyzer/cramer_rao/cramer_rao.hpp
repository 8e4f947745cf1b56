/// analyzer.cramer_rao: how well position and velocity can be known at best, along a trajectory. See README.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pelorus/truth_pairs.hpp>

#include "bound.hpp"

namespace cramer_rao {

class CramerRao : public pelorus::Stage<CramerRao> {
public:
    static constexpr const char* kind = "analyzer";

    static void describe(pelorus::Describe<CramerRao>& plugin) {
        plugin.title("Posterior Cramer-Rao bound")
            .purpose(
                "How well objects can be tracked at best that move as the motion says and are measured as the scans "
                "were: no unbiased estimator has smaller errors. Motion and sensors are linearised where the objects "
                "really were, measurements are known to be theirs, and those that are missing are missing here, too.")
            .equation(
                "J' = (Q + F J^-1 F')^-1 + sum of H' (R + lambda H_p X H_p')^-1 H over the measurements; told are "
                "sqrt(trace) of the blocks of J^-1 for position, velocity and acceleration")
            .source(
                "P. Tichavsky, C. H. Muravchik, A. Nehorai, Posterior Cramer-Rao Bounds for Discrete-Time Nonlinear "
                "Filtering, IEEE Transactions on Signal Processing 46(5), 1998");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "measurements of the sensors in the slot", PLR_PORT_MANY);
        plugin.in_port("truth", PLR_MESSAGE_TRUTH, "what really is, and which measurements came from it");
        plugin.out_port("results", PLR_MESSAGE_TABLE, "the table by_time and its scalars, at the end");
        plugin.slot("motion", "motion", 1, 1, "how the objects are taken to move");
        plugin.slot("sensors", "sensor", 1, -1, "the sensors of the scans, matched by name");
        plugin.parameter("start_deviations", &CramerRao::start_deviations_)
            .unit("m, m/s, m/s2, m/s3")
            .above(0)
            .rows(1, 4)
            .doc(
                "deviation of each axis' position, velocity, ... that is known before an object's first instant; what "
                "is not given is as the motion's priors say");
        plugin.parameter("extent_factor", &CramerRao::extent_factor_)
            .initially("1")
            .min(0)
            .doc(
                "lambda: share of an object's extent that its measurements scatter by; 1 for Gaussian points, 1/5 for "
                "a uniform ellipsoid, 1/4 for a uniform ellipse, 0 where they are of its centre");
        plugin.parameter("from_scan", &CramerRao::from_scan_)
            .initially("0")
            .min(0)
            .doc("first instant of truth (they count from 0) that is told and enters the scalars");
    }

    void setup(const pelorus::Setup& setup) {
        models_.setup(setup);
        frame_ = setup.frame();
    }
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const {
        if (port != 0) {
            // What else the motion has is at its prior mean where the truth does not tell it.
            std::vector<pelorus::Stream> truth = pelorus::TruthPairs::streams(frame_);
            truth.front().space = pelorus::position_space(models_.axes());
            return truth;
        }
        std::vector<pelorus::Stream> streams;
        for (const Models::SensorModel& sensor : models_.sensors()) {
            const std::string name = sensor.part.name();
            streams.push_back(
                {name, name.empty() && models_.sensors().size() == 1, sensor.measurement, false, frame_, false, false});
        }
        return streams;
    }

    void on_scan(const pelorus::Event&, const plr_scan& scan) {
        const std::uint64_t sensor = models_.sensor_index(scan.sensor);
        const plr_const_view& r = scan.covariances;
        for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
            std::vector<double> noise;
            for (std::int64_t k = 0; r.data != nullptr && k < r.rows * r.cols; ++k)
                noise.push_back(r.data[i * r.item_stride + k / r.rows * r.col_stride + k % r.rows * r.row_stride]);
            // Mostly they are all the same.
            if (noises_.empty() || noises_.back() != noise) noises_.push_back(std::move(noise));
            measurements_[scan.ids[i]] = {sensor, noises_.size() - 1};
        }
    }

    void on_truth(const pelorus::Event&, const plr_truth& truth) {
        const pelorus::Space told(*truth.space);
        for (std::int64_t i = 0; i < truth.count; ++i) {
            Instant instant;
            instant.place.time = truth.times[i];
            instant.place.cartesian = cartesian_of(told, pelorus::item(truth.state, i));
            if (truth.extent.data != nullptr) instant.place.extent = pelorus::item(truth.extent, i);
            if (truth.measurement_offsets != nullptr)
                instant.measurements.assign(truth.measurements + truth.measurement_offsets[i],
                                            truth.measurements + truth.measurement_offsets[i + 1]);
            objects_[truth.ids[i]][truth.times[i]] = std::move(instant);
        }
    }

    void finish(const pelorus::Event& event) {
        std::map<std::int64_t, Sums> sums;
        for (const auto& [id, instants] : objects_) add_object(instants, sums);
        const std::vector<Told> told = columns();
        pelorus::ResultBuilder result("by_time");
        result.column("time", "s", PLR_REDUCE_KEY);
        for (const Told& column : told) result.column(column.name, column.unit, PLR_REDUCE_ROOT_MEAN_SQUARE);
        result.column("objects", "", PLR_REDUCE_MEAN);
        result.column("measurements", "", PLR_REDUCE_MEAN);
        std::int64_t index = 0;
        for (const auto& [time, sum] : sums) {
            if (index++ < from_scan_) continue;
            std::vector<double> cells{static_cast<double>(time) * 1e-9};
            for (const Told& column : told) {
                double variance = 0;
                for (const int component : column.components) variance += sum.variances(component);
                cells.push_back(std::sqrt(variance / sum.objects));
            }
            cells.insert(cells.end(), {sum.objects, sum.measurements});
            result.row(cells);
        }
        for (const Told& column : told)
            if (column.is_norm) result.scalar_of_column(column.name + "_rmse", column.unit, column.name);
        publish(0, result.message(event.time));
    }

    template <class Archive> void state(Archive& archive) {
        archive(objects_, measurements_, noises_, models_.caller());
        for (const auto& [id, measurement] : measurements_)
            if (measurement.sensor >= models_.sensors().size() || measurement.noise >= noises_.size())
                throw pelorus::DataError("a saved measurement is of a sensor or a noise that is not there");
    }

private:
    struct Instant {
        Place place;
        std::vector<std::uint64_t> measurements;
        template <class Archive> void state(Archive& archive) { archive(place, measurements); }
    };
    struct Measurement {
        std::uint64_t sensor = 0, noise = 0;  ///< indices
        template <class Archive> void state(Archive& archive) { archive(sensor, noise); }
    };
    /// Over the objects of one time.
    struct Sums {
        Eigen::VectorXd variances;  ///< of the Cartesian components
        double objects = 0, measurements = 0;
    };
    /// A column that is the root of a sum of variances.
    struct Told {
        std::string name, unit;
        std::vector<int> components;
        bool is_norm;
    };

    /// Norms of what the motion has on all its axes, then single axes of the position.
    std::vector<Told> columns() const {
        std::vector<Told> out, axes;
        const pelorus::Space all = pelorus::kinematic_space(models_.axes(), {1, 1, 1});
        for (int derivative = 0; derivative < 3; ++derivative) {
            const pelorus::Component& first = all[derivative * models_.axes()];
            Told norm{first.name.substr(0, first.name.find('.')), first.unit, {}, true};
            for (int axis = 0; axis < models_.axes(); ++axis)
                norm.components.push_back(models_.cartesian().index(all[derivative * models_.axes() + axis].name));
            if (std::count(norm.components.begin(), norm.components.end(), -1) > 0) continue;
            out.push_back(norm);
            for (int axis = 0; axis < models_.axes(); ++axis)
                axes.push_back({all[derivative * models_.axes() + axis].name,
                                first.unit,
                                {norm.components[static_cast<std::size_t>(axis)]},
                                false});
        }
        out.insert(out.end(), axes.begin(), axes.end());
        return out;
    }

    Eigen::VectorXd cartesian_of(const pelorus::Space& told, const pelorus::ConstMatrixMap& state) const {
        const pelorus::Space& wanted = models_.cartesian();
        Eigen::VectorXd out(wanted.size());
        for (int k = 0; k < wanted.size(); ++k) {
            const int from = told.index(wanted[k].name);
            if (from < 0 && k < models_.axes()) throw pelorus::DataError("this truth tells no " + wanted[k].name);
            out(k) = from < 0 ? wanted[k].prior_mean : state(from, 0);
        }
        return out;
    }

    void add_object(const std::map<std::int64_t, Instant>& instants, std::map<std::int64_t, Sums>& sums) {
        Eigen::MatrixXd bound;
        const Place* before = nullptr;
        for (const auto& [time, instant] : instants) {
            bound = before == nullptr ? models_.start(instant.place, start_deviations_.value_or(std::vector<double>()))
                                      : models_.predicted(*before, instant.place, bound);
            const std::int64_t used = add_measurements(instant, bound);
            const Eigen::MatrixXd cartesian = models_.to_cartesian(instant.place, bound);
            Sums& sum = sums[time];
            if (sum.objects == 0) sum.variances = Eigen::VectorXd::Zero(cartesian.rows());
            sum.variances += cartesian.diagonal();
            sum.objects += 1;
            sum.measurements += static_cast<double>(used);
            before = &instant.place;
        }
    }

    /// Measurements of the same sensor and noise are as good as one of the n-th part of the noise. Answers how many there were.
    std::int64_t add_measurements(const Instant& instant, Eigen::MatrixXd& bound) {
        std::map<std::pair<std::uint64_t, std::uint64_t>, double> counts;
        std::int64_t used = 0;
        for (const std::uint64_t id : instant.measurements) {
            const auto found = measurements_.find(id);
            if (found == measurements_.end()) continue;  // of a sensor that is not looked at here
            counts[{found->second.sensor, found->second.noise}] += 1;
            ++used;
        }
        for (const auto& [which, count] : counts) {
            const auto sensor = static_cast<std::size_t>(which.first);
            const Eigen::MatrixXd noise = noise_of(sensor, noises_[which.second], instant.place) / count;
            bound = measured(bound, models_.jacobian(sensor, instant.place), noise);
        }
        return used;
    }

    Eigen::MatrixXd noise_of(std::size_t sensor, const std::vector<double>& told, const Place& place) {
        const Eigen::Index m = models_.sensors()[sensor].measurement.size();
        Eigen::MatrixXd noise = told.empty() ? models_.noise(sensor, place)
                                             : Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(told.data(), m, m));
        if (place.extent.size() > 0 && extent_factor_ > 0) {
            const Eigen::MatrixXd slope = models_.position_jacobian(sensor, place);
            if (place.extent.rows() != slope.cols())
                throw pelorus::DataError("the truth's extent has " + std::to_string(place.extent.rows()) +
                                         " axes, the motion " + std::to_string(slope.cols()));
            noise += extent_factor_ * slope.lazyProduct(place.extent.lazyProduct(slope.transpose()).eval());
        }
        return noise;
    }

    std::optional<std::vector<double>> start_deviations_;
    double extent_factor_ = 1;
    std::int64_t from_scan_ = 0;
    std::string frame_;
    Models models_;

    std::map<std::uint64_t, std::map<std::int64_t, Instant>> objects_;  // by id, then time
    std::map<std::uint64_t, Measurement> measurements_;                 // by id
    std::vector<std::vector<double>> noises_;                           // m x m by columns; empty: the sensor's own
};

}  // namespace cramer_rao
