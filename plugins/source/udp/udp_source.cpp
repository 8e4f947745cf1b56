#include "udp_source.hpp"

#include <chrono>
#include <cmath>
#include <utility>

#include "../../common/wire/text.hpp"

namespace source_udp {

namespace {

constexpr std::uint64_t logged_warnings = 10;   // a broken network must not fill the log; all is counted
constexpr int datagrams_at_once = 256;          // read in one call, so that other nodes get their turn
constexpr std::int64_t look_again = 2'000'000;  // ns, when nothing is there

std::int64_t steady_now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}
std::int64_t wall_now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

}  // namespace

void UdpSource::setup(const pelorus::Setup& setup) {
    log_ = setup.optional_service<plr_log>();
    diagnostics_ = setup.optional_service<plr_diagnostics>();
    if (multicast_ && address_)
        throw pelorus::ParameterError("address", "with multicast, the group is what is listened to: leave address out");
    if (multicast_ && !is_group(*multicast_))
        throw pelorus::ParameterError("multicast",
                                      "'" + *multicast_ + "' is no multicast group in numbers (239.0.0.1, ff02::1)");
    if (multicast_ && port_ == 0) throw pelorus::ParameterError("port", "0 chooses a port, which a group cannot know");
    if (interface_ && !multicast_)
        throw pelorus::ParameterError("interface", "belongs to multicast, which is not given");
    if (address_ && (!is_address(*address_) || is_group(*address_)))
        throw pelorus::ParameterError(
            "address",
            "'" + *address_ + "' is no IP address in numbers (127.0.0.1, 0.0.0.0, ::); a group goes into multicast");
    where_ = {multicast_ ? *multicast_ : address_.value_or("127.0.0.1"), static_cast<std::uint16_t>(port_),
              multicast_.has_value(), interface_, static_cast<int>(receive_buffer_)};
    vocabulary_.frame = setup.frame();
    for (const auto& part : setup.parts<pelorus::SensorPart>("sensors")) {
        wire::Vocabulary::Sensor& sensor = vocabulary_.sensors[part.name()];
        sensor.measurement = pelorus::Space(*part.info().measurement);
        if (part.info().waveform != nullptr) sensor.waveform = pelorus::Space(*part.info().waveform);
    }
    if (truth_kind_ != Truth::none)
        vocabulary_.truth = pelorus::kinematic_space(static_cast<int>(truth_axes_),
                                                     std::vector<double>(static_cast<std::size_t>(truth_kind_), 0.0));
    sequencer_ = std::make_unique<Sequencer>(
        OrderSettings{std::llround(reorder_seconds_ * 1e9), static_cast<std::size_t>(reorder_datagrams_),
                      static_cast<std::size_t>(maximum_senders_), static_cast<std::size_t>(maximum_measurements_),
                      static_cast<std::size_t>(maximum_pending_), late_, lost_, duplicates_,
                      arrival_ == Arrival::clock},
        [this](const std::string& text) { warn(text); });
}

std::vector<pelorus::Stream> UdpSource::out_streams(std::uint32_t port) const {
    std::vector<pelorus::Stream> streams;
    pelorus::Stream stream;
    stream.frame = vocabulary_.frame;
    if (port == truth) {
        if (truth_kind_ == Truth::none) return {};
        stream.space = vocabulary_.truth;
        return {stream};
    }
    for (const auto& [name, sensor] : vocabulary_.sensors) {
        stream.sensor = name;
        stream.space = sensor.measurement;
        streams.push_back(stream);
    }
    return streams;
}

