#include "models.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>

namespace point_target {

namespace {

const char* const position_names[] = {"position.x", "position.y", "position.z"};
const char* const velocity_names[] = {"velocity.x", "velocity.y", "velocity.z"};

std::int64_t wide(std::size_t n) { return static_cast<std::int64_t>(n); }

}  // namespace

void Models::setup(const pelorus::Setup& setup, double gate_probability) {
    estimator_ = setup.part<pelorus::EstimatorPart>("estimator");
    const plr_estimator_info& info = estimator_.info();
    if ((info.flags & PLR_ESTIMATOR_USES_EXTENT) != 0)
        throw pelorus::PartError("estimator", "its motion needs the extent of the target, points have none");
    smoothing_ = estimator_.extension<plr_estimator_smoothed>(PLR_ESTIMATOR_SMOOTHED);
    mix_ = estimator_.extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX);
    cartesian_ = pelorus::Space(*info.cartesian);
    record_size_ = static_cast<std::size_t>(info.record_size);
    for (std::size_t a = 0; a < 3; ++a) {
        axes_ += cartesian_.index(position_names[a]) == axes_ ? 1 : 0;
        velocity_[a] = cartesian_.index(velocity_names[a]);
    }
    if (axes_ == 0)
        throw pelorus::PartError("estimator",
                                 "its components are " + cartesian_.text() + ", expected position.x first");
    std::uint64_t scratch = info.scratch_bytes;
    const char* at = reinterpret_cast<const char*>(info.sensors);
    for (std::uint32_t i = 0; i < info.sensor_count; ++i) {
        const auto& part = *reinterpret_cast<const plr_part*>(at);
        add_sensor(part, gate_probability);
        scratch = std::max(scratch, sensors_.back().part.info().scratch_bytes);
        at += part.struct_size;
    }
    if (std::none_of(sensors_.begin(), sensors_.end(), [](const SensorModel& s) { return s.locates(); }))
        throw pelorus::PartError("estimator",
                                 "none of its sensors tells a position by a single measurement; no track can start. "
                                 "A sensor tells one by PLR_SENSOR_CAN_INVERT and `invert`; or add another that does");
    caller_.setup(setup, static_cast<std::size_t>(scratch) + 4096);
    draws_ = (info.flags & PLR_FLAG_USES_KEYS) != 0;
    if (draws_) random_ = &setup.service<plr_random>();
    key_ = setup.key();
}

void Models::add_sensor(const plr_part& part, double gate_probability) {
    SensorModel model;
    model.part = pelorus::SensorPart(part);
    model.name = part.name;
    const plr_sensor_info& info = model.part.info();
    model.m = static_cast<int>(info.measurement->size);
    if (model.m > most_measured)
        throw pelorus::PartError("estimator", "sensor " + model.name + " measures " + std::to_string(model.m) +
                                                  " components, at most " + std::to_string(most_measured) +
                                                  " are possible");
    model.constant_noise = (info.flags & PLR_SENSOR_CONSTANT_NOISE) != 0;
    model.gate = boost::math::quantile(boost::math::chi_squared(model.m), gate_probability);
    model.axis = {-1, -1, -1};
    if ((info.flags & PLR_SENSOR_CAN_INVERT) != 0) {
        const pelorus::Space inverse(*info.inverse);
        for (int c = 0; c < cartesian_.size(); ++c) {
            const int place = inverse.index(cartesian_[c].name);
            if (place < 0) continue;
            model.components.push_back(c);
            model.order.push_back(place);
        }
        model.known = inverse.size();
        for (std::size_t a = 0; a < static_cast<std::size_t>(axes_); ++a) {
            model.axis[a] = inverse.index(position_names[a]);
            model.axes += model.axis[a] >= 0 ? 1 : 0;
        }
    }
    sensors_.push_back(std::move(model));
}

const SensorModel& Models::sensor(const std::string& name) const {
    if (sensors_.size() == 1 && sensors_.front().name.empty()) return sensors_.front();
    for (const SensorModel& sensor : sensors_)
        if (sensor.name == name) return sensor;
    throw pelorus::DataError("a scan of sensor " + name + " came, which the estimator does not hold");
}

