#include "pointing_scheduler.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "../../common/one_track/told_record.hpp"

namespace pointing_scheduler {

namespace {

constexpr std::size_t most_pointings = 64;  ///< that are remembered until their scan comes
constexpr double quarter_turn = 1.57079632679489661923;

}  // namespace

void PointingScheduler::setup(const pelorus::Setup& setup) {
    filter_.setup(setup, "estimator");
    for (int c = 0; c < filter_.cartesian().size(); ++c)
        if (const int place = one_track::kinematic_place(filter_.cartesian()[c].name); place >= 0 && place < 3)
            positions_.push_back(c);
    find_sensor();
    find_angles();
    filter_.caller.setup(setup, static_cast<std::size_t>(filter_.scratch_bytes()) + 4096);
    if (period_ && !(*period_ < 9e9 && *period_ * 1e9 >= 1))
        throw pelorus::ParameterError("period", "is not within what a clock of nanoseconds can tell");
    key_ = setup.key();
    frame_ = setup.frame();
}

void PointingScheduler::find_sensor() {
    const auto& sensors = filter_.sensors();
    std::string names;
    for (const pelorus::SensorPart& sensor : sensors) names += (names.empty() ? "" : ", ") + sensor.name();
    if (!sensor_name_) {
        if (sensors.size() > 1)
            throw pelorus::ParameterError("sensor", "is required: the estimator has several sensors (" + names + ")");
        return;
    }
    sensor_ = filter_.sensor(*sensor_name_);
    if (sensor_ < 0) throw pelorus::ParameterError("sensor", "is " + *sensor_name_ + ", the estimator has " + names);
}

void PointingScheduler::find_angles() {
    const pelorus::SensorPart& sensor = filter_.sensors()[static_cast<std::size_t>(sensor_)];
    const pelorus::Space measured(*sensor.info().measurement);
    azimuth_ = measured.index("azimuth");
    elevation_ = measured.index("elevation");
    zenith_ = measured.index("zenith");
    if (azimuth_ < 0)
        throw pelorus::PartError("estimator", "sensor " + sensor.name() + " measures no azimuth: " + measured.text());
    if (in_plane() && field_of_view_.size() != 1)
        throw pelorus::ParameterError("field_of_view",
                                      "has two angles, but sensor " + sensor.name() + " measures azimuth alone");
    for (const double angle : field_of_view_)
        if (!(angle < 2 * quarter_turn)) throw pelorus::ParameterError("field_of_view", "is not below 180 deg");
    field_ = Field::of(field_of_view_, in_plane());
}

std::vector<pelorus::Stream> PointingScheduler::in_streams(std::uint32_t port) const {
    if (port == pointing_in) return {};
    pelorus::Stream stream;
    stream.frame = frame_;
    if (port == tracks_in) {
        stream.space = filter_.cartesian();
        return {stream};
    }
    const pelorus::SensorPart& sensor = filter_.sensors()[static_cast<std::size_t>(sensor_)];
    pelorus::Stream others = stream;
    stream.sensor = sensor.name();
    stream.space = pelorus::Space(*sensor.info().measurement);
    others.any_sensor = others.any_space = others.any_frame = true;
    return {stream, others};
}

void PointingScheduler::on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
    std::int64_t entry = entry_of_target(tracks);
    if (entry >= 0 && tracks.status[entry] == PLR_TRACK_DELETED) {
        drop_target(event.time);
        entry = -1;
    }
    if (!target_) {
        entry = chosen_entry(tracks);
        if (entry < 0) return;
        target_ = tracks.ids[entry];
        lock_.begin();
    }
    if (entry < 0) return;
    follow(tracks, entry);
    command(event.arrival, event.time);
}

/// Takes the track as it is now. What a search has looked at stays where it is in the sky.
void PointingScheduler::follow(const plr_tracks& tracks, std::int64_t entry) {
    std::optional<sensing::Direction> believed;
    if (!lock_.done.empty()) believed = predicted(tracks.times[entry]).direction;
    record_ = one_track::told_record(filter_, tracks, entry, key_);
    track_time_ = tracks.times[entry];
    if (believed) lock_.shift(sensing::offset_in_view(*believed, predicted(track_time_).direction));
}

