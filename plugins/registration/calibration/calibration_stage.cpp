#include "calibration_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calibration {

namespace {

std::int64_t time_of(const pelorus::Event& event, const plr_scan& scan, std::int64_t i) {
    return scan.times == nullptr ? event.time : scan.times[i];
}

plr_const_view snr_of(const plr_scan& scan, std::int64_t i) {
    if (scan.snr.data == nullptr) return pelorus::absent_view();
    return pelorus::const_view(scan.snr.data + i * scan.snr.item_stride, 1, 1, 1);
}

void expect_space(const plr_scan& scan, const SensorModel& sensor) {
    const pelorus::Space offered(*scan.space);
    if (!offered.same(sensor.space()))
        throw pelorus::DataError("a scan of sensor " + sensor.name() + " has " + offered.text() +
                                 ", its model measures " + sensor.space().text());
}

}  // namespace

// --------------------------------------------------------------------------------------------------------------- setup

void CalibrationStage::setup(const pelorus::Setup& setup) {
    const auto parts = setup.parts<pelorus::SensorPart>("sensors");
    check_parts(parts);
    BiasVector deviations;
    deviations << attitude_sd_, position_sd_, range_sd_, clock_sd_;
    check_biases(deviations);
    biases_ = Biases(deviations, presence_);
    caller_.setup(setup,
                  static_cast<std::size_t>(std::max(reference_.scratch_bytes(), sensor_.scratch_bytes())) + 4096);
    rule_ = {nanoseconds(window_), gate_, maximum_speed_};
    lateness_ns_ = nanoseconds(lateness_);
    row_spacing_ = nanoseconds(every_);
    frame_name_ = setup.frame();
    diagnostics_ = setup.optional_service<plr_diagnostics>();
    log_ = setup.optional_service<plr_log>();
    bool is_one_unit = true;
    for (const auto& component : sensor_.space().components()) {
        is_one_unit = is_one_unit && component.unit == sensor_.space()[0].unit;
        bias_units_ += (bias_units_.empty() ? "" : ", ") + component.unit;
    }
    if (is_one_unit) bias_units_ = sensor_.space()[0].unit;
}

void CalibrationStage::check_parts(const std::vector<pelorus::SensorPart>& parts) {
    const auto index_of = [&](const char* parameter, const std::string& name) {
        for (std::size_t i = 0; i < parts.size(); ++i)
            if (parts[i].name() == name) return i;
        throw pelorus::ParameterError(
            parameter, "is " + name + ", the slot `sensors` has " + parts[0].name() + ", " + parts[1].name());
    };
    std::size_t reference = reference_name_ ? index_of("reference", *reference_name_) : 0;
    const std::size_t sensor = sensor_name_ ? index_of("sensor", *sensor_name_) : 1 - reference;
    if (!reference_name_) reference = 1 - sensor;
    if (reference == sensor)
        throw pelorus::ParameterError("sensor", "is " + parts[sensor].name() + ", which is the reference already");
    reference_ = SensorModel(parts[reference], "sensors");
    sensor_ = SensorModel(parts[sensor], "sensors");
    if (!reference_.inverts())
        throw pelorus::PartError("sensors",
                                 "the reference " + reference_.name() + " tells no position by a single measurement");
    if (reference_.dimension() != sensor_.dimension())
        throw pelorus::PartError("sensors", "one is in the plane, the other in space");
}

void CalibrationStage::check_biases(const BiasVector& deviations) const {
    if (deviations.segment<3>(roll).maxCoeff() > 0 && !sensor_.measures_direction())
        throw pelorus::ParameterError("attitude_sd", "is for a sensor of azimuth and elevation or zenith; " +
                                                         sensor_.name() + " measures " + sensor_.space().text());
    if (range_sd_ > 0 && !sensor_.measures_range())
        throw pelorus::ParameterError(
            "range_sd", "is for a sensor of ranges; " + sensor_.name() + " measures " + sensor_.space().text());
    if (sensor_.dimension() == 2 && (deviations(roll) > 0 || deviations(pitch) > 0))
        throw pelorus::ParameterError("attitude_sd", "has an angle out of the plane; write [0 rad, 0 rad, ...]");
    if (sensor_.dimension() == 2 && deviations(offset_z) > 0)
        throw pelorus::ParameterError("position_sd", "has an offset out of the plane; write [..., ..., 0 m]");
}

