/// How much scratch memory (ABI call.h) the host hands out: with each call of a stage, and to each body of a parallel run.
#pragma once

#include <cstddef>

namespace pelorus::host {

/// The most that a model may ask for (plr_*_info.scratch_bytes), its parts' needs included.
inline constexpr std::size_t most_scratch_of_a_model = std::size_t{16} << 20;
/// What there is: that, and what a stage takes before it calls a model. Pages that nobody touches cost nothing.
inline constexpr std::size_t scratch_bytes = most_scratch_of_a_model + (std::size_t{4} << 20);

}  // namespace pelorus::host
