/// How a registration stage takes in the stream of the sensor that it moves: its parameters, the samples that are kept, and what
/// becomes of samples that come late, twice or in disorder. A stage derives from it.
#pragma once

#include <optional>

#include "leaps.hpp"
#include "sample_buffer.hpp"

namespace streams {

enum class Late { drop, refuse };

class Intake {
public:
    // Parameters.
    std::string sensor_;
    double lateness_ = 0;  // s
    Late late_ = Late::drop;
    double leap_ = 10;  // s
    std::int64_t capacity_ = 4096;

    template <class Plugin> static void describe_intake(pelorus::Describe<Plugin>& plugin) {
        plugin.parameter("lateness", &Intake::lateness_)
            .unit("s")
            .initially("0 s")
            .min(0)
            .doc(
                "how much later than its stamp, or than samples of later stamps, a sample may still come; what is told "
                "waits for so long");
        plugin.parameter("late", &Intake::late_)
            .initially("drop")
            .choices({{"drop", "left out and counted"}, {"refuse", "an error of the data, which the log tells"}})
            .doc("what becomes of a sample whose time has been told");
        plugin.parameter("leap", &Intake::leap_)
            .unit("s")
            .initially("10 s")
            .above(0)
            .doc(
                "a stamp that runs further ahead of its arrival than any before, by more than this, counts only when "
                "the "
                "next one agrees with it: then the clock has been set");
        plugin.parameter("capacity", &Intake::capacity_)
            .initially("4096")
            .min(2)
            .max(1e6)
            .doc("samples, and scans waiting, that are kept at most; the oldest go first");
    }

protected:
    void set_up_intake(const pelorus::Setup& setup) {
        lateness_ns_ = nanoseconds("lateness", lateness_);
        leap_ns_ = nanoseconds("leap", leap_);
        diagnostics_ = setup.optional_service<plr_diagnostics>();
    }

    Clock lateness() const noexcept { return lateness_ns_; }
    std::size_t capacity() const noexcept { return static_cast<std::size_t>(capacity_); }
    void count(const char* what) const {
        if (diagnostics_ != nullptr) diagnostics_->count(diagnostics_->context, what, 1);
    }

    /// The scan's sample, if it saw the object. Changes nothing; throws DataError for what the stream cannot take.
    std::optional<Sample> read(const plr_scan& scan, Clock time) const {
        check_stamp(sensor_, time);
        if (place_ && (place_->frame != scan.frame || !place_->space.same(pelorus::Space(*scan.space))))
            throw pelorus::DataError("scans of " + sensor_ + " changed from frame '" + place_->frame + "', " +
                                     place_->space.text() + " to frame '" + scan.frame + "', " +
                                     pelorus::Space(*scan.space).text());
        if (scan.measurements.count == 0) return std::nullopt;
        Sample sample = sample_of(scan, time);
        check_stamp(sensor_, sample.time);
        return sample;
    }
    /// Whether a stamp is to be left out for running ahead; notes it.
    bool leaps(Clock stamp, Clock arrival) {
        const bool is_leap = leaps_.is_leap(stamp, arrival, leap_ns_);
        leaps_.note(stamp, arrival, is_leap);
        if (is_leap) count("leaps");
        return is_leap;
    }
    /// Throws DataError where late samples are refused.
    void judge_late(bool is_late) const {
        if (is_late && late_ == Late::refuse)
            throw pelorus::DataError("a sample of " + sensor_ + " came after its time had been told");
    }
    /// The stream has come as far.
    void reach(const plr_scan& scan, Clock time) {
        if (!place_) place_ = place_of(scan);
        reached_ = std::max(reached_.value_or(time), time);
    }
    void keep(Sample sample) {
        switch (samples_.insert(std::move(sample))) {
            case SampleBuffer::Came::twice:
                return count("duplicates");
            case SampleBuffer::Came::out_of_order:
                count("out_of_order");
                break;
            case SampleBuffer::Came::in_order:
                break;
        }
        if (samples_.keep_at_most(capacity())) count("overflows");
    }

    /// What save keeps of it.
    template <class Archive> void intake_state(Archive& archive) {
        archive(place_, samples_, reached_, leaps_);
        if constexpr (Archive::reading)
            for (const Sample& each : samples_.samples())
                if (!place_ || !fits(each)) throw pelorus::DataError("saved samples are of another space");
    }

    std::optional<Place> place_;  ///< of the stream
    SampleBuffer samples_;
    std::optional<Clock> reached_;  ///< its newest stamp
    Leaps leaps_;                   ///< of all sensors: their clocks agree by far better than that

private:
    bool fits(const Sample& sample) const {
        const Eigen::Index m = place_->space.size();
        return sample.value.size() == m && sample.covariance.rows() == m && sample.covariance.cols() == m;
    }

    Clock lateness_ns_ = 0, leap_ns_ = 0;
    const plr_diagnostics* diagnostics_ = nullptr;
};

/// A message with a scan that was received, to go on with the event being handled.
inline plr_message passed_on(const plr_scan& scan, Clock time) {
    plr_message message = pelorus::detail::message_of(PLR_MESSAGE_SCAN, time);
    message.body.scan = &scan;
    return message;
}

}  // namespace streams
