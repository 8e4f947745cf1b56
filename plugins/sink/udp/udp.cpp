// sink.udp as a plugin. See README.md.
#include "udp_sink.hpp"

PELORUS_PLUGIN(sink_udp::UdpSink, "sink.udp");
