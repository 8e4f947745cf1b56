/// Blocks of items, as kernels over lanes take them.
#pragma once

#include "../batches/batches.hpp"
#include "items.hpp"

#include <array>

namespace gaussian {

static_assert(block_items == batches::block_size);

using Outcomes = std::array<Outcome, block_items>;

/// The items of a block that no part has failed so far are to be worked out.
inline Outcomes still_good(const plr_call& call, std::int64_t items) noexcept {
    Outcomes out{};
    for (std::int64_t i = 0; i < items && call.item_status != nullptr; ++i)
        if (call.item_status[i] != PLR_OK) out[static_cast<std::size_t>(i)] = Outcome::not_finite;
    return out;
}

inline bool all_done(const Outcomes& outcomes, std::int64_t items) noexcept {
    bool done = true;
    for (std::int64_t i = 0; i < items; ++i) done &= outcomes[static_cast<std::size_t>(i)] == Outcome::done;
    return done;
}

/// Fails the items that a kernel could not work out.
inline plr_status settled(const plr_call& call, std::int64_t items, const Outcomes& outcomes) {
    if (all_done(outcomes, items)) return PLR_OK;
    return batches::for_good_items(call, items,
                                   [&](std::int64_t i) { require(outcomes[static_cast<std::size_t>(i)]); });
}

/// The items of a view from `first` on, as kernels take them.
inline ItemsIn items_of(const plr_const_view& view, std::int64_t first = 0, bool common = false) noexcept {
    return {batches::at(view, first), common ? 0 : view.item_stride};
}
inline ItemsOut items_of(const plr_view& view, std::int64_t first = 0) noexcept {
    if (view.data == nullptr) return {nullptr, 0};
    return {batches::at(view, first), view.item_stride};
}

}  // namespace gaussian
