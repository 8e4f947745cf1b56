#include "udp_sink.hpp"

#include <cerrno>
#include <chrono>
#include <cmath>
#include <ctime>
#include <system_error>

#include "../../common/wire/frame.hpp"
#include "../../common/wire/text.hpp"

namespace sink_udp {

namespace {

constexpr std::int64_t second = 1'000'000'000;

std::int64_t monotonic_now() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * second + now.tv_nsec;
}

}  // namespace

void UdpSink::describe(pelorus::Describe<UdpSink>& plugin) {
    plugin.title("UDP sender")
        .purpose(
            "Sends what it is given as UDP datagrams (docs/wire-format.md): to source.udp of another run, to a "
            "display, "
            "to whoever reads JSON lines or CSV. Numbers are written with as many digits as it takes to read them back "
            "exactly. Tells its end when the run ends.")
        .source(
            "J. Postel, User Datagram Protocol, RFC 768, 1980; T. Bray (ed.), The JavaScript Object Notation (JSON) "
            "Data Interchange Format, RFC 8259, 2017; Y. Shafranovich, Common Format and MIME Type for CSV Files, RFC "
            "4180, 2005");
    plugin.parameter("destination", &UdpSink::destination_text_)
        .doc("host and port: 127.0.0.1:4530, [::1]:4530, display.example.org:4530, or a multicast group");
    plugin.parameter("interface", &UdpSink::interface_)
        .doc("network interface by which a multicast group is sent to, by name; absent: the system chooses");
    plugin.parameter("format", &UdpSink::format_)
        .initially("json")
        .choices({{"json", "JSON lines"}, {"csv", "rows of text; scans only"}})
        .doc("how frames are written");
    plugin.parameter("sender", &UdpSink::sender_name_)
        .initially("pelorus")
        .doc("name by which the receiver tells senders apart: 1 to 64 printable ASCII characters");
    plugin.parameter("maximum_datagram", &UdpSink::maximum_datagram_)
        .initially("1400")
        .min(400)
        .max(static_cast<double>(wire::largest_datagram))
        .doc("bytes; a larger message is sent in parts. 1400 passes any network, a loopback takes 65000");
    plugin.parameter("pace", &UdpSink::pace_)
        .initially("0")
        .min(0)
        .doc("how many times faster than real time messages are sent, by their arrival; 0: as fast as they come");
    plugin.parameter("uncertainty", &UdpSink::uncertainty_)
        .initially("deviations")
        .choices({{"none", ""},
                  {"deviations", "the standard deviation of each component"},
                  {"covariances", "the whole matrix"}})
        .doc("what is told of a track's uncertainty");
    plugin.parameter("repeat_end", &UdpSink::repeat_end_)
        .initially("3")
        .min(0)
        .max(1000)
        .doc("how many times the end is told, in case that one is lost; 0: not at all");
    plugin.parameter("send_errors", &UdpSink::send_errors_)
        .initially("count")
        .choices({{"count", "told in the log (the first ten) and counted"}, {"stop", "the run ends"}})
        .doc("what happens when the system does not send. That nobody listens is always counted, and told once");
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "measurements, of any sensors", PLR_PORT_OPTIONAL | PLR_PORT_MANY);
    plugin.in_port("truth", PLR_MESSAGE_TRUTH, "what really is; not as CSV", PLR_PORT_OPTIONAL);
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates; not as CSV", PLR_PORT_OPTIONAL);
}

void UdpSink::setup(const pelorus::Setup& setup) {
    log_ = setup.optional_service<plr_log>();
    diagnostics_ = setup.optional_service<plr_diagnostics>();
    const auto destination = parse_destination(destination_text_);
    if (!destination)
        throw pelorus::ParameterError("destination",
                                      "'" + destination_text_ +
                                          "' is no destination: expected host:port, as 127.0.0.1:4530 or "
                                          "[::1]:4530, port 1 to 65535");
    destination_ = *destination;
    if (!wire::is_sender(sender_name_))
        throw pelorus::ParameterError("sender", "is not 1 to 64 printable ASCII characters");
    envelope_.sender = sender_name_;
    // Each run is a session of its own to those who listen; microseconds fit into a double of theirs.
    envelope_.session = static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
            .count());
}

