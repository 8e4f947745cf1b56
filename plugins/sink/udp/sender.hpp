/// A UDP socket that sends to one place.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace sink_udp {

/// `HOST:PORT`; an IPv6 address stands in brackets: `[::1]:4530`.
struct Destination {
    std::string host, port;
};
/// Nothing where the text is not spelled so.
std::optional<Destination> parse_destination(const std::string& text);

/// [worker, exclusive]
class Sender {
public:
    Sender() = default;
    Sender(const Sender&) = delete;
    Sender& operator=(const Sender&) = delete;
    ~Sender() { close(); }

    bool is_open() const noexcept { return descriptor_ >= 0; }
    /// Resolves the host's name. `interface`: by which groups are sent to. Throws pelorus::IoError.
    void open(const Destination& destination, const std::optional<std::string>& interface);
    void close() noexcept;
    /// 0, or the system's error number.
    int send(const std::string& bytes) noexcept;

private:
    int descriptor_ = -1;
};

}  // namespace sink_udp
