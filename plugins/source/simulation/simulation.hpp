/// source.simulation: trajectories seen by sensor models. See README.md.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/stage.hpp>

#include "simulated_sensor.hpp"
#include "target.hpp"
#include "ticks.hpp"

namespace simulation {

class Simulation : public pelorus::Stage<Simulation> {
public:
    static constexpr const char* kind = "source";
    static constexpr std::uint32_t scans_port = 0, truth_port = 1, pointing_port = 2;

    static void describe(pelorus::Describe<Simulation>& plugin) {
        plugin.title("Simulation")
            .purpose(
                "Targets move along trajectories, sensors measure them: each with a model of its own, and the sensors "
                "are the very "
                "models that trackers use. Publishes truth and scans. All random numbers are keyed by what they are "
                "for, so that "
                "results do not depend on order, threads or what else is simulated.")
            .equation("z = h(p + e) + chol(R) u; e ~ N(0, X) for the points of an extent, u standard normal");
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "what the sensors measure, one scan a sensor and tick");
        plugin.out_port("truth", PLR_MESSAGE_TRUTH, "what really is, at every tick, before the scans of that tick");
        plugin.out_port("pointing", PLR_MESSAGE_VALUES,
                        "where sensors with a field of view look, before each of their scans");
        plugin.in_port("commands", PLR_MESSAGE_VALUES,
                       "waveforms and pointings for sensors, values of the models' inputs",
                       PLR_PORT_OPTIONAL | PLR_PORT_MANY);
        plugin.parameter("period", &Simulation::period_).unit("s").initially("1 s").above(0).doc("from tick to tick");
        plugin.parameter("scans", &Simulation::scans_).min(1).doc("number of ticks, k = 0 included; or give duration");
        plugin.parameter("duration", &Simulation::duration_)
            .unit("s")
            .min(0)
            .doc("time of the last tick, instead of scans");
        plugin.parameter("first_scan", &Simulation::first_scan_)
            .initially("0")
            .min(0)
            .doc("first tick of each sensor at which it measures; before, scans are empty");
        plugin.parameter("covariances", &Simulation::covariances_)
            .initially("true")
            .doc("tell the measurements' covariances in the scans; else trackers take those of their sensor models");
        plugin.parameter("origin", &Simulation::origin_)
            .unit("rad, rad, m")
            .rows(3, 3)
            .doc(
                "latitude, longitude and height (WGS84) where the scene's axes east, north, up begin, for sensors with "
                "a site");
        plugin.parameter("recording", &Simulation::recording_file_)
            .doc(
                "NAME_meas.csv of rows k,i,x,y,z (tick, object, m), played in the place of measurements that are "
                "drawn, "
                "with the true positions in NAME_truth.csv beside it");
        describe_targets(plugin);
        describe_sensors(plugin);
    }

    void setup(const pelorus::Setup& setup) {
        const auto& description = pelorus::Describe<Simulation>::of();
        draws_ = Draws(setup.service<plr_random>(), setup.key());
        std::uint64_t next_object = 1, scratch = 0;
        for (const auto& part : setup.parts<pelorus::TrajectoryPart>("targets")) {
            targets_.emplace_back(part, description.slot_values<TargetValues>(part.raw()), next_object);
            next_object += static_cast<std::uint64_t>(part.info().objects);
            scratch = std::max(scratch, part.info().scratch_bytes);
        }
        for (const auto& part : setup.parts<pelorus::SensorPart>("sensors")) {
            sensors_.emplace_back(part, description.slot_values<SensorValues>(part.raw()), origin_);
            scratch = std::max(scratch, sensors_.back().scratch_bytes());
            for (const Target& target : targets_) sensors_.back().check(target);
        }
        caller_.setup(setup, static_cast<std::size_t>(scratch) + 4096);
        for (const SimulatedSensor& sensor : sensors_) sensor.tell_errors(caller_);
        make_clocks();
        if (recording_file_) read_recording(next_object - 1);
        make_truth_space();
        frame_ = setup.frame();
        truth_ = std::make_unique<pelorus::TruthBuilder>(frame_, space_, extent_dimension_);
        for (const SimulatedSensor& sensor : sensors_) builders_.emplace_back(sensor.name(), frame_, sensor.told());
        for (Target& target : targets_) target.realise(caller_, draws_);
    }

    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const {
        std::vector<pelorus::Stream> streams;
        if (port == truth_port) return {{"", false, space_, false, frame_, false, false}};
        if (port == pointing_port) return {};
        for (const SimulatedSensor& sensor : sensors_)
            streams.push_back({sensor.name(), false, sensor.told(), false, frame_, false, false});
        return streams;
    }

