/// Blocks of items, as the kernels take them.
#pragma once

#include "kalman.hpp"

namespace kalman {

using Outcomes = std::array<Outcome, block_items>;

/// The items of a block that no part has failed so far are to be worked out.
inline Outcomes still_good(const plr_call& call, std::int64_t items) noexcept {
    Outcomes out{};
    for (std::int64_t i = 0; i < items && call.item_status != nullptr; ++i)
        if (call.item_status[i] != PLR_OK) out[static_cast<std::size_t>(i)] = Outcome::not_finite;
    return out;
}

/// The items of a view from `first` on, as kernels take them.
inline ItemsIn items_of(const plr_const_view& view, std::int64_t first, bool common = false) noexcept {
    return {at(view, first), common ? 0 : view.item_stride};
}
inline ItemsOut items_of(const plr_view& view, std::int64_t first) noexcept {
    if (view.data == nullptr) return {nullptr, 0};
    return {at(view, first), view.item_stride};
}

}  // namespace kalman