/// The newest entry of the track that is followed, or -1.
std::int64_t PointingScheduler::entry_of_target(const plr_tracks& tracks) const {
    std::int64_t found = -1;
    for (std::int64_t i = 0; target_ && i < tracks.count; ++i)
        if (tracks.ids[i] == *target_ && (found < 0 || tracks.times[i] >= tracks.times[found])) found = i;
    return found;
}

std::int64_t PointingScheduler::chosen_entry(const plr_tracks& tracks) const {
    std::int64_t best = -1;
    double largest = 0;
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        if (tracks.status[i] == PLR_TRACK_DELETED || tracks.status[i] == PLR_TRACK_TENTATIVE) continue;
        const auto covariance = pelorus::item(tracks.covariance, i);
        double variance = 0;
        for (const int c : positions_) variance += covariance(c, c);
        const bool better =
            policy_ == Policy::worst ? variance > largest : best >= 0 && tracks.ids[i] < tracks.ids[best];
        if (best >= 0 && !better) continue;
        best = i;
        largest = variance;
    }
    return best;
}

void PointingScheduler::drop_target(std::int64_t time) {
    const State before = lock_.now;
    lock_ = Lock{};
    note_lock(before, time);
    target_.reset();
    commanded_.reset();
}

PointingScheduler::Prediction PointingScheduler::predicted(std::int64_t time) {
    Prediction out;
    out.at = {std::max(time, track_time_), *target_, key_};
    out.record = record_;
    if (out.at.time > track_time_)
        filter_.predict(out.at, static_cast<double>(out.at.time - track_time_) * 1e-9, out.record);
    out.projection = filter_.project(out.at, sensor_, out.record);
    const auto& z = out.projection.measurement;
    const auto& p = out.projection.covariance;
    out.direction.azimuth = z(azimuth_);
    const int second = elevation_ >= 0 ? elevation_ : zenith_;
    const double up = elevation_ >= 0 ? 1 : -1, own = misalignment_ * misalignment_;
    if (second >= 0) out.direction.elevation = elevation_ >= 0 ? z(elevation_) : quarter_turn - z(zenith_);
    const double across = std::cos(out.direction.elevation);
    out.spread(0, 0) = across * across * p(azimuth_, azimuth_) + own;
    if (second < 0) return out;
    out.spread(0, 1) = out.spread(1, 0) = across * up * p(azimuth_, second);
    out.spread(1, 1) = p(second, second) + own;
    return out;
}

/// Of a target that is locked nothing but the prediction: what was seen a moment ago is not searched.
std::vector<Place> PointingScheduler::pattern(const Prediction& prediction) const {
    if (lock_.now == State::locked) return {{}};
    const double step = in_plane() ? field_.width : std::min(field_.width, field_.height);
    return search_pattern(field_, prediction.spread, sigmas_, static_cast<double>(lock_.passes) * step / 2);
}

void PointingScheduler::on_values(const pelorus::Event& event, const plr_values& values) {
    const std::string name = filter_.sensors()[static_cast<std::size_t>(sensor_)].name();
    const char* at = reinterpret_cast<const char*>(values.quantities);
    for (std::uint32_t i = 0; i < values.count; ++i) {
        const auto& quantity = *reinterpret_cast<const plr_quantity*>(at);
        at += quantity.struct_size;
        if (name != quantity.address || std::strcmp(quantity.name, "pointing") != 0) continue;
        const plr_const_view& v = quantity.numbers;
        if (v.rows != (in_plane() ? 1 : 2) || v.cols != 1 || v.count < 1)
            throw pelorus::DataError("the pointing of sensor " + name + " has " + std::to_string(v.rows * v.cols) +
                                     " angles");
        const auto angles = pelorus::item(v, 0);
        seen_at_.push_back({event.time, {angles(0, 0), in_plane() ? 0.0 : angles(1, 0)}});
        if (seen_at_.size() > most_pointings) seen_at_.erase(seen_at_.begin());
    }
    // Where its frames fail to come it is kept on the target all the same.
    const std::int64_t step = this->step();
    if (target_ && (!last_look_ || event.time > *last_look_ + step + step / 2)) command(event.arrival, event.time);
}

