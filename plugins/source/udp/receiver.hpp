/// A UDP socket that is only ever asked what is there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace source_udp {

struct ReceiverSettings {
    std::string address;                   ///< to bind, numeric; with multicast, the group
    std::uint16_t port = 0;                ///< 0: the system chooses
    bool multicast = false;                ///< address is a group to join
    std::optional<std::string> interface;  ///< on which the group is joined
    int buffer = 0;                        ///< bytes to ask the system for
};

/// Whether the text is an IPv4 or IPv6 address in numbers; and whether it is one of a group.
bool is_address(const std::string& text);
bool is_group(const std::string& text);

/// [worker, exclusive]. Errors are pelorus::IoError and name the parameter and the system's reason.
class Receiver {
public:
    Receiver() = default;
    Receiver(const Receiver&) = delete;
    Receiver& operator=(const Receiver&) = delete;
    ~Receiver() { close(); }

    bool is_open() const noexcept { return descriptor_ >= 0; }
    void open(const ReceiverSettings& settings);
    void close() noexcept;
    /// The port and the bytes of buffer that the system gave.
    std::uint16_t port() const noexcept { return port_; }
    int buffer() const noexcept { return given_buffer_; }

    /// The next datagram, valid until the next call; nothing if none waits. Never blocks.
    std::optional<std::string_view> receive();
    /// Where it came from: `127.0.0.1:4530`, `[::1]:4530`.
    std::string origin() const;
    /// Datagrams that the system dropped because the buffer was full, so far as it has told.
    std::uint32_t dropped() const noexcept { return dropped_; }

private:
    void join(const ReceiverSettings& settings, unsigned index);

    int descriptor_ = -1;
    std::uint16_t port_ = 0;
    int given_buffer_ = 0;
    std::uint32_t dropped_ = 0;
    std::vector<char> bytes_;
    std::vector<unsigned char> from_;  // a sockaddr_storage
};

}  // namespace source_udp
