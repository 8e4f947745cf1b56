/// What ranks tell each other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/ranks.hpp"
#include "campaign/workers.hpp"

namespace pelorus::campaign {

/// From a rank to rank 0.
struct RankReport {
    std::string identity;            ///< what it computes; in its first report alone
    std::vector<Computed> computed;  ///< what has become of blocks that it was given
    std::uint32_t wanted = 0;        ///< how many more it could take
};

/// From rank 0 to a rank.
struct RankOrder {
    std::vector<Unit> units;
    bool is_last = false;  ///< the rank may go
};

Ranks::Bytes report_bytes(const RankReport& report);
/// Throws CorruptBytes.
RankReport report_from(const Ranks::Bytes& bytes);
Ranks::Bytes order_bytes(const RankOrder& order);
/// Throws CorruptBytes.
RankOrder order_from(const Ranks::Bytes& bytes);

}  // namespace pelorus::campaign
