#include "waveform_scheduler.hpp"

#include <cmath>

#include "../../common/one_track/told_record.hpp"

namespace waveform_scheduler {

void WaveformScheduler::describe(pelorus::Describe<WaveformScheduler>& plugin) {
    plugin.title("Waveforms for a track")
        .purpose(
            "Predicts a track to a sensor's next look, asks a waveform model which waveform suits that prediction, and "
            "commands it to the sensor. With the command fed back to a simulation, the loop of source, tracker and "
            "scheduler is closed.")
        .equation(
            "x-, P- of the look; H P- H', P- H' from the estimator; R0 = the sensor's noise there with its base "
            "waveform; waveform = choose(x-, P-, H P- H', P- H', R0)")
        .source(
            "D. J. Kershaw, R. J. Evans, Optimal waveform selection for tracking systems, IEEE Transactions on "
            "Information Theory 40(5), 1536-1550, 1994");
    plugin.slot("estimator", "estimator", 1, 1, "the tracker's estimator again, written like: tracker.estimator");
    plugin.slot("waveform", "waveform", 1, 1, "what chooses; like the model in the sensor's own slot `waveform`");
    plugin.parameter("sensor", &WaveformScheduler::sensor_name_)
        .doc("the sensor that is commanded; absent: the estimator's only one");
    plugin.parameter("period", &WaveformScheduler::period_)
        .unit("s")
        .above(0)
        .doc("from a look to the next; absent: as long as between the last two, so that the first two have no command");
    plugin.parameter("track", &WaveformScheduler::policy_)
        .initially("worst")
        .choices({{"worst", "that of the largest variance of position"}, {"first", "that of the lowest id"}})
        .doc("whose prediction counts where there are several tracks");
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "what there is to look at, with the estimator's records");
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "the sensor's looks, for their rhythm; absent: the tracks' times tell it",
                   PLR_PORT_OPTIONAL | PLR_PORT_MANY);
    plugin.out_port("commands", PLR_MESSAGE_VALUES, "`waveform`, addressed to the sensor, for its next look");
    plugin.out_port("choices", PLR_MESSAGE_TABLE, "table `choices`: time of the look, waveform, criterion");
}

void WaveformScheduler::setup(const pelorus::Setup& setup) {
    filter_.setup(setup, "estimator");
    for (int c = 0; c < filter_.cartesian().size(); ++c)
        if (const int place = one_track::kinematic_place(filter_.cartesian()[c].name); place >= 0 && place < 3)
            positions_.push_back(c);
    waveform_ = setup.part<pelorus::WaveformPart>("waveform");
    find_sensor();
    check_waveform();
    const pelorus::Space commanded(*waveform_.info().waveform);
    for (const auto& component : commanded.components()) unit_ += (unit_.empty() ? "" : ", ") + component.unit;
    filter_.caller.setup(
        setup, static_cast<std::size_t>(std::max(filter_.scratch_bytes(), waveform_.info().scratch_bytes)) + 4096);
    if (period_ && !(*period_ < 9e9 && *period_ * 1e9 >= 1))
        throw pelorus::ParameterError("period", "is not within what a clock of nanoseconds can tell");
    random_ = setup.optional_service<plr_random>();
    key_ = setup.key();
    frame_ = setup.frame();
}

void WaveformScheduler::find_sensor() {
    const auto& sensors = filter_.sensors();
    std::string names;
    for (const pelorus::SensorPart& sensor : sensors) names += (names.empty() ? "" : ", ") + sensor.name();
    if (!sensor_name_) {
        if (sensors.size() > 1)
            throw pelorus::ParameterError("sensor", "is required: the estimator has several sensors (" + names + ")");
        sensor_ = 0;
        return;
    }
    sensor_ = filter_.sensor(*sensor_name_);
    if (sensor_ < 0) throw pelorus::ParameterError("sensor", "is " + *sensor_name_ + ", the estimator has " + names);
}

/// The model shapes what the sensor measures, and the sensor obeys what the model commands.
void WaveformScheduler::check_waveform() const {
    const pelorus::SensorPart& sensor = filter_.sensors()[static_cast<std::size_t>(sensor_)];
    const pelorus::Space measured(*sensor.info().measurement), shaped(*waveform_.info().measurement);
    if (!measured.same(shaped))
        throw pelorus::PartError(
            "waveform", "shapes " + shaped.text() + ", sensor " + sensor.name() + " measures " + measured.text());
    const pelorus::Space commanded(*waveform_.info().waveform);
    if (sensor.info().waveform == nullptr)
        throw pelorus::PartError("estimator", "sensor " + sensor.name() +
                                                  " takes no waveform; fill its slot `waveform` with the same model");
    const pelorus::Space taken(*sensor.info().waveform);
    if (!taken.same(commanded))
        throw pelorus::PartError("waveform", "commands " + commanded.text() + ", sensor " + sensor.name() + " takes " +
                                                 taken.text() + "; both must hold the same model");
}

std::vector<pelorus::Stream> WaveformScheduler::in_streams(std::uint32_t port) const {
    pelorus::Stream stream;
    stream.frame = frame_;
    if (port == tracks_in) {
        stream.space = filter_.cartesian();
        return {stream};
    }
    const pelorus::SensorPart& sensor = filter_.sensors()[static_cast<std::size_t>(sensor_)];
    stream.sensor = sensor.name();
    stream.any_sensor = true;  // those of other sensors are passed over
    stream.any_space = true;
    return {stream};
}

