#include "single_target_tracker.hpp"

#include <algorithm>

namespace single_target {

namespace {

constexpr double nanosecond = 1e-9;

}  // namespace

void SingleTargetTracker::setup(const pelorus::Setup& setup) {
    filter_.setup(setup, "estimator");
    filter_.caller.setup(setup, static_cast<std::size_t>(filter_.scratch_bytes()) + 4096);
    check_start();
    estimator_id_ = filter_.estimator().id();
    const bool draws = (filter_.estimator().info().flags & PLR_FLAG_USES_KEYS) != 0;
    if (draws || start_ == Start::drawn) random_ = &setup.service<plr_random>();
    key_ = setup.key();
    frame_ = setup.frame();
    message_ = std::make_unique<pelorus::TracksBuilder>(frame_, filter_.cartesian());
    diagnostics_ = setup.optional_service<plr_diagnostics>();
    log_ = setup.optional_service<plr_log>();
}

std::vector<pelorus::Stream> SingleTargetTracker::in_streams(std::uint32_t port) const {
    std::vector<pelorus::Stream> streams;
    if (port == truth_in) {
        pelorus::Stream stream;
        stream.any_space = true;
        stream.frame = frame_;
        return {stream};
    }
    if (port != scans_in) return streams;
    for (const pelorus::SensorPart& sensor : filter_.sensors()) {
        pelorus::Stream stream;
        stream.sensor = sensor.name();
        stream.any_sensor = sensor.name().empty() && filter_.sensors().size() == 1;
        stream.space = pelorus::Space(*sensor.info().measurement);
        stream.frame = frame_;
        streams.push_back(std::move(stream));
    }
    return streams;
}

std::vector<pelorus::Stream> SingleTargetTracker::out_streams(std::uint32_t port) const {
    if (port != tracks_out) return {};
    pelorus::Stream stream;
    stream.space = filter_.cartesian();
    stream.frame = frame_;
    return {stream};
}

void SingleTargetTracker::on_values(const pelorus::Event&, const plr_values& values) {
    if (filter_.caller.take(values) == 0) throw pelorus::DataError("holds no input of the models in this tracker");
}

/// Only what starts a track is ever looked at: the truth is forgotten with the start, and later ones are not read.
void SingleTargetTracker::on_truth(const pelorus::Event&, const plr_truth& truth) {
    if (start_ != Start::drawn || started_ || truth.count == 0) return;
    std::int64_t first = 0;
    for (std::int64_t i = 1; i < truth.count; ++i)
        if (truth.ids[i] < truth.ids[first]) first = i;
    TrueStart start{truth.times[first], unknown_kinematics()};
    const pelorus::Space space(*truth.space);
    for (int c = 0; c < space.size(); ++c)
        if (const int place = one_track::kinematic_place(space[c].name); place >= 0)
            start.kinematics[static_cast<std::size_t>(place)] =
                truth.state.data[first * truth.state.item_stride + c * truth.state.row_stride];
    truth_ = start;
}

void SingleTargetTracker::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    read(event, scan);
    ++step_;
    message_->clear();
    innovations_.clear();
    used_.clear();
    distances_.clear();
    const bool had_none = !track_;
    if (!started_) start_known(event.time);
    begun_ = had_none && track_;
    try {
        for (const Measurement& measurement : measurements_) {
            if (track_ && !(anew_ && filter_.inverts(sensor_)))
                follow(measurement, scan);
            else if (start_ == Start::measurement)
                start_from(measurement, scan);
        }
        settle(event.time);
    } catch (const pelorus::Failure& failure) {
        if (failure.code() != PLR_E_NUMERIC || !track_) throw;
        give_up(failure);
    }
    if (message_->count() > 0) {
        plr_message message = message_->message(event.time);
        plr_tracks body = *message.body.tracks;
        if (records_ && track_) {
            body.records =
                pelorus::const_view(track_->record.data(), static_cast<std::int64_t>(filter_.record_size()), 1, 1);
            body.record_of = estimator_id_.c_str();
            body.record_version = filter_.record_version();
        }
        message.body.tracks = &body;
        publish(tracks_out, message);
    }
    if (innovations_.count() > 0) publish(innovations_out, innovations_.message(event.time));
    if (track_ && maximum_misses_ && track_->misses >= *maximum_misses_) track_.reset();
}