std::optional<sensing::Direction> PointingScheduler::looked_at(std::int64_t time) const {
    const auto nearer = [time](const auto& a, const auto& b) {
        return std::llabs(a.first - time) < std::llabs(b.first - time);
    };
    const auto found = std::min_element(seen_at_.begin(), seen_at_.end(), nearer);
    if (found == seen_at_.end()) return commanded_;
    return found->second;
}

void PointingScheduler::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    if (filter_.sensor(scan.sensor) != sensor_) return;
    if (last_look_ && event.time <= *last_look_) return;  // one that comes late tells nothing of now
    if (last_look_) spacing_ = event.time - *last_look_;
    last_look_ = event.time;
    ++counts_.looks;
    if (!target_) return;
    const Prediction prediction = predicted(event.time);
    const bool hit = is_hit(prediction, scan);
    const State before = lock_.now;
    const auto looked = looked_at(event.time);
    const double close = std::min(field_.width, in_plane() ? field_.width : field_.height) / 4;
    const bool there = !commanded_ || !looked || sensing::angle_between(*looked, *commanded_) <= close;
    lock_.look(*this, hit, there);
    note_lock(before, event.time);
    counts_.locked += lock_.now == State::locked;
    note_look(event.time, prediction, hit);
    command(event.arrival, event.time);
}

bool PointingScheduler::is_hit(const Prediction& prediction, const plr_scan& scan) {
    const auto& sensor = filter_.sensors()[static_cast<std::size_t>(sensor_)];
    const Eigen::VectorXd& expected = prediction.projection.measurement;
    Eigen::VectorXd off(expected.size());
    for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
        const Eigen::VectorXd z = pelorus::item(scan.measurements, i);
        const Eigen::MatrixXd noise =
            scan.covariances.data != nullptr
                ? Eigen::MatrixXd(pelorus::item(scan.covariances, i))
                : filter_.noise_of(prediction.at, sensor_, z, pelorus::absent_view(), pelorus::absent_view());
        auto residual = pelorus::arguments<plr_sensor_residual>();
        residual.measurement = pelorus::const_view(z);
        residual.reference = pelorus::const_view(expected);
        residual.out = pelorus::view(off);
        filter_.caller.require(
            sensor.call(&plr_sensor::residual, filter_.caller.begin(prediction.at.time, 1), residual),
            "sensor " + sensor.name() + ", residual");
        using Square = pelorus::small::Bounded<one_track::Filter::most_measured, one_track::Filter::most_measured>;
        using Column = pelorus::small::Bounded<one_track::Filter::most_measured, 1>;
        Square root = prediction.projection.covariance + noise;
        if (!pelorus::small::cholesky(root, root)) continue;
        if (pelorus::small::inverse_quadratic(root, Column(off)) <= gate_ * gate_) return true;
    }
    return false;
}

/// Points at where the search is now, about where the target will be at the next look.
void PointingScheduler::command(std::int64_t arrival, std::int64_t stamp) {
    const std::int64_t step = this->step();
    std::int64_t look = std::max(stamp, arrival);
    if (step > 0) {
        const std::int64_t last = last_look_.value_or(look);
        look = last + step * ((std::max(look, last) - last) / step + 1);
    }
    const Prediction prediction = predicted(look);
    if (!lock_.choose(pattern(prediction), field_.pitch())) lock_.choose(pattern(prediction), field_.pitch());
    const sensing::Offset& place = lock_.place.at;
    commanded_ = in_plane() ? sensing::Direction{prediction.direction.azimuth + place.left, 0}
                            : sensing::direction_in_view(prediction.direction, place);
    Eigen::VectorXd angles(in_plane() ? 1 : 2);
    angles(0) = commanded_->azimuth;
    if (!in_plane()) angles(1) = commanded_->elevation;
    pelorus::ValuesBuilder told;
    told.add(filter_.sensors()[static_cast<std::size_t>(sensor_)].name(), "pointing", "rad", angles, arrival);
    publish(commands_out, told.message(stamp));
}

