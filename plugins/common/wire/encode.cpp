#include "encode.hpp"

#include <algorithm>
#include <cmath>

#include <pelorus/failure.hpp>

#include "frame.hpp"

namespace wire {

Datagrams deal(Envelope& envelope, std::int64_t entries, std::size_t maximum,
               const std::function<std::string(const Share&, std::uint64_t sequence)>& write) {
    for (std::int64_t parts = 1;;) {
        Datagrams out;
        std::size_t largest = 0;
        for (std::int64_t k = 0; k < parts; ++k) {
            const Share share{entries * k / parts, entries * (k + 1) / parts, static_cast<std::uint64_t>(k + 1),
                              static_cast<std::uint64_t>(parts)};
            out.push_back(write(share, envelope.sequence + static_cast<std::uint64_t>(k)));
            largest = std::max(largest, out.back().size());
            if (largest > maximum) break;
        }
        if (largest <= maximum) {
            envelope.sequence += static_cast<std::uint64_t>(parts);
            return out;
        }
        if (parts >= std::max<std::int64_t>(entries, 1) || parts >= static_cast<std::int64_t>(most_parts))
            throw pelorus::DataError("one entry takes " + std::to_string(largest) + " bytes, maximum_datagram is " +
                                     std::to_string(maximum));
        const auto estimate = static_cast<std::int64_t>(largest / maximum);
        parts = std::min({std::max(parts + 1, parts * estimate), entries, static_cast<std::int64_t>(most_parts)});
    }
}

void require_finite(double value, const char* what, std::int64_t entry) {
    if (!std::isfinite(value))
        throw pelorus::DataError(std::string(what) + "[" + std::to_string(entry) +
                                 "] is not finite, and the wire carries finite numbers only");
}

}  // namespace wire