/// Takes the measurements apart, in the order of their times.
void SingleTargetTracker::read(const pelorus::Event& event, const plr_scan& scan) {
    sensor_ = filter_.sensor(scan.sensor);
    if (sensor_ < 0)
        throw pelorus::DataError("a scan of sensor " + std::string(scan.sensor) +
                                 " came, which the estimator does not hold");
    measurements_.clear();
    const std::int64_t n = scan.measurements.count;
    const auto m =
        static_cast<std::int64_t>(filter_.sensors()[static_cast<std::size_t>(sensor_)].info().measurement->size);
    if (n > 0 && scan.measurements.rows != m)
        throw pelorus::DataError("a measurement has " + std::to_string(scan.measurements.rows) +
                                 " components, sensor " + std::string(scan.sensor) + " has " + std::to_string(m));
    for (std::int64_t i = 0; i < n; ++i) {
        Measurement one;
        one.id = scan.ids[i];
        one.time = scan.times == nullptr ? event.time : scan.times[i];
        one.value = pelorus::item(scan.measurements, i);
        if (scan.covariances.data != nullptr) one.noise = pelorus::item(scan.covariances, i);
        if (scan.snr.data != nullptr) one.snr = scan.snr.data[i * scan.snr.item_stride];
        measurements_.push_back(std::move(one));
    }
    std::stable_sort(measurements_.begin(), measurements_.end(),
                     [](const Measurement& a, const Measurement& b) { return a.time < b.time; });
}

// --------------------------------------------------------------------------------------------------------------- start

void SingleTargetTracker::start_known(std::int64_t time) {
    if (start_ == Start::given) begin_track(time, known_kinematics(filter_.cartesian(), given_start(), *start_sd_));
    if (start_ != Start::drawn || !truth_ || truth_->time != time) return;
    Kinematics mean = truth_->kinematics;
    truth_.reset();
    // Numbered by name: a filter that lacks a component leaves the errors of the others what they are.
    std::array<double, 9> unit{};
    random_->normal(random_->derive(key_, PLR_STREAM_START, 0, 0), 0, static_cast<std::int64_t>(unit.size()),
                    unit.data());
    for (std::size_t k = 0; k < unit.size(); ++k) mean[k] += (*start_sd_)[k / 3] * unit[k];
    begin_track(time, known_kinematics(filter_.cartesian(), mean, *start_sd_));
}

Kinematics SingleTargetTracker::given_start() const {
    Kinematics out = unknown_kinematics();
    const std::optional<std::vector<double>>* const given[] = {&start_position_, &start_velocity_,
                                                               &start_acceleration_};
    for (std::size_t d = 0; d < 3; ++d)
        if (*given[d])
            std::copy((*given[d])->begin(), (*given[d])->end(), out.begin() + static_cast<std::ptrdiff_t>(3 * d));
    return out;
}

void SingleTargetTracker::start_from(const Measurement& measurement, const plr_scan& scan) {
    if (!filter_.inverts(sensor_)) return;
    try {
        const one_track::At now = at(measurement.time, next_id_);
        const plr_const_view snr =
            measurement.snr ? pelorus::const_view(&*measurement.snr, 1, 1, 1) : pelorus::absent_view();
        const Eigen::MatrixXd noise = measurement.noise
                                          ? *measurement.noise
                                          : filter_.noise_of(now, sensor_, measurement.value, snr, scan.waveform);
        const pelorus::Space inverse(*filter_.sensors()[static_cast<std::size_t>(sensor_)].info().inverse);
        const Known known =
            known_of_inverse(filter_.cartesian(), inverse, filter_.invert(now, sensor_, measurement.value, noise));
        if (known.components.empty()) return;
        begin_track(measurement.time, known);
        used_.push_back(measurement.id);
        distances_.push_back(0);
    } catch (const pelorus::Failure& failure) {
        if (failure.code() != PLR_E_NUMERIC) throw;
        count("refused_measurements");
    }
}

void SingleTargetTracker::begin_track(std::int64_t time, const Known& known) {
    Track track;
    track.id = track_ ? track_->id : next_id_;  // begun anew it is the same one
    track.time = time;
    track.record = filter_.init(at(time, track.id), known.components, known.moments);
    started_ = true;
    if (!track_) {
        ++next_id_;
        count("tracks_started");
    }
    track_ = std::move(track);
}

// ---------------------------------------------------------------------------------------------------------------- life

void SingleTargetTracker::move(Track& track, std::int64_t time) {
    if (time == track.time) return;
    filter_.predict(at(time, track.id), static_cast<double>(time - track.time) * nanosecond, track.record);
    track.time = time;
}

void SingleTargetTracker::follow(const Measurement& measurement, const plr_scan& scan) {
    if (measurement.time < track_->time) return follow_late(measurement, scan);
    move(*track_, measurement.time);
    use(measurement, scan, *track_);
}

