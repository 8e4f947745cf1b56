#include "sender.hpp"

#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <system_error>

#include <pelorus/failure.hpp>

namespace sink_udp {

namespace {

bool set_interface(int descriptor, int family, unsigned index) {
    if (family == AF_INET6) return ::setsockopt(descriptor, IPPROTO_IPV6, IPV6_MULTICAST_IF, &index, sizeof index) == 0;
    ip_mreqn request{};
    request.imr_ifindex = static_cast<int>(index);
    return ::setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_IF, &request, sizeof request) == 0;
}

}  // namespace

std::optional<Destination> parse_destination(const std::string& text) {
    const auto colon = text.rfind(':');
    if (colon == std::string::npos || colon == 0) return std::nullopt;
    Destination destination{text.substr(0, colon), text.substr(colon + 1)};
    if (destination.host.front() == '[') {
        if (destination.host.back() != ']' || destination.host.size() < 3) return std::nullopt;
        destination.host = destination.host.substr(1, destination.host.size() - 2);
    } else if (destination.host.find(':') != std::string::npos) {
        return std::nullopt;
    }
    const std::string& port = destination.port;
    const bool digits = !port.empty() && port.size() <= 5 &&
                        std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!digits || std::stoi(port) < 1 || std::stoi(port) > 65535) return std::nullopt;
    return destination;
}

void Sender::open(const Destination& destination, const std::optional<std::string>& interface) {
    close();
    unsigned index = 0;
    if (interface && (index = ::if_nametoindex(interface->c_str())) == 0)
        throw pelorus::IoError("parameter interface: there is no network interface " + *interface);
    addrinfo hints{};
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const int problem = ::getaddrinfo(destination.host.c_str(), destination.port.c_str(), &hints, &found);
    if (problem != 0)
        throw pelorus::IoError("parameter destination: cannot find host " + destination.host + ": " +
                               ::gai_strerror(problem));
    const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, &::freeaddrinfo);
    int reason = EADDRNOTAVAIL;
    for (const addrinfo* at = found; at != nullptr; at = at->ai_next) {
        descriptor_ = ::socket(at->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        if (descriptor_ >= 0 && (!interface || set_interface(descriptor_, at->ai_family, index)) &&
            ::connect(descriptor_, at->ai_addr, at->ai_addrlen) == 0)
            return;
        reason = errno;
        close();
    }
    throw pelorus::IoError("parameter destination: cannot send to " + destination.host + ", UDP port " +
                           destination.port + ": " + std::generic_category().message(reason));
}

void Sender::close() noexcept {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
}

int Sender::send(const std::string& bytes) noexcept {
    while (::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0)
        if (errno != EINTR) return errno;
    return 0;
}

}  // namespace sink_udp
