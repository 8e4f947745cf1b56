#include "block_mean_stage.hpp"

namespace block_mean {

void BlockMean::describe(pelorus::Describe<BlockMean>& plugin) {
    plugin.title("Means of blocks of a stream")
        .purpose(
            "Thins the stream of a fast sensor: all samples of a block of time become one, their mean, stamped at the "
            "mean of their times. Scans of other sensors pass, in the order of the stamps.")
        .equation("z = sum z_i / n, t = sum t_i / n, R = sum R_i / n^2 (R_i / n where all are alike)")
        .source(
            "The mean of independent measurements; exact at the mean time where the measurement moves on a line within "
            "the "
            "block");
    plugin.parameter("sensor", &Intake::sensor_).doc("whose stream is thinned");
    plugin.parameter("period", &BlockMean::period_)
        .unit("s")
        .initially("0.5 s")
        .above(0)
        .doc("length of a block; block k holds the stamps in (k period, (k + 1) period]");
    plugin.parameter("min_samples", &BlockMean::min_samples_)
        .initially("1")
        .min(1)
        .max(100000)
        .doc("a block of fewer is left out");
    plugin.parameter("others", &BlockMean::others_)
        .initially("held")
        .choices({{"held", "until the block that they fall into is told: all leaves in the order of stamps"},
                  {"passed", "at once: blocks may then be told after scans of later stamps"}})
        .doc("how scans of other sensors pass");
    describe_intake(plugin);
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "of the sensor, and of others, which pass", PLR_PORT_MANY);
    plugin.out_port("scans", PLR_MESSAGE_SCAN, "the same sensors, `sensor` by blocks");
}

void BlockMean::setup(const pelorus::Setup& setup) {
    set_up_intake(setup);
    period_ns_ = streams::nanoseconds("period", period_);
    if (period_ns_ < 1) throw pelorus::ParameterError("period", "is not within what a clock of nanoseconds can tell");
}

std::vector<pelorus::Stream> BlockMean::in_streams(std::uint32_t) const {
    std::vector<pelorus::Stream> streams(2);
    for (pelorus::Stream& each : streams) each.any_space = each.any_frame = true;
    streams[0].sensor = sensor_;
    streams[1].any_sensor = true;
    return streams;
}

Clock BlockMean::block_end(Clock time) const {
    const Clock beyond = time % period_ns_;
    return beyond == 0 ? time : time - beyond + (beyond > 0 ? period_ns_ : 0);
}

void BlockMean::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    if (sensor_ == scan.sensor) {
        take(event, scan);
    } else {
        streams::check_stamp(scan.sensor, event.time);
        close_until(silent_until(event.arrival));
        const bool is_leap = leaps(event.time, event.arrival);
        if (others_ == Others::held && !is_leap && !is_closed(event.time))
            hold(event, scan);
        else
            publish(0, streams::passed_on(scan, event.time));
    }
    if (!reached_) return;
    const Clock sure = *reached_ - lateness(), end = block_end(sure);
    close_until(end == sure ? end : end - period_ns_);
}

/// All that can be refused is refused before anything has changed.
void BlockMean::take(const pelorus::Event& event, const plr_scan& scan) {
    std::optional<streams::Sample> sample = read(scan, event.time);
    const Clock time = sample ? sample->time : event.time;
    const std::optional<Clock> silent = silent_until(event.arrival);
    const bool is_late = sample && (is_closed(time) || (silent && time <= *silent));
    judge_late(is_late);
    close_until(silent);
    if (leaps(time, event.arrival)) return;
    reach(scan, time);
    last_arrival_ = event.arrival;
    if (is_late) return count("late");
    if (sample) keep(std::move(*sample));
}

void BlockMean::hold(const pelorus::Event& event, const plr_scan& scan) {
    auto at = held_.end();
    while (at != held_.begin() && std::prev(at)->scan.time() > event.time) --at;
    const Clock rest = block_end(event.time) - event.time;
    held_.insert(at, {streams::HeldScan(scan, event.time), event.arrival + rest + lateness()});
    if (held_.size() <= capacity()) return;
    count("closed_early");
    close_until(block_end(held_.front().scan.time()));
}

/// A scan of another sensor has waited for long enough; or the stream, whose own clock may lag, has missed a whole block.
std::optional<Clock> BlockMean::silent_until(Clock arrival) const {
    std::optional<Clock> end;
    for (const Held& each : held_) {
        if (each.deadline >= arrival) break;
        end = block_end(each.scan.time());
    }
    if (!last_arrival_ || samples_.samples().empty()) return end;
    const Clock own = block_end(samples_.samples().back().time);
    if (arrival - *last_arrival_ > own - *reached_ + period_ns_ + lateness()) end = std::max(end.value_or(own), own);
    return end;
}

void BlockMean::close_until(std::optional<Clock> end) {
    if (!end || is_closed(*end)) return;
    const auto& samples = samples_.samples();
    while (!samples.empty() && samples.front().time <= *end) {
        const Clock first_end = block_end(samples.front().time);
        std::size_t count = 1;
        while (count < samples.size() && samples[count].time <= first_end) ++count;
        tell_block(count);
        samples_.forget_until(first_end, 0);
    }
    release_until(*end);
    closed_ = *end;
}

void BlockMean::release_until(Clock time) {
    while (!held_.empty() && held_.front().scan.time() <= time) {
        held_.front().scan.release([&](const plr_message& message) { publish(0, message); });
        held_.pop_front();
    }
}

void BlockMean::tell_block(std::size_t count) {
    if (count < static_cast<std::size_t>(min_samples_)) return this->count("short_blocks");
    const auto& samples = samples_.samples();
    const streams::Sample& first = samples.front();
    // Sums of differences from the first: small numbers keep their digits, and angles stay in one turn.
    Eigen::VectorXd value = first.value, sum = Eigen::VectorXd::Zero(value.size());
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(value.size(), value.size());
    Clock span = 0;
    for (std::size_t i = 0; i < count; ++i) {
        value = streams::unwrapped(place_->space, value, samples[i].value);
        sum += value - first.value;
        covariance += samples[i].covariance;
        span += samples[i].time - first.time;
    }
    const auto n = static_cast<double>(count);
    Eigen::VectorXd mean = first.value + sum / n;
    covariance /= n * n;
    streams::wrap(place_->space, mean);
    const Clock time = first.time + std::llround(static_cast<double>(span) / n);
    release_until(time);
    pelorus::ScanBuilder told(sensor_, place_->frame, place_->space);
    told.add(samples[count - 1].id, mean.data(), covariance.data());
    publish(0, told.message(time));
}

void BlockMean::finish(const pelorus::Event&) {
    std::optional<Clock> end;
    if (!samples_.samples().empty()) end = block_end(samples_.samples().back().time);
    if (!held_.empty())
        end = std::max(end.value_or(std::numeric_limits<Clock>::min()), block_end(held_.back().scan.time()));
    close_until(end);
}

}  // namespace block_mean
