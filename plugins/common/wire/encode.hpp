/// Messages as datagrams.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <pelorus/abi/message.h>

namespace wire {

/// What is told of a track's uncertainty.
enum class Uncertainty { none, deviations, covariances };

/// What all datagrams of a sender bear.
struct Envelope {
    std::string sender;
    std::uint64_t session = 0;
    std::uint64_t sequence = 0;  ///< of the next datagram
};

/// When, in ns.
struct Stamp {
    std::int64_t time = 0, arrival = 0;
};

/// A message's datagrams, each of at most `maximum` bytes: entries are dealt out to as many parts as it takes. Throw
/// pelorus::DataError where a number is not finite (it names the entry), or where one entry alone is too large. `envelope`
/// has its sequence raised by the number of datagrams.
using Datagrams = std::vector<std::string>;
Datagrams json_scan(Envelope& envelope, Stamp stamp, const plr_scan& scan, std::size_t maximum);
Datagrams json_truth(Envelope& envelope, Stamp stamp, const plr_truth& truth, std::size_t maximum);
Datagrams json_tracks(Envelope& envelope, Stamp stamp, const plr_tracks& tracks, Uncertainty uncertainty,
                      std::size_t maximum);
std::string json_end(Envelope& envelope);
/// Throws UnsupportedError where the scan has a waveform, for which CSV has no column.
Datagrams csv_scan(Envelope& envelope, Stamp stamp, const plr_scan& scan, std::size_t maximum);
std::string csv_end(Envelope& envelope);

/// Entries first ... last - 1, in part number of parts.
struct Share {
    std::int64_t first = 0, last = 0;
    std::uint64_t number = 1, parts = 1;
};
/// Deals entries out so that every datagram that `write` makes of a share fits. `write` takes the sequence number, too.
Datagrams deal(Envelope& envelope, std::int64_t entries, std::size_t maximum,
               const std::function<std::string(const Share&, std::uint64_t sequence)>& write);

/// Throws pelorus::DataError unless the value can be sent.
void require_finite(double value, const char* what, std::int64_t entry);

}  // namespace wire
