/// How kernels over lanes (plugins/common/lanes) are handed the items of a block.
///
/// A block is at most block_items items. Arrays of items are packed and column-major; the caller owns them. Each item's Outcome
/// is given as `done` where it is to be worked out; others are left alone. An item that fails tells why there.
#pragma once

#include "outcome.hpp"

#include <cstdint>

namespace gaussian {

constexpr int max_state = 12, max_measurement = 6, block_items = 16;

/// Item i begins at first + i * stride; stride 0: one for all.
struct ItemsIn {
    const double* first;
    std::int64_t stride;
};
/// The same of an output; first may be nullptr: not wanted.
struct ItemsOut {
    double* first;
    std::int64_t stride;
};

}  // namespace gaussian