    plr_next next() const {
        if (has_ended()) return {sizeof(plr_next), PLR_NEXT_END, 0, 0};
        const std::int64_t time = times_[event_ % block];
        return {sizeof(plr_next), PLR_NEXT_DATA, time, time};
    }

    void on_values(const pelorus::Event&, const plr_values& values) {
        int known = caller_.take(values);
        const char* at = reinterpret_cast<const char*>(values.quantities);
        for (std::uint32_t i = 0; i < values.count; ++i) {
            const auto& quantity = *reinterpret_cast<const plr_quantity*>(at);
            for (SimulatedSensor& sensor : sensors_) known += sensor.take(quantity);
            at += quantity.struct_size;
        }
        if (known == 0)
            throw pelorus::DataError("no sensor takes this command, and no model has an input of that name");
    }

    void emit(const pelorus::Event&) {
        if (has_ended()) throw pelorus::ArgumentError("the simulation has ended");
        load_block();
        const std::int64_t time = times_[event_ % block];
        std::vector<std::vector<Object>> objects(targets_.size());
        std::vector<std::vector<std::vector<std::uint64_t>>> origins(targets_.size());
        for (std::size_t t = 0; t < targets_.size(); ++t) {
            if (recording_)
                targets_[t].collect(*recording_, event_, objects[t]);
            else
                targets_[t].collect(static_cast<std::int64_t>(event_ % block), objects[t]);
            origins[t].resize(objects[t].size());
        }
        std::vector<std::size_t> due;
        for (std::size_t s = 0; s < sensors_.size(); ++s)
            if (scan(s, time, objects, origins)) due.push_back(s);
        tell_truth(time, objects, origins);
        tell_pointing(time);
        for (const std::size_t s : due) send(s, time);
        if (++event_ % block == 0) events_.times(ticks_, block, times_);
    }

    template <class Archive> void state(Archive& archive) {
        archive(event_, ticks_, next_id_, caller_);
        for (Target& target : targets_) target.state(archive);
        for (SimulatedSensor& sensor : sensors_) sensor.state(archive);
        if (recording_) {
            std::uint64_t digest = recording_->digest();
            archive(digest);
            if (digest != recording_->digest())
                throw pelorus::DataError("the recording " + recording_file_->string() +
                                         " has changed since the state was saved");
        }
        if constexpr (Archive::reading) {
            if (ticks_.size() != sensors_.size()) throw pelorus::DataError("saved state is of another simulation");
            block_loaded_ = no_block;
            events_.times(events_.before(ticks_, event_ % block), block, times_);
            if (times_.size() < event_ % block) throw pelorus::DataError("saved state is of another simulation");
        }
    }

private:
    static constexpr std::uint64_t block = 64, no_block = ~std::uint64_t{0};

    static void describe_targets(pelorus::Describe<Simulation>& plugin) {
        plugin.slot("targets", "trajectory", 1, -1, "what moves");
        plugin.slot_parameter("points_per_scan", &TargetValues::points_per_scan)
            .initially("0")
            .min(0)
            .doc("points that the object's extent gives to each scan; 0: its own position is measured, once");
        plugin.slot_parameter("detection_probability", &TargetValues::detection_probability)
            .initially("1")
            .min(0)
            .max(1)
            .doc("of each point, times that of the sensor");
        plugin.slot_parameter("spread", &TargetValues::spread)
            .initially("gaussian")
            .choices({{"gaussian", "points are N(0, X) about the centre"}, {"uniform", "uniform within the ellipsoid"}})
            .doc("how points lie on the extent X");
    }

