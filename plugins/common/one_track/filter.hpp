/// An estimator that follows one target, as a stage calls it: one record, Eigen's matrices, exceptions.
///
/// For stages, which may take memory; models never include this. All functions throw pelorus::Failure with what the part told.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/caller.hpp>
#include <pelorus/messages.hpp>
#include <pelorus/parts.hpp>
#include <pelorus/small_matrix.hpp>

namespace one_track {

/// When, of which track, with which random numbers.
struct At {
    std::int64_t time = 0;  ///< ns
    std::uint64_t id = 0;
    plr_key key{};
};

using Record = std::vector<double>;

struct Moments {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
};

/// What a sensor would measure, by the prediction.
struct Projection {
    Eigen::VectorXd measurement;  ///< m
    Eigen::MatrixXd covariance;   ///< m x m: H P H', without R
    Eigen::MatrixXd cross;        ///< c x m: P H', Cartesian
};

/// Derivative (0 position .. 2 acceleration) times 3, plus the axis, of a kinematic component; -1 for another.
inline int kinematic_place(const std::string& name) {
    static const char* const derivatives[] = {"position.", "velocity.", "acceleration."};
    for (int d = 0; d < 3; ++d)
        for (int axis = 0; axis < 3; ++axis)
            if (name == std::string(derivatives[d]) + "xyz"[axis]) return 3 * d + axis;
    return -1;
}

class Filter {
public:
    static constexpr int most_measured = 8;  ///< components of a measurement

    /// Throws PartError(slot) where the estimator cannot follow a point.
    void setup(const pelorus::Setup& setup, const std::string& slot) {
        estimator_ = setup.part<pelorus::EstimatorPart>(slot);
        const plr_estimator_info& info = estimator_.info();
        if ((info.flags & PLR_ESTIMATOR_USES_EXTENT) != 0)
            throw pelorus::PartError(slot, "its motion needs the extent of the target, a point has none");
        cartesian_ = pelorus::Space(*info.cartesian);
        scratch_bytes_ = info.scratch_bytes;
        const char* at = reinterpret_cast<const char*>(info.sensors);
        for (std::uint32_t i = 0; i < info.sensor_count; ++i) {
            const auto& part = *reinterpret_cast<const plr_part*>(at);
            sensors_.emplace_back(part);
            if (sensors_.back().info().measurement->size > most_measured)
                throw pelorus::PartError(slot, "sensor " + sensors_.back().name() + " measures " +
                                                   std::to_string(sensors_.back().info().measurement->size) +
                                                   " components, at most " + std::to_string(most_measured) +
                                                   " are possible");
            places_.push_back(places_in(cartesian_, sensors_.back()));
            scratch_bytes_ = std::max(scratch_bytes_, sensors_.back().info().scratch_bytes);
            at += part.struct_size;
        }
        if (sensors_.empty())
            throw pelorus::PartError(slot, "has no sensors; fill its slot `sensors` with those of the scans");
    }
    /// What the estimator and its sensors need in a call; `caller` must be set up with as much.
    std::uint64_t scratch_bytes() const noexcept { return scratch_bytes_; }

    const pelorus::EstimatorPart& estimator() const noexcept { return estimator_; }
    const std::vector<pelorus::SensorPart>& sensors() const noexcept { return sensors_; }
    const pelorus::Space& cartesian() const noexcept { return cartesian_; }
    std::size_t record_size() const noexcept { return static_cast<std::size_t>(estimator_.info().record_size); }
    std::uint32_t record_version() const noexcept { return estimator_.info().record_version; }

    /// The sensor of that name (a single unnamed one stands for all), or -1.
    int sensor(const std::string& name) const {
        if (sensors_.size() == 1 && sensors_.front().name().empty()) return 0;
        for (std::size_t i = 0; i < sensors_.size(); ++i)
            if (sensors_[i].name() == name) return static_cast<int>(i);
        return -1;
    }