const plr_call& Models::start(std::size_t n, const std::uint64_t* ids) {
    keys_.clear();
    if (draws_ && ids != nullptr)
        for (std::size_t i = 0; i < n; ++i) keys_.push_back(random_->derive(key_, PLR_STREAM_PARTICLES, step_, ids[i]));
    return caller_.begin(time_, wide(n), ids, keys_.empty() ? nullptr : keys_.data());
}

void Models::finish(plr_status status, const char* what, std::size_t n, Failures& failed) {
    failed.assign(n, 0);
    if (!caller_.tolerate(status, what)) return;
    const plr_call& call = caller_.call();
    for (std::size_t i = 0; i < n; ++i) {
        if (call.item_status[i] == PLR_OK) continue;
        // A track may come to a numerical end; anything else is a fault of the model, and no track would be better off.
        if (call.item_status[i] != PLR_E_NUMERIC) caller_.require(call.item_status[i], what);
        failed[i] = 1;
    }
    if (told_failure_ || call.log == nullptr || PLR_LOG_WARNING < call.log->level) return;
    told_failure_ = true;
    const std::string line = "numerical failure (the first one; all are counted): " + caller_.explain(what);
    call.log->write(call.log->context, PLR_LOG_WARNING, line.c_str());
}

void Models::predict(std::size_t n, const std::uint64_t* ids, const double* dt, double* records, Failures& failed) {
    auto args = pelorus::arguments<plr_estimator_predict>();
    const std::int64_t r = wide(record_size_);
    args.dt = pelorus::const_view(dt, 1, 1, wide(n));
    args.extent = pelorus::absent_view();
    args.record = pelorus::const_view(records, r, 1, wide(n));
    args.out = pelorus::view(records, r, 1, wide(n));
    const plr_call& call = start(n, ids);
    finish(estimator_.call(&plr_estimator::predict, call, args), "predict", n, failed);
}

void Models::project(const SensorModel& sensor, std::size_t n, const std::uint64_t* ids, const double* records,
                     double* measurement, double* covariance, Failures& failed) {
    auto args = pelorus::arguments<plr_estimator_project>();
    args.sensor = index(sensor);
    args.record = pelorus::const_view(records, wide(record_size_), 1, wide(n));
    args.measurement = pelorus::view(measurement, sensor.m, 1, wide(n));
    args.covariance = pelorus::view(covariance, sensor.m, sensor.m, wide(n));
    args.cross = args.cartesian_cross = pelorus::absent_output();
    const plr_call& call = start(n, ids);
    finish(estimator_.call(&plr_estimator::project, call, args), "project", n, failed);
}

void Models::update(const SensorModel& sensor, std::size_t n, const std::uint64_t* ids, const double* measurement,
                    const double* noise, double* records, Failures& failed) {
    auto args = pelorus::arguments<plr_estimator_update>();
    args.sensor = index(sensor);
    args.record = pelorus::const_view(records, wide(record_size_), 1, wide(n));
    args.measurement = pelorus::const_view(measurement, sensor.m, 1, wide(n));
    args.noise = pelorus::const_view(noise, sensor.m, sensor.m, wide(n));
    args.out = pelorus::view(records, wide(record_size_), 1, wide(n));
    args.log_likelihood = args.innovation = args.innovation_covariance = pelorus::absent_output();
    const plr_call& call = start(n, ids);
    finish(estimator_.call(&plr_estimator::update, call, args), "update", n, failed);
}

bool Models::mix(std::uint64_t id, const std::vector<double>& weights, const double* records, double* out) {
    auto args = pelorus::arguments<plr_estimator_mix_args>();
    const std::int64_t hypotheses = wide(weights.size());
    args.weights = pelorus::const_view(weights.data(), hypotheses, 1, 1);
    args.records = pelorus::const_view(records, wide(record_size_), hypotheses, 1);
    args.out = pelorus::view(out, wide(record_size_), 1, 1);
    const plr_call& call = start(1, &id);
    Failures failed;
    finish(mix_->mix(estimator_.self(), &call, &args), "mix", 1, failed);
    return failed.front() == 0;
}