void UdpSink::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    const auto encode = format_ == Format::json ? &wire::json_scan : &wire::csv_scan;
    send(event, encode(envelope_, {event.time, event.arrival}, scan, static_cast<std::size_t>(maximum_datagram_)));
}

void UdpSink::on_truth(const pelorus::Event& event, const plr_truth& truth) {
    require_json("truth");
    send(event,
         wire::json_truth(envelope_, {event.time, event.arrival}, truth, static_cast<std::size_t>(maximum_datagram_)));
}

void UdpSink::on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
    require_json("tracks");
    send(event, wire::json_tracks(envelope_, {event.time, event.arrival}, tracks, uncertainty_,
                                  static_cast<std::size_t>(maximum_datagram_)));
}

void UdpSink::require_json(const char* port) const {
    if (format_ == Format::csv)
        throw pelorus::UnsupportedError(
            std::string("format: csv carries scans only; take format: json, or leave out the "
                        "edge to port ") +
            port);
}

void UdpSink::open() {
    sender_.open(destination_, interface_);
    log(PLR_LOG_INFO, "sending to " + destination_text_ + " as " + envelope_.sender + ", session " +
                          std::to_string(envelope_.session));
}

void UdpSink::send(const pelorus::Event& event, const wire::Datagrams& datagrams) {
    if (pace_ > 0) wait_for(event.arrival);
    for (const std::string& datagram : datagrams) send(datagram);
}

void UdpSink::send(const std::string& datagram) {
    if (!sender_.is_open()) open();
    int error = sender_.send(datagram);
    if (error == ECONNREFUSED) {
        // The answer to an earlier datagram: this one has not been tried yet.
        if (told_errors_++ == 0)
            log(PLR_LOG_WARNING, "nobody listens at " + destination_text_ + " (yet); going on, counted as unreachable");
        count("unreachable", 1);
        error = sender_.send(datagram);
        if (error == ECONNREFUSED) error = 0;
    }
    if (error == 0) {
        ++sent_;
        return count("datagrams", 1);
    }
    ++not_sent_;
    count("send_errors", 1);
    const std::string text = "cannot send " + std::to_string(datagram.size()) + " bytes to " + destination_text_ +
                             ": " + std::generic_category().message(error);
    if (send_errors_ == SendErrors::stop) throw pelorus::IoError(text + " (send_errors: count would go on)");
    if (not_sent_ <= 10) log(PLR_LOG_WARNING, text);
}

/// Sleeps until it is time for what arrived then. A signal ends the sleep and all later ones, so that a run that is asked to
/// stop does.
void UdpSink::wait_for(std::int64_t arrival) {
    if (!start_) start_ = Start{arrival, monotonic_now()};
    if (hurried_) return;
    // Times reach to 2^62 on both sides: their difference is more than an integer holds.
    const double since = (static_cast<double>(arrival) - static_cast<double>(start_->arrival)) / pace_;
    if (!(since > 0) || since > 9e18) return;
    const std::int64_t until = start_->clock + static_cast<std::int64_t>(since);
    const timespec deadline{until / second, until % second};
    hurried_ = ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR;
}

void UdpSink::finish(const pelorus::Event&) {
    if (repeat_end_ > 0) {
        const std::string end = format_ == Format::json ? wire::json_end(envelope_) : wire::csv_end(envelope_);
        for (std::int64_t i = 0; i < repeat_end_; ++i) send(end);
    }
    log(PLR_LOG_INFO, std::to_string(sent_) + " datagrams sent to " + destination_text_ + ", " +
                          std::to_string(not_sent_) + " not sent");
    sender_.close();
}

void UdpSink::count(const char* name, std::int64_t by) const {
    if (diagnostics_ != nullptr) diagnostics_->count(diagnostics_->context, name, by);
}

void UdpSink::log(int level, const std::string& line) const {
    if (log_ != nullptr && level >= log_->level) log_->write(log_->context, level, line.c_str());
}

}  // namespace sink_udp