    /// From some Cartesian components (ascending) with their moments; the others enter with their priors.
    Record init(const At& at, const std::vector<std::int32_t>& known, const Moments& moments) {
        Record record(record_size());
        auto args = pelorus::arguments<plr_estimator_init>();
        args.known = static_cast<std::uint32_t>(known.size());
        args.components = known.data();
        args.mean = pelorus::const_view(moments.mean);
        args.covariance = pelorus::const_view(moments.covariance);
        args.record = output(record);
        caller.require(estimator_.call(&plr_estimator::init, begin(at), args), "estimator, init");
        return record;
    }

    void predict(const At& at, double dt, Record& record) {
        auto args = pelorus::arguments<plr_estimator_predict>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.extent = pelorus::absent_view();
        args.record = input(record);
        args.out = output(record);
        caller.require(estimator_.call(&plr_estimator::predict, begin(at), args), "estimator, predict");
    }

    Projection project(const At& at, int sensor, const Record& record) {
        const Eigen::Index m = measured(sensor);
        Projection out{Eigen::VectorXd(m), Eigen::MatrixXd(m, m), Eigen::MatrixXd(cartesian_.size(), m)};
        auto args = pelorus::arguments<plr_estimator_project>();
        args.sensor = sensor;
        args.record = input(record);
        args.measurement = pelorus::view(out.measurement);
        args.covariance = pelorus::view(out.covariance);
        args.cross = pelorus::absent_output();
        args.cartesian_cross = pelorus::view(out.cross);
        caller.require(estimator_.call(&plr_estimator::project, begin(at), args), "estimator, project");
        return out;
    }

    /// Answers the squared innovation, e' S^-1 e. The record stays what it was where it throws.
    double update(const At& at, int sensor, const Eigen::VectorXd& measurement, const Eigen::MatrixXd& noise,
                  Record& record) {
        const Eigen::Index m = measured(sensor);
        Eigen::VectorXd innovation(m);
        Eigen::MatrixXd covariance(m, m);
        Record updated(record.size());
        auto args = pelorus::arguments<plr_estimator_update>();
        args.sensor = sensor;
        args.record = input(record);
        args.measurement = pelorus::const_view(measurement);
        args.noise = pelorus::const_view(noise);
        args.out = output(updated);
        args.log_likelihood = pelorus::absent_output();
        args.innovation = pelorus::view(innovation);
        args.innovation_covariance = pelorus::view(covariance);
        caller.require(estimator_.call(&plr_estimator::update, begin(at), args), "estimator, update");
        using Square = pelorus::small::Bounded<most_measured, most_measured>;
        Square root = covariance;
        if (!pelorus::small::cholesky(root, root))
            throw pelorus::NumericError("the innovation covariance is not positive definite");
        record.swap(updated);
        return pelorus::small::inverse_quadratic(root, pelorus::small::Bounded<most_measured, 1>(innovation));
    }

    Moments summary(const At& at, const Record& record) {
        const Eigen::Index c = cartesian_.size();
        Moments out{Eigen::VectorXd(c), Eigen::MatrixXd(c, c)};
        auto args = pelorus::arguments<plr_estimator_moments>();
        args.record = input(record);
        args.mean = pelorus::view(out.mean);
        args.covariance = pelorus::view(out.covariance);
        caller.require(estimator_.call(&plr_estimator::summary, begin(at), args), "estimator, summary");
        return out;
    }

    /// The sensor's own noise of an object at a Cartesian mean of the estimator. Absent views: nominal SNR, base waveform.
    Eigen::MatrixXd noise(const At& at, int sensor, const Eigen::VectorXd& mean,
                          const plr_const_view& snr = pelorus::absent_view(),
                          const plr_const_view& waveform = pelorus::absent_view()) {
        return noise_at(at, sensor, looked_at(places_[static_cast<std::size_t>(sensor)], mean), snr, waveform);
    }