void Models::summary(std::size_t n, const std::uint64_t* ids, const double* records, double* mean, double* covariance,
                     Failures& failed) {
    auto args = pelorus::arguments<plr_estimator_moments>();
    const std::int64_t c = cartesian_.size();
    args.record = pelorus::const_view(records, wide(record_size_), 1, wide(n));
    args.mean = pelorus::view(mean, c, 1, wide(n));
    args.covariance = pelorus::view(covariance, c, c, wide(n));
    const plr_call& call = start(n, ids);
    finish(estimator_.call(&plr_estimator::summary, call, args), "summary", n, failed);
}

void Models::smoothed(std::size_t n, const std::uint64_t* ids, const double* records, double* known, double* age,
                      double* mean, double* covariance, Failures& failed) {
    auto args = pelorus::arguments<plr_estimator_smoothed_args>();
    const std::int64_t c = cartesian_.size(), most = smoothing_->most;
    args.record = pelorus::const_view(records, wide(record_size_), 1, wide(n));
    args.known = pelorus::view(known, 1, 1, wide(n));
    args.age = pelorus::view(age, most, 1, wide(n));
    args.mean = pelorus::view(mean, c, most, wide(n));
    args.covariance = pelorus::view(covariance, c, c * most, wide(n));
    const plr_call& call = start(n, ids);
    finish(smoothing_->smoothed(estimator_.self(), &call, &args), "smoothed", n, failed);
}

void Models::init(const std::vector<int>& known, std::size_t n, const std::uint64_t* ids, const double* mean,
                  const double* covariance, double* records, Failures& failed) {
    auto args = pelorus::arguments<plr_estimator_init>();
    const std::vector<std::int32_t> components(known.begin(), known.end());
    const std::int64_t k = wide(known.size());
    args.known = static_cast<std::uint32_t>(known.size());
    args.components = components.data();
    args.mean = pelorus::const_view(mean, k, 1, wide(n));
    args.covariance = pelorus::const_view(covariance, k, k, wide(n));
    args.record = pelorus::view(records, wide(record_size_), 1, wide(n));
    const plr_call& call = start(n, ids);
    finish(estimator_.call(&plr_estimator::init, call, args), "init", n, failed);
}

void Models::residual(const SensorModel& sensor, std::size_t n, const double* measurement, const double* reference,
                      double* out, Failures& failed) {
    auto args = pelorus::arguments<plr_sensor_residual>();
    args.measurement = pelorus::const_view(measurement, sensor.m, 1, wide(n));
    args.reference = pelorus::const_view(reference, sensor.m, 1, wide(n));
    args.out = pelorus::view(out, sensor.m, 1, wide(n));
    const plr_call& call = start(n);
    finish(sensor.part.call(&plr_sensor::residual, call, args), "residual", n, failed);
}

void Models::invert(const SensorModel& sensor, std::size_t n, const double* measurement, const double* noise,
                    double* mean, double* covariance, Failures& failed) {
    auto args = pelorus::arguments<plr_sensor_invert>();
    args.measurement = pelorus::const_view(measurement, sensor.m, 1, wide(n));
    args.noise = pelorus::const_view(noise, sensor.m, sensor.m, wide(n));
    args.mean = pelorus::view(mean, sensor.known, 1, wide(n));
    args.covariance = pelorus::view(covariance, sensor.known, sensor.known, wide(n));
    const plr_call& call = start(n);
    finish(sensor.part.call(&plr_sensor::invert, call, args), "invert", n, failed);
}

void Models::noise(const SensorModel& sensor, std::size_t n, const double* places, const plr_scan& scan, double* out,
                   Failures& failed) {
    auto args = pelorus::arguments<plr_sensor_noise>();
    args.cartesian = places == nullptr ? pelorus::absent_view()
                                       : pelorus::const_view(places, sensor.part.info().cartesian->size, 1, wide(n));
    args.snr = scan.snr;
    args.waveform = scan.waveform;
    if (args.waveform.data != nullptr) {  // one for the whole scan
        args.waveform.count = wide(n);
        args.waveform.item_stride = 0;
    }
    args.out = pelorus::view(out, sensor.m, sensor.m, wide(n));
    const plr_call& call = start(n);
    finish(sensor.part.call(&plr_sensor::noise, call, args), "noise", n, failed);
}

}  // namespace point_target
