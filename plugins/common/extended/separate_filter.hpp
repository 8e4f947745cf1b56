/// An estimator for the kinematics, an extent for the shape.
#pragma once

#include <vector>

#include "target_filter.hpp"

namespace extended {

/// What the covariance of a centroid about the object's centre is taken to be.
enum class CentroidNoise {
    effective,  ///< the extent's effective noise: (lambda X + R)/n for points of a known spread
    mean        ///< the mean R of the points, however many: the centroid as if it were one measurement of the centre
};

class SeparateFilter final : public TargetFilter {
public:
    SeparateFilter(const pelorus::EstimatorPart& estimator, const pelorus::ExtentPart& extent,
                   CentroidNoise centroid_noise = CentroidNoise::effective)
        : TargetFilter(extent), estimator_(estimator), centroid_noise_(centroid_noise) {
        const plr_estimator_info& info = estimator_.info();
        describe(*info.cartesian, info.sensors, info.sensor_count, "estimator");
        for (const SensorOfPoints& sensor : sensors_)
            if (sensor.measurement().size() != dimension())
                throw pelorus::PartError("estimator", "sensor " + sensor.part().name() + " measures " +
                                                          sensor.measurement().text() + "; a centroid of " +
                                                          std::to_string(dimension()) +
                                                          " axes enters through a sensor of as many components");
        kinematics_size_ = static_cast<std::size_t>(info.record_size);
        version_ = plr_mix_version(info.record_version, extent_info().record_version);
    }

    Records start(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                  const Moments& moments) const override {
        Records records = blank();
        start_extent(caller, look, scans, records);
        start_kinematics(caller, look, 3, moments, records);
        return records;
    }

    /// With D the covariance of a centroid: P_pp = D, P_pv = D/T, P_vv = 2 D/T^2.
    Records start_differenced(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                              const Eigen::VectorXd& mean) const override {
        Records records = blank();
        start_extent(caller, look, scans, records);
        const Eigen::MatrixXd noise = noise_of_centroid(caller, look, *scans.back(), records);
        const double dt = static_cast<double>(scans.back()->time - scans.front()->time) * 1e-9;
        Moments moments{mean, Eigen::MatrixXd::Zero(mean.size(), mean.size())};
        for (int col = 0; col < space_.size(); ++col)
            for (int row = 0; row < space_.size(); ++row) {
                const int order = derivative(row) + derivative(col);
                if (derivative(row) < 0 || derivative(row) > 1 || derivative(col) < 0 || derivative(col) > 1) continue;
                const double factor = order == 0 ? 1.0 : order == 1 ? 1.0 / dt : 2.0 / (dt * dt);
                moments.covariance(row, col) = factor * noise(axis(row), axis(col));
            }
        start_kinematics(caller, look, 2, moments, records);
        return records;
    }

    void predict(pelorus::Caller& caller, const Look& look, double dt, Records& records) const override {
        const Moments before = summary(caller, look, records);
        Eigen::MatrixXd extent;
        auto kinematics = pelorus::arguments<plr_estimator_predict>();
        kinematics.dt = pelorus::const_view(&dt, 1, 1, 1);
        if ((estimator_.info().flags & PLR_ESTIMATOR_USES_EXTENT) != 0) {
            extent = shape(caller, look, records);
            kinematics.extent = pelorus::const_view(extent);
        }
        kinematics.record = input(records.kinematics);
        kinematics.out = output(records.kinematics);
        caller.require(estimator_.call(&plr_estimator::predict, begin(caller, look), kinematics), "estimator, predict");
        const Moments after = summary(caller, look, records);
        auto args = pelorus::arguments<plr_extent_predict>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.before = pelorus::const_view(before.mean);
        args.after = pelorus::const_view(after.mean);
        args.before_covariance = pelorus::const_view(before.covariance);
        args.after_covariance = pelorus::const_view(after.covariance);
        args.record = input(records.extent);
        args.out = output(records.extent);
        caller.require(extent_.call(&plr_extent::predict, begin(caller, look), args), "extent, predict");
    }

