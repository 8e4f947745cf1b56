#include "calibration_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace calibration {

namespace {

constexpr std::size_t most_times = 256;  ///< of the table `biases`

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

plr_message scan_message(std::int64_t time, const plr_scan& scan) {
    plr_message message{};
    message.struct_size = sizeof message;
    message.kind = PLR_MESSAGE_SCAN;
    message.time = time;
    message.arrival = std::numeric_limits<std::int64_t>::min();
    message.body.scan = &scan;
    return message;
}

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

/// The shortest x with slope x = e, damped where the rows of the slope are not independent.
Eigen::Vector3d shortest(const Eigen::MatrixXd& slope, const Eigen::VectorXd& e) {
    Eigen::MatrixXd square = slope * slope.transpose();
    square.diagonal().array() += 1e-12 * square.trace();
    const Eigen::LLT<Eigen::MatrixXd> factor(square);
    if (factor.info() != Eigen::Success) throw pelorus::NumericError("a line of sight is not finite");
    return slope.transpose() * factor.solve(e);
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
    publish(scans_out, scan_message(event.time, scan));
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
    publish(scans_out, scan_message(event.time, scan));
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

// ---------------------------------------------------------------------------------------------------------- correction

Estimate CalibrationStage::applied_to(Corrected what) const {
    Estimate out = biases_.estimate();
    BiasVector mask = BiasVector::Zero();  // tracks are moved as a whole; ranges and stamps are the measurements' own
    if (what == Corrected::tracks || corrected_ == Corrected::scans) mask.head<6>().setOnes();
    if (what == Corrected::scans) mask.tail<2>().setOnes();
    out.value = out.value.cwiseProduct(mask);
    out.covariance = mask.asDiagonal() * out.covariance * mask.asDiagonal();
    if (mode_ == Mode::schmidt) {
        out.covariance += out.value * out.value.transpose();
        out.value.setZero();
    } else if (spread_ == Spread::kept) {
        out.covariance.setZero();
    }
    return out;
}

void CalibrationStage::publish_corrected(const pelorus::Event& event, const plr_scan& scan, const Frame& frame) {
    const Estimate estimate = applied_to(Corrected::scans);
    const bool widens = !estimate.covariance.isZero(0);
    if (frame.samples.empty() || last_fixes_.empty() || !pose_ || (estimate.value.isZero(0) && !widens))
        return publish(scans_out, scan_message(event.time, scan));
    const std::int64_t n = scan.measurements.count, m = scan.measurements.rows;
    const std::int64_t early = nanoseconds(estimate.value(clock_offset));
    std::vector<double> values, covariances;
    std::vector<std::int64_t> times;
    for (std::int64_t i = 0; i < n; ++i) {
        const Sample& sample = frame.samples[static_cast<std::size_t>(i)];
        Eigen::VectorXd value = sample.value;
        Eigen::MatrixXd noise = sample.variances.asDiagonal();
        if (scan.covariances.data != nullptr) noise = pelorus::item(scan.covariances, i);
        if (!correct(sample, estimate, value, noise)) count("uncorrected");
        values.insert(values.end(), value.data(), value.data() + m);
        covariances.insert(covariances.end(), noise.data(), noise.data() + m * m);
        times.push_back(sample.time - early);
    }
    plr_scan corrected = scan;
    corrected.struct_size = sizeof corrected;
    corrected.measurements = pelorus::const_view(values.data(), m, 1, n);
    if (widens) corrected.covariances = pelorus::const_view(covariances.data(), m, m, n);
    if (scan.times != nullptr) corrected.times = times.data();
    publish(scans_out, scan_message(event.time - early, corrected));
}

/// Of the newest fixes the one that lies nearest the line of sight.
Eigen::Vector3d CalibrationStage::place_of(const Sample& sample) {
    const Fix* best = &last_fixes_.front();
    if (last_fixes_.size() == 1) return best->position;
    double least = std::numeric_limits<double>::infinity();
    for (const Fix& fix : last_fixes_) {
        const Eigen::VectorXd expected = sensor_.biased(caller_, fix.position, *pose_, biases_.mean());
        const Eigen::VectorXd e = sensor_.residual(caller_, sample.value, expected);
        const double squared = (e.array().square() / sample.variances.array()).sum();
        if (!(squared < least)) continue;
        least = squared;
        best = &fix;
    }
    return best->position;
}

/// Finds a place where the biased sensor would measure just this, as near as possible to a fix, and asks what it would have
/// measured there without its biases.
bool CalibrationStage::correct(const Sample& sample, const Estimate& estimate, Eigen::VectorXd& value,
                               Eigen::MatrixXd& noise) {
    try {
        Eigen::Vector3d place = place_of(sample);
        const Eigen::VectorXd weights = sample.variances.cwiseSqrt().cwiseInverse();
        for (int pass = 0; pass < 3; ++pass) {
            const Eigen::VectorXd e =
                sensor_.residual(caller_, sample.value, sensor_.biased(caller_, place, *pose_, estimate.value));
            const Eigen::MatrixXd slope =
                weights.asDiagonal() * sensor_.biased_jacobian(caller_, place, *pose_, estimate.value);
            place += shortest(slope, weights.cwiseProduct(e));
        }
        Eigen::VectorXd corrected = sample.value;
        if (!estimate.value.isZero(0)) {
            const Eigen::VectorXd without = sensor_.biased(caller_, place, *pose_, BiasVector::Zero()),
                                  with = sensor_.biased(caller_, place, *pose_, estimate.value);
            corrected += sensor_.residual(caller_, without, with);
            corrected = sensor_.residual(caller_, corrected, Eigen::VectorXd::Zero(corrected.size()));  // wraps angles
        }
        const BiasSlope over = sensor_.bias_slope(caller_, place, *pose_, estimate.value);
        const Eigen::MatrixXd widened = noise + over * estimate.covariance * over.transpose();
        if (!corrected.allFinite() || !widened.allFinite()) return false;
        value = corrected;
        noise = widened;
        return true;
    } catch (const pelorus::Failure& failure) {
        if (failure.code() != PLR_E_NUMERIC) throw;
        return false;
    }
}

void CalibrationStage::on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
    plr_message message{};
    message.struct_size = sizeof message;
    message.kind = PLR_MESSAGE_TRACKS;
    message.time = event.time;
    message.arrival = std::numeric_limits<std::int64_t>::min();
    message.body.tracks = &tracks;
    const Estimate estimate = applied_to(Corrected::tracks);
    const bool is_right = estimate.value.isZero(0) && estimate.covariance.isZero(0);
    if (corrected_ != Corrected::tracks || !pose_ || is_right || tracks.count == 0) return publish(tracks_out, message);

    const TrackCorrection correction{pelorus::Space(*tracks.space)};
    std::vector<double> means, covariances, extents;
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        Eigen::VectorXd mean = pelorus::item(tracks.mean, i);
        Eigen::MatrixXd covariance = pelorus::item(tracks.covariance, i);
        correction(*pose_, estimate, mean, covariance);
        means.insert(means.end(), mean.data(), mean.data() + mean.size());
        covariances.insert(covariances.end(), covariance.data(), covariance.data() + covariance.size());
        if (tracks.extent.data == nullptr) continue;
        const Eigen::MatrixXd extent = pelorus::item(tracks.extent, i);
        const Eigen::MatrixXd turn =
            TrackCorrection::turn(*pose_, estimate.value).topLeftCorner(extent.rows(), extent.cols());
        const Eigen::MatrixXd turned = turn * extent * turn.transpose();
        extents.insert(extents.end(), turned.data(), turned.data() + turned.size());
    }
    plr_tracks moved = tracks;
    moved.struct_size = sizeof moved;
    moved.mean = pelorus::const_view(means.data(), tracks.mean.rows, 1, tracks.count);
    moved.covariance = pelorus::const_view(covariances.data(), tracks.mean.rows, tracks.mean.rows, tracks.count);
    if (!extents.empty())
        moved.extent = pelorus::const_view(extents.data(), tracks.extent.rows, tracks.extent.cols, tracks.count);
    moved.records = pelorus::absent_view();  // they are of the world as the sensor sees it
    moved.record_of = nullptr;
    message.body.tracks = &moved;
    publish(tracks_out, message);
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

// ----------------------------------------------------------------------------------------------------------- telling

void CalibrationStage::publish_values(std::int64_t time) {
    pelorus::ValuesBuilder values;
    const BiasVector& b = biases_.estimate().value;
    const auto is_active = [&](int first, int last) {
        return std::any_of(biases_.active().begin(), biases_.active().end(),
                           [&](int bias) { return bias >= first && bias <= last; });
    };
    const std::string prefix = sensor_.name() + ".";
    const bool is_plane = sensor_.dimension() == 2;
    if (is_active(range_bias, range_bias)) {
        Eigen::VectorXd addends = Eigen::VectorXd::Zero(sensor_.space().size());
        addends(sensor_.space().index("range")) = b(range_bias);
        values.add("", prefix + "bias", bias_units_, addends);
    }
    if (is_active(roll, yaw))
        values.add("", prefix + "attitude_error", "rad",
                   Eigen::VectorXd(is_plane ? b.segment(yaw, 1) : b.segment(roll, 3)));
    if (is_active(offset_x, offset_z))
        values.add("", prefix + "platform_position", "m", Eigen::VectorXd(b.segment(offset_x, is_plane ? 2 : 3)));
    if (is_active(clock_offset, clock_offset)) values.add("", prefix + "clock_offset", "s", b.segment<1>(clock_offset));
    publish(values_out, values.message(time));
}

CalibrationStage::Row CalibrationStage::row_at(std::int64_t time) const {
    const Estimate& estimate = biases_.estimate();
    Row row{time, estimate.value, estimate.covariance.diagonal().cwiseMax(0.0).cwiseSqrt(), estimate.presence,
            BiasVector::Zero()};
    for (const int bias : biases_.active()) row.observable(bias) = is_observable(bias) ? 1 : 0;
    return row;
}

void CalibrationStage::note_observable(std::int64_t time) {
    for (const int bias : biases_.active())
        if (is_observable(bias) && std::isnan(observable_since_(bias)))
            observable_since_(bias) = static_cast<double>(time) * 1e-9;
}

/// At whole multiples of the spacing, so that the rows of several runs meet.
void CalibrationStage::add_rows(std::int64_t time) {
    if (time < next_row_) return;
    const std::int64_t multiple = time / row_spacing_ * row_spacing_;
    rows_.push_back(row_at(multiple));
    next_row_ = multiple + row_spacing_;
    if (rows_.size() < most_times) return;
    row_spacing_ *= 2;
    rows_.erase(
        std::remove_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.time % row_spacing_ != 0; }),
        rows_.end());
    next_row_ = (next_row_ + row_spacing_ - 1) / row_spacing_ * row_spacing_;
}