    void make_clocks() {
        if (scans_.has_value() == duration_.has_value())
            throw pelorus::ParameterError("scans", "give either scans or duration");
        const Clock own(period_);
        const double seconds = duration_ ? *duration_ : static_cast<double>(*scans_ - 1) * period_;
        if (!(seconds < 9e9))
            throw pelorus::ParameterError(duration_ ? "duration" : "scans", "goes beyond what ns can count (9e9 s)");
        const std::int64_t end =
            duration_ ? std::llround(seconds * 1e9) : own.time(static_cast<std::uint64_t>(*scans_ - 1));
        std::vector<Clock> clocks;
        for (const SimulatedSensor& sensor : sensors_) clocks.push_back(sensor.timing().clock(draws_, period_));
        events_ = Events(std::move(clocks), end);
        ticks_ = events_.first();
        events_.times(ticks_, block, times_);
    }

    /// The recording takes the place of one sensor's draws and of where the objects of the targets are, not of who they are.
    void read_recording(std::uint64_t objects) {
        if (sensors_.size() != 1)
            throw pelorus::PartError("sensors",
                                     "a recording is of one sensor, here are " + std::to_string(sensors_.size()));
        sensors_.front().check_recordable();
        for (const Target& target : targets_)
            if (target.axes() != 3 || target.values().points_per_scan > 0)
                throw pelorus::PartError("targets", "target " + target.name() +
                                                        " is not one point on three axes, which a recording tells of");
        recording_.emplace(*recording_file_, objects);
        if (Clock(period_).time(recording_->ticks()) <= events_.end())
            throw pelorus::ParameterError(
                scans_ ? "scans" : "duration",
                "goes beyond the recording, whose last tick is k = " + std::to_string(recording_->ticks() - 1));
    }

    bool has_ended() const noexcept { return event_ % block >= times_.size(); }

    /// The components that all targets have, in the first one's order.
    void make_truth_space() {
        std::vector<pelorus::Component> common;
        for (const auto& component : targets_.front().space().components()) {
            bool everywhere = true;
            for (const Target& target : targets_) everywhere = everywhere && target.space().index(component.name) >= 0;
            const bool told = !recording_ || component.name.rfind("position.", 0) == 0;
            if (everywhere && told) common.push_back(component);
        }
        space_ = pelorus::Space(common);
        for (const Target& target : targets_) {
            if (target.axes() != targets_.front().axes())
                throw pelorus::PartError("targets", "targets " + targets_.front().name() + " and " + target.name() +
                                                        " move on different numbers of axes");
            extent_dimension_ = std::max(extent_dimension_, target.extent_dimension());
        }
    }

    /// States are asked for in blocks that lie at fixed places, so that a resumed run asks for the same ones.
    void load_block() {
        const std::uint64_t wanted = event_ / block;
        if (wanted == block_loaded_) return;
        for (Target& target : targets_)
            target.load_block(caller_, times_.data(), static_cast<std::int64_t>(times_.size()));
        block_loaded_ = wanted;
    }

    /// Makes the scan of sensor s if it is due and not lost.
    bool scan(std::size_t s, std::int64_t time, const std::vector<std::vector<Object>>& objects,
              std::vector<std::vector<std::vector<std::uint64_t>>>& origins) {
        SimulatedSensor& sensor = sensors_[s];
        if (!events_.is_due(s, ticks_, time)) return false;
        const std::uint64_t tick = ticks_[s]++;
        sensor.look_at(time);
        if (sensor.is_lost(draws_, tick, time)) return false;
        pelorus::ScanBuilder& builder = builders_[s];
        builder.clear();
        sensor.tell_waveform(time, builder);
        if (tick < static_cast<std::uint64_t>(first_scan_)) return true;
        for (std::size_t t = 0; t < targets_.size(); ++t) {
            std::vector<std::vector<std::uint64_t>*> to;
            for (auto& list : origins[t]) to.push_back(&list);
            sensor.measure(caller_, draws_, time, tick, targets_[t], objects[t], next_id_, covariances_, builder, to);
        }
        sensor.add_clutter(caller_, draws_, time, tick, middle(objects), next_id_, covariances_, builder);
        return true;
    }

