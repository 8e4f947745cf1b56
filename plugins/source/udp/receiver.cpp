#include "receiver.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include <pelorus/failure.hpp>

namespace source_udp {

namespace {

constexpr std::size_t largest = 65536;  // more than UDP carries, so that nothing is ever cut off

struct Address {
    sockaddr_storage storage{};
    socklen_t size = 0;
    bool is_group = false;
};

std::optional<Address> parse(const std::string& text, std::uint16_t port) {
    Address address;
    sockaddr_in v4{};
    sockaddr_in6 v6{};
    if (::inet_pton(AF_INET, text.c_str(), &v4.sin_addr) == 1) {
        v4.sin_family = AF_INET;
        v4.sin_port = htons(port);
        std::memcpy(&address.storage, &v4, sizeof v4);
        address.size = sizeof v4;
        address.is_group = IN_MULTICAST(ntohl(v4.sin_addr.s_addr));
    } else if (::inet_pton(AF_INET6, text.c_str(), &v6.sin6_addr) == 1) {
        v6.sin6_family = AF_INET6;
        v6.sin6_port = htons(port);
        std::memcpy(&address.storage, &v6, sizeof v6);
        address.size = sizeof v6;
        address.is_group = IN6_IS_ADDR_MULTICAST(&v6.sin6_addr);
    } else {
        return std::nullopt;
    }
    return address;
}

[[noreturn]] void fail(const std::string& what) {
    throw pelorus::IoError(what + ": " + std::generic_category().message(errno));
}

template <class Value> bool set(int descriptor, int level, int option, const Value& value) {
    return ::setsockopt(descriptor, level, option, &value, sizeof value) == 0;
}

std::uint16_t port_of(const sockaddr_storage& storage) {
    sockaddr_in v4{};
    sockaddr_in6 v6{};
    std::memcpy(&v4, &storage, sizeof v4);
    std::memcpy(&v6, &storage, sizeof v6);
    return ntohs(storage.ss_family == AF_INET ? v4.sin_port : v6.sin6_port);
}

}  // namespace

bool is_address(const std::string& text) { return parse(text, 0).has_value(); }
bool is_group(const std::string& text) {
    const auto address = parse(text, 0);
    return address && address->is_group;
}

void Receiver::open(const ReceiverSettings& settings) {
    close();
    Address address = parse(settings.address, settings.port).value();
    unsigned index = 0;
    if (settings.interface && (index = ::if_nametoindex(settings.interface->c_str())) == 0)
        fail("parameter interface: there is no network interface " + *settings.interface);
    descriptor_ = ::socket(address.storage.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor_ < 0) fail("cannot make a UDP socket");
    set(descriptor_, SOL_SOCKET, SO_RCVBUF, settings.buffer);  // what came of it is asked below
    set(descriptor_, SOL_SOCKET, SO_RXQ_OVFL, 1);              // where the system cannot tell, sequence numbers do
    if (settings.multicast && !set(descriptor_, SOL_SOCKET, SO_REUSEADDR, 1))
        fail("cannot share port " + std::to_string(settings.port));
    if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address.storage), address.size) != 0)
        fail("parameters address and port: cannot listen on " + settings.address + ", UDP port " +
             std::to_string(settings.port));
    if (settings.multicast) join(settings, index);
    socklen_t size = sizeof address.storage;
    if (::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address.storage), &size) != 0)
        fail("cannot tell the port");
    port_ = port_of(address.storage);
    size = sizeof given_buffer_;
    if (::getsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &given_buffer_, &size) != 0) fail("cannot tell the buffer");
    given_buffer_ /= 2;  // the system doubles it, for its own bookkeeping
    bytes_.resize(largest);
    from_.resize(sizeof(sockaddr_storage));
    dropped_ = 0;
}

void Receiver::join(const ReceiverSettings& settings, unsigned index) {
    bool joined = false;
    if (ip_mreqn v4{}; ::inet_pton(AF_INET, settings.address.c_str(), &v4.imr_multiaddr) == 1) {
        v4.imr_ifindex = static_cast<int>(index);
        joined = set(descriptor_, IPPROTO_IP, IP_ADD_MEMBERSHIP, v4);
    } else if (ipv6_mreq v6{}; ::inet_pton(AF_INET6, settings.address.c_str(), &v6.ipv6mr_multiaddr) == 1) {
        v6.ipv6mr_interface = index;
        joined = set(descriptor_, IPPROTO_IPV6, IPV6_JOIN_GROUP, v6);
    }
    if (!joined)
        fail("parameters multicast and interface: cannot join " + settings.address +
             (settings.interface ? " on " + *settings.interface : ""));
}

void Receiver::close() noexcept {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
}

std::optional<std::string_view> Receiver::receive() {
    alignas(cmsghdr) unsigned char control[64];
    iovec part{bytes_.data(), bytes_.size()};
    msghdr message{};
    message.msg_name = from_.data();
    message.msg_namelen = static_cast<socklen_t>(from_.size());
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    ssize_t size = -1;
    do size = ::recvmsg(descriptor_, &message, 0);
    while (size < 0 && errno == EINTR);
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return std::nullopt;
    if (size < 0) fail("cannot receive");
    for (cmsghdr* at = CMSG_FIRSTHDR(&message); at != nullptr; at = CMSG_NXTHDR(&message, at))
        if (at->cmsg_level == SOL_SOCKET && at->cmsg_type == SO_RXQ_OVFL)
            std::memcpy(&dropped_, CMSG_DATA(at), sizeof dropped_);
    return std::string_view(bytes_.data(), static_cast<std::size_t>(size));
}

std::string Receiver::origin() const {
    sockaddr_storage storage{};
    std::memcpy(&storage, from_.data(), sizeof storage);
    const bool v4 = storage.ss_family == AF_INET;
    char text[INET6_ADDRSTRLEN] = "?";
    const auto* bytes = reinterpret_cast<const unsigned char*>(&storage);
    ::inet_ntop(storage.ss_family, bytes + (v4 ? offsetof(sockaddr_in, sin_addr) : offsetof(sockaddr_in6, sin6_addr)),
                text, sizeof text);
    const std::string port = std::to_string(port_of(storage));
    return v4 ? std::string(text) + ":" + port : "[" + std::string(text) + "]:" + port;
}

}  // namespace source_udp