    /// The same where nothing is predicted: where the measurement, taken as exact, says that the object is.
    Eigen::MatrixXd noise_of(const At& at, int sensor, const Eigen::VectorXd& measurement, const plr_const_view& snr,
                             const plr_const_view& waveform) {
        const plr_sensor_info& info = part(sensor).info();
        Eigen::VectorXd place = Eigen::VectorXd::Zero(info.cartesian->size);
        if ((info.flags & PLR_SENSOR_CONSTANT_NOISE) == 0) {
            const Eigen::Index m = measured(sensor);
            const Moments told = invert(at, sensor, measurement, Eigen::MatrixXd::Zero(m, m));
            place = looked_at(places_in(pelorus::Space(*info.inverse), part(sensor)), told.mean);
        }
        return noise_at(at, sensor, place, snr, waveform);
    }

    bool inverts(int sensor) const { return (part(sensor).info().flags & PLR_SENSOR_CAN_INVERT) != 0; }

    /// What a single measurement tells, in the components of info.inverse.
    Moments invert(const At& at, int sensor, const Eigen::VectorXd& measurement, const Eigen::MatrixXd& noise) {
        const auto k = static_cast<Eigen::Index>(part(sensor).info().inverse->size);
        Moments out{Eigen::VectorXd(k), Eigen::MatrixXd(k, k)};
        auto args = pelorus::arguments<plr_sensor_invert>();
        args.measurement = pelorus::const_view(measurement);
        args.noise = pelorus::const_view(noise);
        args.mean = pelorus::view(out.mean);
        args.covariance = pelorus::view(out.covariance);
        const auto& sensor_part = part(sensor);
        caller.require(sensor_part.call(&plr_sensor::invert, begin(at), args),
                       "sensor " + sensor_part.name() + ", invert");
        return out;
    }

    pelorus::Caller caller;

private:
    const pelorus::SensorPart& part(int sensor) const { return sensors_[static_cast<std::size_t>(sensor)]; }
    Eigen::Index measured(int sensor) const { return static_cast<Eigen::Index>(part(sensor).info().measurement->size); }
    const plr_call& begin(const At& at) { return caller.begin(at.time, 1, &at.id, &at.key); }
    static plr_const_view input(const Record& record) {
        return pelorus::const_view(record.data(), static_cast<std::int64_t>(record.size()), 1, 1);
    }
    static plr_view output(Record& record) {
        return pelorus::view(record.data(), static_cast<std::int64_t>(record.size()), 1, 1);
    }

    /// Where a space has what a sensor looks at, or -1.
    static std::vector<int> places_in(const pelorus::Space& space, const pelorus::SensorPart& sensor) {
        const pelorus::Space wanted(*sensor.info().cartesian);
        std::vector<int> places;
        for (const pelorus::Component& component : wanted.components()) places.push_back(space.index(component.name));
        return places;
    }

    /// What a sensor looks at, from its places in a mean; what is not known (-1) is 0.
    static Eigen::VectorXd looked_at(const std::vector<int>& places, const Eigen::VectorXd& mean) {
        Eigen::VectorXd out(static_cast<Eigen::Index>(places.size()));
        for (std::size_t k = 0; k < places.size(); ++k)
            out(static_cast<Eigen::Index>(k)) = places[k] < 0 ? 0.0 : mean(places[k]);
        return out;
    }

    Eigen::MatrixXd noise_at(const At& at, int sensor, const Eigen::VectorXd& place, const plr_const_view& snr,
                             const plr_const_view& waveform) {
        const auto& sensor_part = part(sensor);
        Eigen::MatrixXd out(measured(sensor), measured(sensor));
        auto args = pelorus::arguments<plr_sensor_noise>();
        args.cartesian = pelorus::const_view(place);
        args.snr = snr;
        args.waveform = waveform;
        args.out = pelorus::view(out);
        caller.require(sensor_part.call(&plr_sensor::noise, begin(at), args),
                       "sensor " + sensor_part.name() + ", noise");
        return out;
    }

    pelorus::EstimatorPart estimator_;
    std::vector<pelorus::SensorPart> sensors_;
    std::vector<std::vector<int>> places_;  ///< of what each sensor looks at, in `cartesian_`
    pelorus::Space cartesian_;
    std::uint64_t scratch_bytes_ = 0;
};

}  // namespace one_track
