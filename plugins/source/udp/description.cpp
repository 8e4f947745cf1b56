#include "udp_source.hpp"

namespace source_udp {

void UdpSource::describe(pelorus::Describe<UdpSource>& plugin) {
    plugin.title("UDP receiver")
        .purpose(
            "Scans and truth that other programs send as UDP datagrams, JSON lines or CSV (docs/wire-format.md). Puts "
            "datagrams "
            "into the order of their sequence numbers; what is late, lost, doubled or broken is treated as told, and "
            "counted. "
            "Memory is bounded. With arrival: frame, what is replayed by sink.udp gives the results of the original.")
        .source(
            "J. Postel, User Datagram Protocol, RFC 768, 1980; T. Bray (ed.), The JavaScript Object Notation (JSON) "
            "Data Interchange Format, RFC 8259, 2017; Y. Shafranovich, Common Format and MIME Type for CSV Files, RFC "
            "4180, 2005");
    describe_socket(plugin);
    plugin.parameter("arrival", &UdpSource::arrival_)
        .initially("frame")
        .choices({{"frame", "as the frame says (its time where it does not)"},
                  {"clock", "the wall clock when the datagram was read"}})
        .doc("what counts as the arrival of a frame");
    plugin.parameter("truth", &UdpSource::truth_kind_)
        .initially("none")
        .choices({{"none", "truth frames are not read"},
                  {"position", "states are positions"},
                  {"velocity", "positions and velocities"},
                  {"acceleration", "positions, velocities and accelerations"}})
        .doc("what the states of truth frames are");
    plugin.parameter("truth_axes", &UdpSource::truth_axes_).initially("3").min(1).max(3).doc("of those states");
    plugin.parameter("senders", &UdpSource::senders_)
        .initially("1")
        .min(0)
        .doc("the run ends when so many senders have told their end; 0: never for that reason");
    plugin.parameter("idle", &UdpSource::idle_)
        .unit("s")
        .above(0)
        .doc("the run ends after so long without any datagram; absent: never for that reason");
    describe_order(plugin);
    describe_limits(plugin);
    plugin.slot("sensors", "sensor", 1, -1, "what measured: scans bear the part's name and have its space");
    plugin.out_port("scans", PLR_MESSAGE_SCAN, "measurements, one stream a sensor");
    plugin.out_port("truth", PLR_MESSAGE_TRUTH, "what really is, where senders tell it and parameter truth says what");
}

void UdpSource::describe_socket(pelorus::Describe<UdpSource>& plugin) {
    plugin.parameter("port", &UdpSource::port_)
        .min(0)
        .max(65535)
        .doc("UDP port to listen on; 0: the system chooses, the log tells");
    plugin.parameter("address", &UdpSource::address_)
        .doc("address of this machine to listen on, in numbers: 0.0.0.0 or :: for all; 127.0.0.1 if absent");
    plugin.parameter("multicast", &UdpSource::multicast_).doc("group to join instead, in numbers: 239.0.0.1, ff02::1");
    plugin.parameter("interface", &UdpSource::interface_)
        .doc("network interface on which the group is joined, by name; absent: the system chooses");
    plugin.parameter("receive_buffer", &UdpSource::receive_buffer_)
        .initially("4194304")
        .min(4096)
        .max(1 << 30)
        .doc("bytes that the system shall keep for datagrams not yet read; it may give less, which the log tells");
}

void UdpSource::describe_order(pelorus::Describe<UdpSource>& plugin) {
    plugin.parameter("reorder", &UdpSource::reorder_seconds_)
        .unit("s")
        .initially("0.2 s")
        .min(0)
        .max(3600)
        .doc("how long datagrams are held back for a missing one before them");
    plugin.parameter("reorder_datagrams", &UdpSource::reorder_datagrams_)
        .initially("64")
        .min(0)
        .max(65536)
        .doc("how many of a sender are held back for it, at most");
    plugin.parameter("late", &UdpSource::late_)
        .initially("drop")
        .choices({{"drop", "left out and counted"},
                  {"keep", "published when it comes, as arriving then"},
                  {"stop", "the run ends"}})
        .doc(
            "what happens to a datagram that comes after it was given up, and to a frame that arrived before one "
            "already published");
    plugin.parameter("lost", &UdpSource::lost_)
        .initially("count")
        .choices({{"count", "the run goes on, counted"}, {"stop", "the run ends"}})
        .doc("what happens when a datagram is given up");
    plugin.parameter("duplicates", &UdpSource::duplicates_)
        .initially("drop")
        .choices({{"drop", "left out and counted"}, {"keep", "published again, counted"}})
        .doc("what happens to a datagram that comes again");
    plugin.parameter("bad_frames", &UdpSource::bad_frames_)
        .initially("stop")
        .choices({{"stop", "the run ends"}, {"skip", "left out, told in the log and counted"}})
        .doc("what happens to a datagram that cannot be read");
}

void UdpSource::describe_limits(pelorus::Describe<UdpSource>& plugin) {
    plugin.parameter("maximum_senders", &UdpSource::maximum_senders_)
        .initially("16")
        .min(1)
        .max(65536)
        .doc("senders that are told apart; datagrams of further ones are left out and counted");
    plugin.parameter("maximum_measurements", &UdpSource::maximum_measurements_)
        .initially("100000")
        .min(1)
        .doc("of a scan that is put together from parts; a larger one is left out and counted");
    plugin.parameter("maximum_pending", &UdpSource::maximum_pending_)
        .initially("67108864")
        .min(65536)
        .doc(
            "bytes of frames that wait to be published; beyond, datagrams wait in the system's receive buffer. And, by "
            "themselves, bytes of what waits for missing datagrams and parts; beyond, those are given up");
}

}  // namespace source_udp