    /// The centroid is one measurement of the sensor that saw the points, with J C J' for its noise: J the sensor's Jacobian
    /// there, C the extent's effective noise. A sensor of position takes it as it is.
    Update update(pelorus::Caller& caller, const Look& look, const Points& points, Records& records) const override {
        const Moments predicted = summary(caller, look, records);
        const Eigen::VectorXd centroid = points.centroid();
        const Eigen::MatrixXd noise = noise_of_centroid(caller, look, points, records);
        const Eigen::VectorXd innovation = centroid - predicted.mean.head(dimension());
        const Eigen::MatrixXd covariance = predicted.covariance.topLeftCorner(dimension(), dimension()) + noise;
        const double log_likelihood = update_kinematics(caller, look, points, centroid, noise, predicted, records);
        const Moments posterior = summary(caller, look, records);
        const PointsView scan(points);
        auto args = pelorus::arguments<plr_extent_update>();
        args.scan = scan.c();
        args.innovation = pelorus::const_view(innovation);
        args.innovation_covariance = pelorus::const_view(covariance);
        args.kinematics = pelorus::const_view(posterior.mean);
        args.kinematics_covariance = pelorus::const_view(posterior.covariance);
        args.record = input(records.extent);
        args.out = output(records.extent);
        caller.require(extent_.call(&plr_extent::update, begin(caller, look), args), "extent, update");
        return {log_likelihood, squared_innovation(innovation, covariance)};
    }

    Moments summary(pelorus::Caller& caller, const Look& look, const Records& records) const override {
        Moments out{Eigen::VectorXd(space_.size()), Eigen::MatrixXd(space_.size(), space_.size())};
        auto args = pelorus::arguments<plr_estimator_moments>();
        args.record = input(records.kinematics);
        args.mean = pelorus::view(out.mean);
        args.covariance = pelorus::view(out.covariance);
        caller.require(estimator_.call(&plr_estimator::summary, begin(caller, look), args), "estimator, summary");
        return out;
    }

    std::vector<double> distances(pelorus::Caller& caller, const Look& look, const Points& points,
                                  const Records& records) const override {
        const Moments predicted = summary(caller, look, records);
        const Eigen::VectorXd centre = predicted.mean.head(dimension());
        Eigen::MatrixXd covariance = predicted.covariance.topLeftCorner(dimension(), dimension());
        if (points.common.size() > 0) covariance += points.common;
        std::vector<double> out(points.ids.size());
        const PointsView scan(points);
        auto args = pelorus::arguments<plr_extent_gate>();
        args.record = input(records.extent);
        args.predicted = pelorus::const_view(centre);
        args.covariance = pelorus::const_view(covariance);
        args.scan = scan.c();
        args.squared_distance = pelorus::view(out.data(), 1, 1, points.count());
        caller.require(extent_.call(&plr_extent::gate, begin(caller, look), args), "extent, gate");
        return out;
    }

private:
    Records blank() const { return {std::vector<double>(kinematics_size_), std::vector<double>(extent_size())}; }

    void start_extent(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                      Records& records) const {
        const StartScans given(scans);
        auto args = pelorus::arguments<plr_extent_init>();
        args.scans = static_cast<std::uint32_t>(scans.size());
        args.scan = given.raw.data();
        args.times = given.time_view();
        args.record = output(records.extent);
        caller.require(extent_.call(&plr_extent::init, begin(caller, look), args), "extent, init");
    }

    /// Components of a derivative below `derivatives` are known; the others enter with the motion's priors.
    void start_kinematics(pelorus::Caller& caller, const Look& look, int derivatives, const Moments& moments,
                          Records& records) const {
        std::vector<std::int32_t> known;
        for (int c = 0; c < space_.size(); ++c)
            if (derivative(c) >= 0 && derivative(c) < derivatives) known.push_back(c);
        const auto k = static_cast<Eigen::Index>(known.size());
        Eigen::VectorXd mean(k);
        Eigen::MatrixXd covariance(k, k);
        for (Eigen::Index col = 0; col < k; ++col) {
            mean(col) = moments.mean(known[static_cast<std::size_t>(col)]);
            for (Eigen::Index row = 0; row < k; ++row)
                covariance(row, col) =
                    moments.covariance(known[static_cast<std::size_t>(row)], known[static_cast<std::size_t>(col)]);
        }
        auto args = pelorus::arguments<plr_estimator_init>();
        args.known = static_cast<std::uint32_t>(k);
        args.components = known.data();
        args.mean = pelorus::const_view(mean);
        args.covariance = pelorus::const_view(covariance);
        args.record = output(records.kinematics);
        caller.require(estimator_.call(&plr_estimator::init, begin(caller, look), args), "estimator, init");
    }