    /// Where the sensors that look at this time do so, as the encoders of their mounts would tell: also of scans that are lost.
    void tell_pointing(std::int64_t time) {
        pelorus::ValuesBuilder told;
        bool is_any = false;
        for (std::size_t s = 0; s < sensors_.size(); ++s) {
            const SensorView& view = sensors_[s].view();
            if (!view.is_limited() || !view.was_moved(time)) continue;
            const std::vector<double> angles = view.pointing();
            told.add(sensors_[s].name(), "pointing", "rad",
                     Eigen::Map<const Eigen::VectorXd>(angles.data(), static_cast<Eigen::Index>(angles.size())), time,
                     time);
            is_any = true;
        }
        if (is_any) publish(pointing_port, told.message(time));
    }

    /// Publishes the scan that sensor s has just measured, stamped by its clock, for when it arrives.
    void send(std::size_t s, std::int64_t time) {
        const SensorTiming& timing = sensors_[s].timing();
        plr_message message = builders_[s].message(timing.stamp(time));
        message.arrival = timing.arrival(draws_, ticks_[s] - 1, time);
        publish(scans_port, message);
    }

    /// Of the living objects' positions.
    std::optional<Middle> middle(const std::vector<std::vector<Object>>& objects) const {
        Middle sum{};
        double count = 0;
        for (std::size_t t = 0; t < targets_.size(); ++t)
            for (const Object& object : objects[t]) {
                for (int axis = 0; axis < targets_[t].axes(); ++axis)  // positions come first
                    sum[static_cast<std::size_t>(axis)] += object.state[axis];
                ++count;
            }
        if (count == 0) return std::nullopt;
        for (double& each : sum) each /= count;
        return sum;
    }

    void tell_truth(std::int64_t time, const std::vector<std::vector<Object>>& objects,
                    const std::vector<std::vector<std::vector<std::uint64_t>>>& origins) {
        truth_->clear();
        const auto d = static_cast<std::size_t>(extent_dimension_);
        const std::vector<double> point(d * d, 0.0);  // the extent of an object that has none, where others have one
        for (std::size_t t = 0; t < targets_.size(); ++t)
            for (std::size_t k = 0; k < objects[t].size(); ++k) {
                const Object& object = objects[t][k];
                std::vector<double> state;
                for (const auto& component : space_.components())
                    state.push_back(object.state[targets_[t].space().index(component.name)]);
                pelorus::TruthEntry entry;
                entry.id = object.id;
                entry.time = time;
                entry.state = state.data();
                entry.extent = object.extent != nullptr ? object.extent : point.data();
                entry.parent = object.parent;
                entry.birth = object.birth;
                entry.measurements = origins[t][k];
                truth_->add(entry);
            }
        publish(truth_port, truth_->message(time));
    }

    double period_ = 1;
    std::optional<std::int64_t> scans_;
    std::optional<double> duration_;
    std::int64_t first_scan_ = 0;
    bool covariances_ = true;
    std::optional<std::vector<double>> origin_;  // rad, rad, m
    std::optional<std::filesystem::path> recording_file_;

    Draws draws_;
    pelorus::Caller caller_;
    std::vector<Target> targets_;
    std::vector<SimulatedSensor> sensors_;
    std::optional<Recording> recording_;
    Events events_;
    std::vector<std::int64_t> times_;  ///< of the events of this block
    pelorus::Space space_;
    int extent_dimension_ = 0;
    std::string frame_;
    std::unique_ptr<pelorus::TruthBuilder> truth_;
    std::vector<pelorus::ScanBuilder> builders_;
    std::uint64_t block_loaded_ = no_block;

    // What save keeps.
    std::uint64_t event_ = 0;
    std::vector<std::uint64_t> ticks_;  ///< next tick of each sensor
    std::uint64_t next_id_ = 1;
};

}  // namespace simulation
