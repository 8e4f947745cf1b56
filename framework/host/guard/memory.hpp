/// Memory as the guard watches it: fingerprints of what a call must not change, stand-ins for what it may write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pelorus/abi/view.h>

namespace pelorus::host {

/// A fast 64-bit fingerprint, for comparing the same memory before and after a call.
std::uint64_t fingerprint(const void* bytes, std::size_t size) noexcept;
/// Of the elements of a view, whatever lies between them left out.
std::uint64_t fingerprint(const plr_const_view& view) noexcept;

/// Where in a view something is.
struct ElementPlace {
    std::int64_t item, row, col;
};

/// Calls `visit(place, offset in doubles)` for every element; stops and answers true when it does.
template <class View, class Visit> bool any_element(const View& view, Visit&& visit) {
    for (std::int64_t item = 0; item < view.count; ++item)
        for (std::int64_t col = 0; col < view.cols; ++col)
            for (std::int64_t row = 0; row < view.rows; ++row)
                if (visit(ElementPlace{item, row, col},
                          item * view.item_stride + col * view.col_stride + row * view.row_stride))
                    return true;
    return false;
}

/// Memory that stands in for the caller's during one call: of the same strides and alignment, so that results do not change by
/// a bit, filled with a pattern around, between and (unless the content is kept) in the elements.
class StandIn {
public:
    /// For the memory of `view`, whose strides must not be negative. `keeps_content`: the elements start as the caller's, so
    /// that a call may read them, and ones that it leaves alone are no fault. Throws std::bad_alloc.
    StandIn(const plr_view& view, bool keeps_content);
    StandIn(StandIn&&) noexcept = default;
    StandIn& operator=(StandIn&&) noexcept = default;

    double* data() noexcept { return reinterpret_cast<double*>(words_.data() + first_); }
    const plr_view& callers() const noexcept { return callers_; }

    /// Copies what the call wrote to the caller's memory. Once.
    void hand_over() noexcept;
    /// After hand_over: whether the call wrote nothing but elements.
    bool is_intact() const noexcept;
    /// After hand_over: whether some element was left unwritten, and the first of them (in items that `counts` accepts).
    template <class Counts> bool left_out(Counts&& counts, ElementPlace& where) const {
        for (const ElementPlace& place : unwritten_) {
            if (!counts(place.item)) continue;
            where = place;
            return true;
        }
        return false;
    }

private:
    plr_view callers_;
    bool keeps_content_;
    std::vector<std::uint64_t> words_;
    std::size_t first_ = 0;
    std::vector<ElementPlace> unwritten_;
};

}  // namespace pelorus::host
