/// The items of a block that lanes hold at a time. For sources that pelorus_add_lanes compiles.
#pragma once

#include "../lanes/factors.hpp"
#include "items.hpp"

namespace gaussian {

inline namespace PELORUS_LANES {

using lanes::all;
using lanes::any;
using lanes::Fixed;
using lanes::Mask;
using lanes::Pack;
using lanes::width;

/// The size that arrays have for states or measurements of size N.
template <class N> constexpr int most_states = max_state;
template <int N> constexpr int most_states<Fixed<N>> = N;
template <class M> constexpr int most_measured = max_measurement;
template <int M> constexpr int most_measured<Fixed<M>> = M;

/// Room for `count` numbers an item, in whole squares of lanes: GCC 12 sees loads and stores of as many numbers as there are lanes
/// run over the end of smaller arrays, where a size is not known to it.
constexpr int room(int count) noexcept { return (count + width - 1) / width * width; }

/// What stands in the lanes without an item: no covariance, no noise, no numbers that would slow the processor down.
const double nothing[max_state * (2 * max_state + 1)] = {};

/// Which items of a block the lanes hold: goes through it, as many at once as there are lanes.
struct Group {
    const Outcome* outcome;
    int items;  // of the block
    int first = 0;

    bool is_left() const noexcept { return first < items; }
    void next() noexcept { first += width; }
    bool has(int lane) const noexcept { return first + lane < items; }
    bool holds(int lane) const noexcept { return has(lane) && outcome[first + lane] == Outcome::done; }
    bool holds_all() const noexcept {
        if (!has(width - 1)) return false;
        int failed = 0;
        for (int lane = 0; lane < width; ++lane) failed |= static_cast<int>(outcome[first + lane]);
        return failed == 0;
    }
};
static_assert(static_cast<int>(Outcome::done) == 0);

/// Numbers of a record: mean and covariance.
template <class N> constexpr auto numbers_of_record(N states) noexcept {
    return lanes::plus(states, lanes::times(states, states));
}

/// Count is at most that of `nothing`. What is common to all items stands in the lanes without one, too.
template <class Count> inline void load_items(const ItemsIn& from, const Group& group, Count count, Pack* to) noexcept {
    if (from.stride == 0) {
        for (int e = 0; e < count; ++e) to[e] = all(from.first[e]);
        return;
    }
    const bool complete = group.holds_all();
    const double* item[width];
    for (int lane = 0; lane < width; ++lane)
        item[lane] = complete || group.holds(lane) ? from.first + (group.first + lane) * from.stride : nothing;
    lanes::load(item, count, to);
}

template <class Count>
inline void store_items(const Pack* from, Count count, const Group& group, const ItemsOut& to) noexcept {
    const bool complete = group.holds_all();
    double* item[width];
    for (int lane = 0; lane < width; ++lane)
        item[lane] = complete || group.holds(lane) ? to.first + (group.first + lane) * to.stride : nullptr;
    lanes::store(from, count, item);
}

/// Into all items, those that have failed too: what a part is asked about must be numbers.
template <class Count>
inline void store_all(const Pack* from, Count count, const Group& group, const ItemsOut& to) noexcept {
    double* item[width];
    for (int lane = 0; lane < width; ++lane)
        item[lane] = group.has(lane) ? to.first + (group.first + lane) * to.stride : nullptr;
    lanes::store(from, count, item);
}

/// Notes why lanes failed, unless they did before.
inline void note(const Group& group, const Mask& failed, Outcome why, Outcome* outcome) noexcept {
    if (!any(failed)) return;
    for (int lane = 0; lane < width; ++lane)
        if (failed[lane] != 0 && group.holds(lane)) outcome[group.first + lane] = why;
}

/// 0 unless a number is infinite or NaN.
inline Pack check_finite(int count, const Pack* numbers) noexcept {
    Pack check{};
    for (int e = 0; e < count; ++e) check += 0.0 * numbers[e];
    return check;
}

// Numbers that one kernel leaves for the next: of a group of items, element after element, lane beside lane.

/// Where the group's begin, of `size` doubles an item.
inline double* beside(double* memory, const Group& group, int size) noexcept { return memory + group.first * size; }
inline const double* beside(const double* memory, const Group& group, int size) noexcept {
    return memory + group.first * size;
}
inline void keep(const Pack* from, int count, double* memory) noexcept {
    __builtin_memcpy(memory, from, static_cast<unsigned long>(count) * sizeof(Pack));
}
inline void recall(const double* memory, int count, Pack* to) noexcept {
    __builtin_memcpy(to, memory, static_cast<unsigned long>(count) * sizeof(Pack));
}

}  // namespace PELORUS_LANES

}  // namespace gaussian
