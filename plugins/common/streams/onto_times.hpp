/// A stage that puts the stream of one sensor onto the times of another: what registration.least_squares and
/// registration.interpolate have in common. A method derives from it and says what the samples tell of a time:
///
///     struct Method : streams::OntoTimes<Method> {
///         static constexpr std::size_t spared = 0;    // samples before a told time that the next one may need
///         Clock patience() const;                     // ns that a time waits for samples after it
///         std::optional<Estimate> tell(const SampleBuffer::Samples&, Clock time, const pelorus::Space&) const;
///     };
///
/// A scan of the other sensor opens a time and is held. The time is closed when the stream has come as far and is not late any more, or
/// when it has been waited for long enough; then the held scan goes on and the estimate follows it. So scans leave in the
/// order of their times, those of one time together.
#pragma once

#include <deque>

#include "held_scan.hpp"

namespace streams {

template <class Method> class OntoTimes : public pelorus::Stage<Method>, public Intake {
public:
    static constexpr const char* kind = "registration";
    std::string onto_;  ///< parameter

    std::vector<pelorus::Stream> in_streams(std::uint32_t) const {
        std::vector<pelorus::Stream> streams(3);
        for (pelorus::Stream& each : streams) each.any_space = each.any_frame = true;
        streams[0].sensor = sensor_;
        streams[1].sensor = onto_;
        streams[2].any_sensor = true;
        return streams;
    }
    // The stream keeps its name, space and frame; all others come out as they came in.
    std::uint32_t passes_on(std::uint32_t) const { return 1; }

    void setup(const pelorus::Setup& setup) {
        if (sensor_ == onto_) throw pelorus::ParameterError("onto", "is the sensor itself, " + sensor_);
        set_up_intake(setup);
        method().prepare();
    }

    void on_scan(const pelorus::Event& event, const plr_scan& scan) {
        const std::string name = scan.sensor;
        if (name == sensor_) {
            take(event, scan);
        } else {
            check_stamp(name, event.time);
            close_silent(event.arrival);
            if (name == onto_ && opens(event))
                hold(event, scan);
            else
                this->publish(0, passed_on(scan, event.time));
        }
        close_reached();
    }

    void finish(const pelorus::Event&) {
        while (!open_.empty()) close();
    }

    template <class Archive> void state(Archive& archive) {
        intake_state(archive);
        archive(open_, closed_);
    }

protected:
    static void describe_streams(pelorus::Describe<Method>& plugin) {
        plugin.parameter("sensor", &Intake::sensor_).doc("whose stream is put onto other times");
        plugin.parameter("onto", &OntoTimes::onto_).doc("the sensor whose times those are");
        Intake::describe_intake(plugin);
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "of both sensors, and of others, which pass", PLR_PORT_MANY);
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "the same sensors, `sensor` at the times of `onto`");
    }

private:
    /// A scan of `onto`, until its time is closed.
    struct Open {
        HeldScan scan;
        Clock deadline = 0;  ///< ns, arrival
        template <class Archive> void state(Archive& archive) { archive(scan, deadline); }
    };

    const Method& method() const noexcept { return static_cast<const Method&>(*this); }
    Method& method() noexcept { return static_cast<Method&>(*this); }
    bool is_closed(Clock time) const { return closed_ && time <= *closed_; }

    /// A scan of the stream. All that can be refused is refused before anything has changed.
    void take(const pelorus::Event& event, const plr_scan& scan) {
        std::optional<Sample> sample = read(scan, event.time);
        const Clock time = sample ? sample->time : event.time;
        const bool is_late = sample && (is_closed(time) || is_silent_until(event.arrival, time));
        judge_late(is_late);
        close_silent(event.arrival);
        if (leaps(time, event.arrival)) return;
        reach(scan, time);
        if (is_late) return count("late");
        if (sample) keep(std::move(*sample));
    }

    /// Whether a scan of `onto` opens a time. It passes alone where that has been told, or has no place in time.
    bool opens(const pelorus::Event& event) {
        if (leaps(event.time, event.arrival)) return false;
        if (is_closed(event.time)) count("late_times");
        return !is_closed(event.time);
    }
    void hold(const pelorus::Event& event, const plr_scan& scan) {
        auto at = open_.end();
        while (at != open_.begin() && std::prev(at)->scan.time() > event.time) --at;
        open_.insert(at, {HeldScan(scan, event.time), event.arrival + lateness() + method().patience()});
        if (open_.size() <= capacity()) return;
        count("closed_early");
        close();
    }

    /// Whether `time` is closed as soon as something arrives at `arrival`.
    bool is_silent_until(Clock arrival, Clock time) const {
        bool closes = false;
        for (const Open& each : open_) {
            if (each.deadline >= arrival) break;
            closes = each.scan.time() >= time;
        }
        return closes;
    }
    /// Closes the times for which the stream has been waited long enough.
    void close_silent(Clock arrival) {
        while (!open_.empty() && open_.front().deadline < arrival) close();
    }
    /// Closes the times that the stream has reached, late samples included.
    void close_reached() {
        while (!open_.empty() && reached_ && *reached_ - lateness() >= open_.front().scan.time()) close();
    }
    /// Lets all scans of the first open time go on, and the estimate after them.
    void close() {
        const Clock time = open_.front().scan.time();
        while (!open_.empty() && open_.front().scan.time() == time) {
            open_.front().scan.release([&](const plr_message& message) { this->publish(0, message); });
            open_.pop_front();
        }
        tell(time);
        closed_ = time;
        samples_.forget_until(time, Method::spared);
    }
    void tell(Clock time) {
        std::optional<Estimate> estimate;
        if (place_) estimate = method().tell(samples_.samples(), time, place_->space);
        if (!estimate) return count("untold_times");
        wrap(place_->space, estimate->value);
        pelorus::ScanBuilder told(sensor_, place_->frame, place_->space);
        told.add(estimate->id, estimate->value.data(), estimate->covariance.data());
        this->publish(0, told.message(time));
    }

    // What save keeps, besides the intake.
    std::deque<Open> open_;        ///< in the order of their times
    std::optional<Clock> closed_;  ///< the last time that was closed
};

}  // namespace streams