plr_next UdpSource::next() {
    const std::int64_t now = steady_now();
    if (!receiver_.is_open()) open();
    drain(now);
    sequencer_->expire(now);
    const bool all_ended = senders_ > 0 && sequencer_->ended() >= static_cast<std::uint64_t>(senders_);
    if (sequencer_->ready().empty() && (all_ended || (idle_ && static_cast<double>(now - last_heard_) * 1e-9 > *idle_)))
        sequencer_->flush();
    tell_counters();
    // Whoever waits once is known to the host as live, so that its arrivals may lie before those of other sources.
    if (!std::exchange(has_waited_, true)) return {sizeof(plr_next), PLR_NEXT_WAIT, wall_now(), 0};
    if (!sequencer_->ready().empty()) {
        const wire::Frame& frame = sequencer_->ready().front();
        return {sizeof(plr_next), PLR_NEXT_DATA, *frame.arrival, frame.time};
    }
    if (all_ended) return {sizeof(plr_next), PLR_NEXT_END, 0, 0};
    if (idle_ && static_cast<double>(now - last_heard_) * 1e-9 > *idle_) {
        log(PLR_LOG_INFO, "no datagram for so long (idle): this is the end");
        return {sizeof(plr_next), PLR_NEXT_END, 0, 0};
    }
    return {sizeof(plr_next), PLR_NEXT_WAIT, wall_now() + look_again, 0};
}

void UdpSource::open() {
    receiver_.open(where_);
    overrun_before_ = 0;
    last_heard_ = steady_now();
    log(PLR_LOG_INFO, "listening on " + where_.address + ", UDP port " + std::to_string(receiver_.port()) +
                          ", receive buffer " + std::to_string(receiver_.buffer()) + " bytes");
    if (receiver_.buffer() < receive_buffer_)
        log(PLR_LOG_WARNING, "the system gave a receive buffer of " + std::to_string(receiver_.buffer()) +
                                 " bytes of the " + std::to_string(receive_buffer_) +
                                 " asked for (net.core.rmem_max is its limit)");
}

/// Takes over what waits in the socket, unless so much is pending already that it had better wait there.
void UdpSource::drain(std::int64_t now) {
    for (int i = 0; i < datagrams_at_once && sequencer_->ready_bytes() < static_cast<std::size_t>(maximum_pending_);
         ++i) {
        const auto bytes = receiver_.receive();
        if (!bytes) break;
        last_heard_ = now;
        take(*bytes, receiver_.origin(), now);
    }
    const std::uint32_t dropped = receiver_.dropped() - std::exchange(overrun_before_, receiver_.dropped());
    if (dropped == 0) return;
    counted_.overrun += dropped;
    warn("the system dropped " + std::to_string(dropped) + " datagrams because the receive buffer was full");
}

void UdpSource::take(std::string_view bytes, const std::string& origin, std::int64_t now) {
    ++counted_.datagrams;
    wire::Datagram datagram;
    std::string problem;
    try {
        wire::decode(bytes, vocabulary_, datagram);
    } catch (const wire::BadFrame& bad) {
        problem = bad.what();
    }
    if (datagram.sender.empty()) datagram.sender = origin;
    if (!problem.empty())
        refuse(origin + ", datagram " + std::to_string(counted_.datagrams) + " (sender " + datagram.sender +
               "): " + problem);
    for (wire::Frame& frame : datagram.frames) {
        ++counted_.frames;
        counted_.rows += frame.rows();
        if (arrival_ == Arrival::clock) frame.arrival = wall_now();
    }
    // What was refused has come in nevertheless: nobody shall wait for its number.
    if (!problem.empty() && !datagram.sequence) return;
    if (sequencer_->push(std::move(datagram), now)) return;
    ++counted_.refused;
    warn(origin + ": there are " + std::to_string(maximum_senders_) +
         " senders already (maximum_senders); its datagrams are left out");
}

void UdpSource::emit(const pelorus::Event&) {
    if (sequencer_->ready().empty()) throw pelorus::ArgumentError("there is nothing to emit");
    const wire::Frame frame = sequencer_->take();
    if (const auto id = wire::doubled_id(frame))
        return refuse("the frame at " + std::to_string(frame.time) + " ns has the id " + std::to_string(*id) +
                      " twice");
    if (frame.kind == wire::Kind::scan) return publish_scan(frame);
    publish_truth(frame);
}