void PointingScheduler::note_lock(State before, std::int64_t time) {
    const double now = static_cast<double>(time) * 1e-9;
    if (before != State::locked && lock_.now == State::locked) {
        if (!counts_.first_lock) counts_.first_lock = time;
        const double number = static_cast<double>(locks_.size() / lock_columns + 1);
        locks_.insert(locks_.end(), {number, static_cast<double>(*target_), now, pelorus::not_a_number});
    }
    if (before != State::locked || lock_.now == State::locked) return;
    locks_.back() = now;
    ++counts_.losses;
}

void PointingScheduler::note_look(std::int64_t time, const Prediction& prediction, bool hit) {
    const double now = static_cast<double>(time) * 1e-9;
    if (!looks_.empty() && now < looks_[looks_.size() - look_columns] + table_period_ * (1 - 1e-12)) return;
    const auto looked = looked_at(time);
    looks_.insert(looks_.end(), {now, prediction.direction.azimuth, prediction.direction.elevation,
                                 looked ? sensing::angle_between(*looked, prediction.direction) : pelorus::not_a_number,
                                 std::sqrt(std::max(prediction.spread(0, 0), prediction.spread(1, 1))), hit ? 1.0 : 0.0,
                                 lock_.now == State::searching ? 1.0 : 0.0, lock_.now == State::locked ? 1.0 : 0.0,
                                 lock_.now == State::lost ? 1.0 : 0.0});
}

void PointingScheduler::finish(const pelorus::Event& event) {
    pelorus::ResultBuilder looks("looks");
    looks.column("time", "s", PLR_REDUCE_KEY);
    for (const char* angle : {"azimuth", "elevation", "off", "deviation"}) looks.column(angle, "rad", PLR_REDUCE_MEAN);
    for (const char* share : {"hit", "searching", "locked", "lost"}) looks.column(share, "", PLR_REDUCE_MEAN);
    for (std::size_t row = 0; row < looks_.size(); row += look_columns)
        looks.row({looks_.begin() + static_cast<std::ptrdiff_t>(row),
                   looks_.begin() + static_cast<std::ptrdiff_t>(row + look_columns)});
    const double total = static_cast<double>(counts_.looks);
    looks.scalar("looks", "", PLR_REDUCE_MEAN, total);
    looks.scalar("locked_share", "", PLR_REDUCE_MEAN,
                 counts_.looks == 0 ? pelorus::not_a_number : static_cast<double>(counts_.locked) / total);
    looks.scalar("losses", "", PLR_REDUCE_MEAN, static_cast<double>(counts_.losses));
    looks.scalar("first_lock", "s", PLR_REDUCE_MEAN,
                 counts_.first_lock ? static_cast<double>(*counts_.first_lock) * 1e-9 : pelorus::not_a_number);
    publish(results_out, looks.message(event.time));
    pelorus::ResultBuilder locks("locks");
    locks.column("lock", "", PLR_REDUCE_KEY);
    locks.column("track", "", PLR_REDUCE_MEAN);
    locks.column("from", "s", PLR_REDUCE_MEAN);
    locks.column("to", "s", PLR_REDUCE_MEAN);
    for (std::size_t row = 0; row < locks_.size(); row += lock_columns)
        locks.row({locks_.begin() + static_cast<std::ptrdiff_t>(row),
                   locks_.begin() + static_cast<std::ptrdiff_t>(row + lock_columns)});
    publish(results_out, locks.message(event.time));
}

}  // namespace pointing_scheduler
