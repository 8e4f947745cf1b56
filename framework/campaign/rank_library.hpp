/// What libpelorus-mpi.so offers to libpelorus.so. Both come from one build.
#pragma once

#include "campaign/ranks.hpp"

namespace pelorus::campaign {

inline constexpr const char* rank_library_name = "libpelorus-mpi.so";
inline constexpr const char* rank_library_function = "pelorus_open_ranks_1";

/// Answers a new object. Throws Error.
using OpenRanks = Ranks*();

}  // namespace pelorus::campaign
