// source.udp as a plugin. See README.md.
#include "udp_source.hpp"

PELORUS_PLUGIN(source_udp::UdpSource, "source.udp");
