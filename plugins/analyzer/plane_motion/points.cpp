#include "points.hpp"

#include <algorithm>

namespace plane_motion {

void Points::setup(const pelorus::Setup& setup) {
    frame_ = setup.frame();
    std::uint64_t scratch = 0;
    for (const pelorus::SensorPart& part : setup.parts<pelorus::SensorPart>("sensors")) {
        const plr_sensor_info& info = part.info();
        if ((info.flags & PLR_SENSOR_CAN_INVERT) == 0 || info.inverse == nullptr)
            throw pelorus::PartError("sensors", part.id() + " cannot convert single measurements to points");
        SensorModel model{part,
                          pelorus::Space(*info.measurement),
                          pelorus::Space(*info.inverse),
                          pelorus::Space(*info.cartesian),
                          {}};
        const pelorus::Space wanted = pelorus::position_space(3);
        for (int k = 0; k < 3; ++k) {
            model.axes[k] = model.inverse.index(wanted[k].name);
            if (model.axes[k] < 0)
                throw pelorus::PartError("sensors",
                                         part.id() + " tells no " + wanted[k].name + "; a plane is one in space");
        }
        scratch = std::max(scratch, info.scratch_bytes);
        sensors_.push_back(std::move(model));
    }
    caller_.setup(setup, static_cast<std::size_t>(scratch) + 4096);
}

std::vector<pelorus::Stream> Points::streams() const {
    std::vector<pelorus::Stream> out;
    for (const SensorModel& sensor : sensors_) {
        const std::string name = sensor.part.name();
        out.push_back({name, name.empty() && sensors_.size() == 1, sensor.measurement, false, frame_, false, false});
    }
    if (out.empty()) out.push_back({"", true, pelorus::position_space(3), false, frame_, false, false});
    return out;
}

std::vector<Sample> Points::read(std::int64_t time, const plr_scan& scan) {
    std::vector<Sample> out;
    for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
        const std::int64_t at = scan.times == nullptr ? time : scan.times[i];
        out.push_back(sensors_.empty() ? told(scan, i) : converted(sensor_of(scan.sensor), at, scan, i));
        out.back().time = at;
        if (!out.back().point.allFinite() || !out.back().covariance.allFinite())
            throw pelorus::DataError("measurement " + std::to_string(scan.ids[i]) + " or its covariance is not finite");
    }
    return out;
}

const Points::SensorModel& Points::sensor_of(const std::string& name) const {
    if (sensors_.size() == 1 && sensors_.front().part.name().empty()) return sensors_.front();
    for (const SensorModel& sensor : sensors_)
        if (sensor.part.name() == name) return sensor;
    throw pelorus::DataError("there is no sensor " + name + " in the slot `sensors`");
}

Sample Points::told(const plr_scan& scan, std::int64_t i) const {
    if (scan.covariances.data == nullptr)
        throw pelorus::DataError("the positions of sensor " + std::string(scan.sensor) +
                                 " come without covariances; put it into the slot `sensors`");
    return {0, pelorus::load<3, 1>(scan.measurements, i), pelorus::load<3, 3>(scan.covariances, i)};
}

void Points::invert(const SensorModel& sensor, std::int64_t time, const Eigen::VectorXd& z,
                    const Eigen::MatrixXd& noise, Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) {
    mean.resize(sensor.inverse.size());
    covariance.resize(sensor.inverse.size(), sensor.inverse.size());
    auto args = pelorus::arguments<plr_sensor_invert>();
    args.measurement = pelorus::const_view(z);
    args.noise = pelorus::const_view(noise);
    args.mean = pelorus::view(mean);
    args.covariance = pelorus::view(covariance);
    caller_.require(sensor.part.call(&plr_sensor::invert, caller_.begin(time, 1), args),
                    "sensor " + sensor.part.name() + ", invert");
}

/// What the scan tells, else the sensor model's own: where it depends on the place, at the place measured.
Eigen::MatrixXd Points::noise(const SensorModel& sensor, std::int64_t time, const plr_scan& scan, std::int64_t i) {
    if (scan.covariances.data != nullptr) return pelorus::item(scan.covariances, i);
    const int m = sensor.measurement.size();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(m, m);
    Eigen::VectorXd place(sensor.cartesian.size());
    auto args = pelorus::arguments<plr_sensor_noise>();
    args.cartesian = pelorus::absent_view();
    if ((sensor.part.info().flags & PLR_SENSOR_CONSTANT_NOISE) == 0) {
        Eigen::VectorXd mean;
        Eigen::MatrixXd covariance;
        invert(sensor, time, pelorus::item(scan.measurements, i), out, mean, covariance);
        for (int k = 0; k < sensor.cartesian.size(); ++k) {
            const int from = sensor.inverse.index(sensor.cartesian[k].name);
            place(k) = from < 0 ? sensor.cartesian[k].prior_mean : mean(from);
        }
        args.cartesian = pelorus::const_view(place);
    }
    if (scan.snr.data != nullptr) args.snr = pelorus::slice(scan.snr, i, 1);
    args.waveform = scan.waveform;
    args.out = pelorus::view(out);
    caller_.require(sensor.part.call(&plr_sensor::noise, caller_.begin(time, 1), args),
                    "sensor " + sensor.part.name() + ", noise");
    return out;
}

Sample Points::converted(const SensorModel& sensor, std::int64_t time, const plr_scan& scan, std::int64_t i) {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    invert(sensor, time, pelorus::item(scan.measurements, i), noise(sensor, time, scan, i), mean, covariance);
    Sample out;
    for (int row = 0; row < 3; ++row) {
        out.point(row) = mean(sensor.axes[row]);
        for (int col = 0; col < 3; ++col) out.covariance(row, col) = covariance(sensor.axes[row], sensor.axes[col]);
    }
    return out;
}

}  // namespace plane_motion