/// A measurement that is older than the record: of use only to an estimator that knows what it did since.
void SingleTargetTracker::follow_late(const Measurement& measurement, const plr_scan& scan) {
    if ((filter_.estimator().info().flags & PLR_ESTIMATOR_OUT_OF_SEQUENCE) == 0) {
        count("late_measurements");
        return warn_once(told_late_, "a measurement is older than the track, and " + estimator_id_ +
                                         " takes none that come late: it is left out (the first one; all are counted)");
    }
    Track back = *track_;
    try {
        move(back, measurement.time);
    } catch (const pelorus::Failure& failure) {
        if (failure.code() != PLR_E_NUMERIC) throw;
        count("late_measurements");
        return warn_once(told_late_, std::string("a late measurement is left out (the first one; all are counted): ") +
                                         failure.what());
    }
    use(measurement, scan, back);
    move(back, track_->time);
    track_ = std::move(back);
    count("late_measurements_used");
}

/// One update. A measurement that the estimator cannot take is as if it had not come.
void SingleTargetTracker::use(const Measurement& measurement, const plr_scan& scan, Track& track) {
    try {
        const one_track::At now = at(measurement.time, track.id);
        Eigen::MatrixXd noise;
        if (measurement.noise) {
            noise = *measurement.noise;
        } else {
            const plr_const_view snr =
                measurement.snr ? pelorus::const_view(&*measurement.snr, 1, 1, 1) : pelorus::absent_view();
            noise = filter_.noise(now, sensor_, filter_.summary(now, track.record).mean, snr, scan.waveform);
        }
        const double squared = filter_.update(now, sensor_, measurement.value, noise, track.record);
        innovations_.add(track.id, squared, static_cast<int>(measurement.value.size()));
        used_.push_back(measurement.id);
        distances_.push_back(squared);
    } catch (const pelorus::Failure& failure) {
        if (failure.code() != PLR_E_NUMERIC) throw;
        count("refused_measurements");
        warn_once(told_failure_,
                  std::string("a measurement is left out (the first one; all are counted): ") + failure.what());
    }
}

/// Brings the track to the scan's time, counts the miss, and tells it.
void SingleTargetTracker::settle(std::int64_t time) {
    if (!track_) return;
    const bool late = time < track_->time;
    if (!late) move(*track_, time);
    if (!used_.empty())
        track_->misses = 0;
    else if (!late && !begun_)
        ++track_->misses;
    const bool ended = maximum_misses_ && track_->misses >= *maximum_misses_;
    tell(track_->time, ended                ? std::int32_t{PLR_TRACK_DELETED}
                       : track_->misses > 0 ? std::int32_t{PLR_TRACK_COASTING}
                                            : std::int32_t{PLR_TRACK_CONFIRMED});
}

void SingleTargetTracker::tell(std::int64_t time, std::int32_t status) {
    const one_track::Moments moments = filter_.summary(at(time, track_->id), track_->record);
    pelorus::TrackEntry entry;
    entry.id = track_->id;
    entry.time = time;
    entry.status = status;
    entry.misses = track_->misses;
    entry.mean = moments.mean.data();
    entry.covariance = moments.covariance.data();
    entry.measurements = used_;
    entry.distances = distances_;
    message_->add(entry);
}

void SingleTargetTracker::give_up(const pelorus::Failure& failure) {
    warn("track " + std::to_string(track_->id) + " is given up: " + failure.what());
    count("tracks_failed");
    used_.clear();
    distances_.clear();
    message_->clear();
    tell(track_->time, PLR_TRACK_DELETED);
    if (maximum_misses_) track_->misses = static_cast<std::int32_t>(*maximum_misses_);
    track_.reset();
}

void SingleTargetTracker::finish(const pelorus::Event&) {
    if (started_) return;
    if (start_ == Start::drawn)
        warn("no track was started: no scan had a truth of its time; is port truth connected?");
    else
        warn("no track was started: no measurement came that tells a position");
}

one_track::At SingleTargetTracker::at(std::int64_t time, std::uint64_t id) const {
    one_track::At out{time, id, key_};
    if (random_ != nullptr) out.key = random_->derive(key_, PLR_STREAM_PARTICLES, step_, id);
    return out;
}

void SingleTargetTracker::count(const char* name) const {
    if (diagnostics_ != nullptr) diagnostics_->count(diagnostics_->context, name, 1);
}

void SingleTargetTracker::warn(const std::string& line) const {
    if (log_ != nullptr && PLR_LOG_WARNING >= log_->level) log_->write(log_->context, PLR_LOG_WARNING, line.c_str());
}

void SingleTargetTracker::warn_once(bool& told, const std::string& line) const {
    if (!told) warn(line);
    told = true;
}

void SingleTargetTracker::check_state(std::uint64_t size, std::uint32_t layout) const {
    if (size != filter_.record_size() || layout != filter_.record_version())
        throw pelorus::Failure(PLR_E_STATE_VERSION, "the saved track has a record of another estimator (version " +
                                                        std::to_string(layout) + ", this one has " +
                                                        std::to_string(filter_.record_version()) + ")");
    if (track_ && track_->record.size() != filter_.record_size())
        throw pelorus::DataError("the saved record is of another size");
}

}  // namespace single_target