void UdpSource::publish_scan(const wire::Frame& frame) {
    const wire::Vocabulary::Sensor& sensor = vocabulary_.sensors.at(frame.sensor);
    pelorus::ScanBuilder scan(frame.sensor, vocabulary_.frame, sensor.measurement);
    const auto m = static_cast<std::size_t>(frame.width);
    for (std::size_t i = 0; i < frame.rows(); ++i) {
        const double* covariance = nullptr;
        if (!frame.covariances.empty())
            covariance = frame.covariances.data() + (frame.common_covariance() ? 0 : i * m * m);
        scan.add(frame.ids.empty() ? next_id_++ : frame.ids[i], frame.values.data() + i * m, covariance);
        if (!frame.times.empty()) scan.set_time(frame.times[i]);
        if (!frame.snr.empty()) scan.set_snr(frame.snr[i]);
    }
    if (!frame.waveform.empty()) scan.set_waveform(sensor.waveform, frame.waveform);
    publish(scans, scan.message(frame.time));
}

void UdpSource::publish_truth(const wire::Frame& frame) {
    const auto c = static_cast<std::size_t>(frame.width), d = static_cast<std::size_t>(frame.extent_dimension);
    pelorus::TruthBuilder builder(vocabulary_.frame, vocabulary_.truth, static_cast<int>(d));
    for (std::size_t i = 0; i < frame.rows(); ++i) {
        pelorus::TruthEntry entry;
        entry.id = frame.ids[i];
        entry.time = frame.times.empty() ? frame.time : frame.times[i];
        entry.state = frame.values.data() + i * c;
        if (d != 0) entry.extent = frame.extents.data() + i * d * d;
        entry.parent = frame.parents.empty() ? entry.id : frame.parents[i];
        entry.birth = frame.births.empty() ? entry.time : frame.births[i];
        if (!frame.measurements.empty()) entry.measurements = frame.measurements[i];
        builder.add(entry);
    }
    publish(truth, builder.message(frame.time));
}

void UdpSource::refuse(const std::string& text) {
    ++counted_.bad;
    if (bad_frames_ == BadFrames::stop) throw pelorus::DataError(text + " (bad_frames: skip would go on)");
    warn(text + "; it is left out");
}

void UdpSource::warn(const std::string& text) {
    if (++warnings_ <= logged_warnings) log(PLR_LOG_WARNING, text);
    if (warnings_ == logged_warnings) log(PLR_LOG_WARNING, "further ones are only counted");
}

void UdpSource::log(int level, const std::string& line) const {
    if (log_ != nullptr && level >= log_->level) log_->write(log_->context, level, line.c_str());
}

/// The host's counters only add, and keep what a snapshot brings along.
void UdpSource::tell(const char* name, std::uint64_t value) {
    std::uint64_t& told = told_[name];
    if (diagnostics_ != nullptr && told != value)
        diagnostics_->count(diagnostics_->context, name, static_cast<std::int64_t>(value - told));
    told = value;
}

void UdpSource::tell_counters() {
    const OrderCounts& order = sequencer_->counts();
    tell("datagrams", counted_.datagrams);
    tell("frames", counted_.frames);
    tell("rows", counted_.rows);
    tell("bad_frames", counted_.bad);
    tell("lost", order.lost);
    tell("late", order.late);
    tell("duplicates", order.duplicate);
    tell("incomplete", order.incomplete);
    tell("ignored", order.ignored);
    tell("refused_datagrams", counted_.refused);
    tell("overrun", counted_.overrun);
}

void UdpSource::finish(const pelorus::Event&) {
    tell_counters();
    receiver_.close();
    const OrderCounts& order = sequencer_->counts();
    const auto part = [](std::uint64_t count, const char* what) { return ", " + std::to_string(count) + " " + what; };
    log(PLR_LOG_INFO, std::to_string(counted_.datagrams) + " datagrams" + part(counted_.frames, "frames") +
                          part(counted_.rows, "rows") + part(counted_.bad, "bad") + part(order.lost, "lost") +
                          part(order.late, "late") + part(order.duplicate, "duplicate") +
                          part(order.incomplete, "incomplete") + part(counted_.refused, "refused"));
}

}  // namespace source_udp