std::vector<pelorus::Stream> CalibrationStage::in_streams(std::uint32_t port) const {
    std::vector<pelorus::Stream> streams;
    if (port == tracks_in) {
        pelorus::Stream stream;
        stream.any_space = true;
        stream.frame = frame_name_;
        return {stream};
    }
    for (const SensorModel* sensor : {&reference_, &sensor_}) {
        pelorus::Stream stream;
        stream.sensor = sensor->name();
        stream.space = sensor->space();
        stream.frame = frame_name_;
        streams.push_back(std::move(stream));
    }
    pelorus::Stream other;
    other.any_sensor = other.any_space = other.any_frame = true;
    streams.push_back(std::move(other));
    return streams;
}

void CalibrationStage::check_state() const {
    for (const Frame& frame : frames_)
        for (const Sample& sample : frame.samples)
            if (sample.value.size() != sensor_.space().size() || sample.variances.size() != sensor_.space().size())
                throw pelorus::DataError("the saved measurements are of another sensor");
    if (row_spacing_ <= 0) throw pelorus::DataError("the saved table has no spacing");
}

// --------------------------------------------------------------------------------------------------------------- scans

void CalibrationStage::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    if (scan.sensor == reference_.name()) return take_reference(event, scan);
    if (scan.sensor == sensor_.name()) return take_sensor(event, scan);
    publish_scan(event.time, scan);
}

/// True where this scan has come before; scans without a measurement teach nothing and are not remembered.
bool CalibrationStage::is_repeated(std::int64_t time, std::uint64_t id) {
    const std::pair<std::int64_t, std::uint64_t> key(time, id);
    if (std::find(seen_.begin(), seen_.end(), key) != seen_.end()) return true;
    seen_.push_back(key);
    return false;
}

void CalibrationStage::take_reference(const pelorus::Event& event, const plr_scan& scan) {
    expect_space(scan, reference_);
    Fixes fixes;
    for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
        try {
            std::optional<Eigen::MatrixXd> noise;
            if (scan.covariances.data != nullptr) noise = pelorus::item(scan.covariances, i);
            const SensorModel::Fix told =
                reference_.invert(caller_, pelorus::item(scan.measurements, i), noise, snr_of(scan, i), scan.waveform);
            fixes.push_back({scan.ids[i], time_of(event, scan, i), told.position, told.covariance});
            if (!pose_) pose_ = sensor_.pose(caller_, told.position);
        } catch (const pelorus::Failure& failure) {
            if (failure.code() != PLR_E_NUMERIC) throw;
            count("refused_fixes");
        }
    }
    publish_scan(event.time, scan);
    if (fixes.empty() || is_repeated(event.time, fixes.front().id)) return;
    if (!newest_fix_ || event.time >= *newest_fix_) {
        newest_fix_ = event.time;
        last_fixes_ = fixes;
    }
    if (!biases_.active().empty()) waiting_.push_back(std::move(fixes));
    learn(event);
}

Frame CalibrationStage::frame_of(const pelorus::Event& event, const plr_scan& scan) {
    Frame frame;
    frame.time = event.time;
    const Eigen::Vector3d place = last_fixes_.empty() ? Eigen::Vector3d::Zero() : last_fixes_.front().position;
    for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
        Sample sample;
        sample.id = scan.ids[i];
        sample.time = time_of(event, scan, i);
        sample.value = pelorus::item(scan.measurements, i);
        sample.variances =
            scan.covariances.data != nullptr
                ? Eigen::VectorXd(pelorus::item(scan.covariances, i).diagonal())
                : Eigen::VectorXd(sensor_.noise(caller_, place, snr_of(scan, i), scan.waveform).diagonal());
        if (!(sample.variances.minCoeff() > 0))
            throw pelorus::DataError("a measurement of sensor " + sensor_.name() + " has a variance of 0");
        frame.samples.push_back(std::move(sample));
    }
    return frame;
}