    /// Of the centroid, with what all points have in common.
    Eigen::MatrixXd noise_of_centroid(pelorus::Caller& caller, const Look& look, const Points& points,
                                      const Records& records) const {
        const Eigen::MatrixXd noise = points.mean_noise();
        Eigen::MatrixXd out = noise;
        if (centroid_noise_ == CentroidNoise::effective) effective_noise(caller, look, points, noise, records, out);
        if (points.common.size() > 0) out += points.common;
        return out;
    }

    void effective_noise(pelorus::Caller& caller, const Look& look, const Points& points, const Eigen::MatrixXd& noise,
                         const Records& records, Eigen::MatrixXd& out) const {
        const double number = points.number();
        auto args = pelorus::arguments<plr_extent_effective_noise>();
        args.record = input(records.extent);
        args.noise = pelorus::const_view(noise);
        args.number = pelorus::const_view(&number, 1, 1, 1);
        args.out = pelorus::view(out);
        caller.require(extent_.call(&plr_extent::effective_noise, begin(caller, look), args),
                       "extent, effective_noise");
    }

    double update_kinematics(pelorus::Caller& caller, const Look& look, const Points& points,
                             const Eigen::VectorXd& centroid, const Eigen::MatrixXd& noise, const Moments& predicted,
                             Records& records) const {
        const SensorOfPoints& sensor = sensors_[static_cast<std::size_t>(points.sensor)];
        const std::string name = "sensor " + sensor.part().name();
        const int m = sensor.measurement().size(), c = sensor.cartesian().size();
        Eigen::VectorXd place = Eigen::VectorXd::Zero(c), measurement(m);
        for (int k = 0; k < c; ++k) {
            const int known = space_.index(sensor.cartesian()[k].name);
            if (known >= 0) place(k) = predicted.mean(known);
        }
        for (int a = 0; a < dimension(); ++a) place(sensor.position()[static_cast<std::size_t>(a)]) = centroid(a);
        Eigen::MatrixXd full(m, c), jacobian(m, dimension());
        auto measure = pelorus::arguments<plr_sensor_measure>();
        measure.cartesian = pelorus::const_view(place);
        measure.out = pelorus::view(measurement);
        caller.require(sensor.part().call(&plr_sensor::measure, begin(caller, look), measure), name + ", measure");
        auto slope = pelorus::arguments<plr_sensor_jacobian>();
        slope.cartesian = pelorus::const_view(place);
        slope.out = pelorus::view(full);
        caller.require(sensor.part().call(&plr_sensor::jacobian, begin(caller, look), slope), name + ", jacobian");
        for (int a = 0; a < dimension(); ++a)
            jacobian.col(a) = full.col(sensor.position()[static_cast<std::size_t>(a)]);
        const Eigen::MatrixXd projected = jacobian.lazyProduct(noise.lazyProduct(jacobian.transpose()).eval());
        auto args = pelorus::arguments<plr_estimator_update>();
        args.sensor = static_cast<std::int32_t>(points.sensor);
        args.record = input(records.kinematics);
        args.measurement = pelorus::const_view(measurement);
        args.noise = pelorus::const_view(projected);
        args.out = output(records.kinematics);
        double log_likelihood = 0;
        args.log_likelihood = pelorus::view(&log_likelihood, 1, 1, 1);
        caller.require(estimator_.call(&plr_estimator::update, begin(caller, look), args), "estimator, update");
        return log_likelihood;
    }

    pelorus::EstimatorPart estimator_;
    CentroidNoise centroid_noise_;
};

}  // namespace extended