void CalibrationStage::publish_directions(std::int64_t time) {
    pelorus::ResultBuilder result("directions");
    result.column("rank", "", PLR_REDUCE_KEY);
    result.column("ratio", "", PLR_REDUCE_MEAN);
    for (const int bias : biases_.active())
        result.column(bias_names[static_cast<std::size_t>(bias)].name, "", PLR_REDUCE_MEAN);
    double rank = 0;
    for (const Direction& direction : biases_.directions()) {
        std::vector<double> row{++rank, direction.ratio};
        for (const int bias : biases_.active()) row.push_back(direction.share(bias));
        result.row(row);
    }
    publish(biases_out, result.message(time));
}

void CalibrationStage::finish(const pelorus::Event& event) {
    pelorus::ResultBuilder result("biases");
    std::vector<std::string> names;
    for (const int bias : biases_.active()) names.emplace_back(bias_names[static_cast<std::size_t>(bias)].name);
    if (names.empty()) return;
    result.column("time", "s", PLR_REDUCE_KEY);
    result.text_column("bias", PLR_REDUCE_KEY, names);
    result.column("value", "", PLR_REDUCE_MEAN);
    result.column("deviation", "", PLR_REDUCE_ROOT_MEAN_SQUARE);
    result.column("presence", "", PLR_REDUCE_MEAN);
    result.column("observable", "", PLR_REDUCE_MEAN);
    for (const Row& row : rows_)
        for (std::size_t k = 0; k < names.size(); ++k) {
            const int bias = biases_.active()[k];
            result.row({static_cast<double>(row.time) * 1e-9, static_cast<double>(k), row.value(bias),
                        row.deviation(bias), row.presence(bias), row.observable(bias)});
        }
    const Row last = row_at(event.time);
    for (std::size_t k = 0; k < names.size(); ++k) {
        const int bias = biases_.active()[k];
        const char* const unit = bias_names[static_cast<std::size_t>(bias)].unit;
        result.scalar(names[k], unit, PLR_REDUCE_MEAN, last.value(bias));
        result.scalar(names[k] + "_deviation", unit, PLR_REDUCE_ROOT_MEAN_SQUARE, last.deviation(bias));
        result.scalar(names[k] + "_observable", "", PLR_REDUCE_MEAN, last.observable(bias));
        result.scalar(names[k] + "_observable_since", "s", PLR_REDUCE_MEAN, observable_since_(bias));
    }
    publish(biases_out, result.message(event.time));
    publish_directions(event.time);
    if (pairs_ == 0 && log_ != nullptr && PLR_LOG_WARNING >= log_->level)
        log_->write(log_->context, PLR_LOG_WARNING,
                    ("nothing was learnt of sensor " + sensor_.name() + ": no fix of " + reference_.name() +
                     " has three frames around it within `window`")
                        .c_str());
}

void CalibrationStage::count(const char* name) const {
    if (diagnostics_ != nullptr) diagnostics_->count(diagnostics_->context, name, 1);
}

}  // namespace calibration