void CalibrationStage::take_sensor(const pelorus::Event& event, const plr_scan& scan) {
    expect_space(scan, sensor_);
    Frame frame = frame_of(event, scan);
    publish_corrected(event, scan, frame);
    if (frame.samples.empty() || biases_.active().empty() || is_repeated(event.time, frame.samples.front().id)) return;
    newest_frame_ = std::max(newest_frame_.value_or(event.time), event.time);
    const auto place = std::upper_bound(frames_.begin(), frames_.end(), event.time,
                                        [](std::int64_t time, const Frame& other) { return time < other.time; });
    frames_.insert(place, std::move(frame));
    learn(event);
}
// ------------------------------------------------------------------------------------------------------------ learning

/// All fixes that frames surround by now, or never will.
void CalibrationStage::learn(const pelorus::Event& event) {
    bool has_learnt = false;
    const auto is_due = [&](const Fixes& fixes) {
        const std::int64_t offset = nanoseconds(biases_.mean()(clock_offset));
        std::int64_t last = fixes.front().time;
        for (const Fix& fix : fixes) last = std::max(last, fix.time);
        return newest_frame_ && *newest_frame_ >= last + offset + rule_.window / 2;
    };
    for (auto fixes = waiting_.begin(); fixes != waiting_.end();) {
        if (!is_due(*fixes)) {
            ++fixes;
            continue;
        }
        has_learnt = learn_from(*fixes) || has_learnt;
        fixes = waiting_.erase(fixes);
    }
    forget();
    if (has_learnt) publish_values(event.time);
}

bool CalibrationStage::learn_from(const Fixes& fixes) {
    bool has_learnt = false;
    const std::int64_t time = fixes.front().time;
    // Frames that two fixes share count for half in each.
    double shared = 1;
    if (last_pair_ && *last_pair_ != time)
        shared = std::max(1.0, static_cast<double>(rule_.window) / static_cast<double>(std::abs(time - *last_pair_)));
    for (std::size_t i = 0; i < fixes.size() && pose_; ++i) {
        try {
            const Believed believed{sensor_, *pose_, biases_};
            std::optional<Pair> pair = pair_up(caller_, believed, rule_, frames_, fixes, i, shared);
            count(pair ? "pairs" : "fixes_without_partner");
            if (!pair) continue;
            biases_.update(pair->difference, pair->slope, pair->noise);
            ++pairs_;
            has_learnt = true;
        } catch (const pelorus::Failure& failure) {
            if (failure.code() != PLR_E_NUMERIC) throw;
            count("refused_fixes");
        }
    }
    if (has_learnt) {
        last_pair_ = std::max(last_pair_.value_or(time), time);
        note_observable(time);
        add_rows(time);
    }
    return has_learnt;
}

/// What is older than any late message may ask for.
void CalibrationStage::forget() {
    if (newest_frame_) {
        const std::int64_t oldest = *newest_frame_ - lateness_ns_ - rule_.window;
        while (!frames_.empty() && frames_.front().time < oldest) frames_.pop_front();
    }
    const std::int64_t newest = std::max(newest_frame_.value_or(std::numeric_limits<std::int64_t>::min()),
                                         newest_fix_.value_or(std::numeric_limits<std::int64_t>::min()));
    const std::int64_t slack = lateness_ns_ + rule_.window;
    const auto is_old = [&](std::int64_t time) { return time < newest - 2 * slack; };
    while (!waiting_.empty() && is_old(waiting_.front().front().time)) {
        count("fixes_without_partner");
        waiting_.pop_front();
    }
    while (!seen_.empty() && is_old(seen_.front().first)) seen_.pop_front();
}

void CalibrationStage::publish_scan(std::int64_t time, const plr_scan& scan) {
    plr_message message = pelorus::detail::message_of(PLR_MESSAGE_SCAN, time);
    message.body.scan = &scan;
    publish(scans_out, message);
}

void CalibrationStage::count(const char* name) const {
    if (diagnostics_ != nullptr) diagnostics_->count(diagnostics_->context, name, 1);
}

}  // namespace calibration