void WaveformScheduler::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    if (filter_.sensor(scan.sensor) != sensor_) return;
    looks_by_scans_ = true;
    see_look(event.time);
}

void WaveformScheduler::see_look(std::int64_t time) {
    if (last_look_ && time <= *last_look_) return;
    if (last_look_) spacing_ = time - *last_look_;
    last_look_ = time;
}

void WaveformScheduler::on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
    if (!looks_by_scans_) see_look(event.time);
    const std::int64_t entry = chosen_track(tracks);
    if (entry < 0) return;
    const std::int64_t step = period_ ? std::llround(*period_ * 1e9) : spacing_.value_or(0);
    if (step == 0) return;
    const std::int64_t from = tracks.times[entry], look = event.time + step;
    one_track::At now{look, tracks.ids[entry], key_};
    if (random_ != nullptr) now.key = random_->derive(key_, PLR_STREAM_PARTICLES, choices_.size(), now.id);
    one_track::Record record = one_track::told_record(filter_, tracks, entry, key_);
    if (look > from) filter_.predict(now, static_cast<double>(look - from) * 1e-9, record);
    const Eigen::VectorXd chosen = choose(step, now, std::move(record));
    choices_.push_back(static_cast<double>(look) * 1e-9);
    choices_.insert(choices_.end(), chosen.data(), chosen.data() + chosen.size());
    publish_command(event.time, look, step, chosen.head(static_cast<Eigen::Index>(width())));
}

std::int64_t WaveformScheduler::chosen_track(const plr_tracks& tracks) const {
    std::int64_t best = -1;
    double largest = 0;
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        if (tracks.status[i] == PLR_TRACK_DELETED) continue;
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

Eigen::VectorXd WaveformScheduler::choose(std::int64_t step, one_track::At now, one_track::Record record) {
    const plr_waveform_info& model = waveform_.info();
    const Eigen::Index h = model.horizon, c = filter_.cartesian().size(),
                       m = static_cast<Eigen::Index>(model.measurement->size);
    const double dt = static_cast<double>(step) * 1e-9;
    const Eigen::VectorXd steps = Eigen::VectorXd::Constant(h, dt);
    Eigen::MatrixXd mean(c, h), covariance(c, c * h), projected(m, m * h), cross(c, m * h), base(m, m), noise(m, m);
    for (Eigen::Index j = 0; j < h; ++j) {
        if (j > 0) {
            now.time += step;
            filter_.predict(now, dt, record);
        }
        const one_track::Moments moments = filter_.summary(now, record);
        const one_track::Projection seen = filter_.project(now, sensor_, record);
        mean.col(j) = moments.mean;
        covariance.middleCols(j * c, c) = moments.covariance;
        projected.middleCols(j * m, m) = seen.covariance;
        cross.middleCols(j * m, m) = seen.cross;
        if (j == 0) base = filter_.noise(now, sensor_, moments.mean);
    }
    const auto w = static_cast<std::int64_t>(width());
    Eigen::VectorXd chosen(w + 1);
    auto args = pelorus::arguments<plr_waveform_choose>();
    args.mean = pelorus::const_view(mean);
    args.covariance = pelorus::const_view(covariance);
    args.projected = pelorus::const_view(projected);
    args.cross = pelorus::const_view(cross);
    args.base_noise = pelorus::const_view(base);
    args.waveform = pelorus::view(chosen.data(), w, 1, 1);
    args.noise = pelorus::view(noise);
    args.criterion = pelorus::view(chosen.data() + w, 1, 1, 1);
    args.dt = pelorus::const_view(steps);
    args.cartesian = filter_.cartesian().c();
    const plr_call& call = filter_.caller.begin(now.time, 1, &now.id, &now.key);
    filter_.caller.require(waveform_.call(&plr_waveform::choose, call, args), "waveform, choose");
    return chosen;
}

/// In force from half a step before the look to half a step after it: for the next look, and for no other.
void WaveformScheduler::publish_command(std::int64_t time, std::int64_t look, std::int64_t step,
                                        const Eigen::VectorXd& waveform) {
    pelorus::ValuesBuilder command;
    const std::int64_t margin = std::max<std::int64_t>(step / 2 - 1, 0);
    command.add(filter_.sensors()[static_cast<std::size_t>(sensor_)].name(), "waveform", unit_, waveform, look - margin,
                look + margin);
    publish(commands_out, command.message(time));
}

void WaveformScheduler::finish(const pelorus::Event& event) {
    pelorus::ResultBuilder result("choices");
    result.column("time", "s", PLR_REDUCE_KEY);
    const pelorus::Space space(*waveform_.info().waveform);
    for (const auto& component : space.components()) result.column(component.name, component.unit, PLR_REDUCE_MEAN);
    result.column("criterion", "", PLR_REDUCE_MEAN);
    for (auto row = choices_.begin(); row != choices_.end(); row += static_cast<std::ptrdiff_t>(columns()))
        result.row({row, row + static_cast<std::ptrdiff_t>(columns())});
    publish(choices_out, result.message(event.time));
}

}  // namespace waveform_scheduler
