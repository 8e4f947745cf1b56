/// How an estimator walks through a batch: in blocks, so that its parts are called for many items at once out of a bounded
/// scratch memory, and past items that a part has failed already.
#pragma once

#include <algorithm>

#include <pelorus/batch_model.hpp>

namespace batches {

constexpr std::int64_t block_size = 16;

/// Calls body(call of the block, first item, items) for one block of up to `size` items after another; the body answers a
/// status. Stops at the first status that concerns the whole call.
template <class Body>
plr_status in_blocks(const plr_call& call, std::int64_t count, Body&& body, std::int64_t size = block_size) {
    plr_status result = PLR_OK;
    for (std::int64_t first = 0; first < count; first += size) {
        const plr_status status = body(pelorus::slice(call, first), first, std::min(size, count - first));
        if (status < 0) return status;
        if (status != PLR_OK) result = PLR_ITEMS_FAILED;
    }
    return result;
}

/// pelorus::for_items for the items that no part has failed so far.
template <class Body> plr_status for_good_items(const plr_call& call, std::int64_t count, Body&& body) {
    bool some_failed = false;
    const plr_status status = pelorus::for_items(call, count, [&](std::int64_t i) {
        if (call.item_status != nullptr && call.item_status[i] != PLR_OK) {
            some_failed = true;
            return;
        }
        body(i);
    });
    return status == PLR_OK && some_failed ? static_cast<plr_status>(PLR_ITEMS_FAILED) : status;
}

/// Walks through a prediction in runs of items that stand still (dt = 0) and of items that move, since motions are not called
/// for dt = 0: stand(call, args) and move(call, args) get the items of one run each and answer a status.
template <class Stand, class Move>
plr_status in_runs(const plr_call& call, const plr_estimator_predict& args, Stand&& stand, Move&& move) {
    const auto stands = [&](std::int64_t i) { return args.dt.data[i * args.dt.item_stride] == 0.0; };
    plr_status result = PLR_OK;
    for (std::int64_t first = 0, end = 0; first < args.out.count; first = end) {
        if (args.dt.item_stride == 0) end = args.out.count;
        while (end < args.out.count && stands(end) == stands(first)) ++end;
        plr_estimator_predict run = args;
        run.dt = pelorus::slice(args.dt, first, end - first);
        run.extent = pelorus::slice(args.extent, first, end - first);
        run.record = pelorus::slice(args.record, first, end - first);
        run.out = pelorus::slice(args.out, first, end - first);
        const plr_call here = pelorus::slice(call, first);
        const plr_status status = stands(first) ? stand(here, run) : move(here, run);
        if (status < 0) return status;
        if (status != PLR_OK) result = status;
    }
    return result;
}

/// Goes on after a part's call in which single items may have failed; throws PartFailed for any other failure.
inline void tolerate(plr_status status) {
    if (status < 0) throw pelorus::PartFailed(status);
}

/// Like pelorus::expect; and every item must be packed, as the ABI promises to instances that do not ask for any stride.
template <class View>
void expect_packed(const View& view, std::int64_t rows, std::int64_t cols, std::int64_t count, const char* what) {
    pelorus::expect(view, rows, cols, count, what);
    if ((rows > 1 && view.row_stride != 1) || (cols > 1 && view.col_stride != rows))
        throw pelorus::ArgumentError(std::string(what) + ": its items are not packed (column-major)");
}

/// Where item i of a packed view begins.
inline const double* at(const plr_const_view& view, std::int64_t i) noexcept {
    return view.data + i * view.item_stride;
}
inline double* at(const plr_view& view, std::int64_t i) noexcept { return view.data + i * view.item_stride; }

inline bool all_finite(const double* numbers, std::int64_t count) noexcept {
    double check = 0.0;  // stays 0 unless a number is infinite or NaN
    for (std::int64_t k = 0; k < count; ++k) check += 0.0 * numbers[k];
    return check == 0.0;
}

/// Part of every item of a batch of records, as a view of its own.
inline plr_const_view field(const plr_const_view& records, std::int64_t offset, std::int64_t rows,
                            std::int64_t cols) noexcept {
    return {records.data + offset, rows, cols, records.count, 1, rows, records.item_stride};
}
inline plr_view field(const plr_view& records, std::int64_t offset, std::int64_t rows, std::int64_t cols) noexcept {
    return {records.data + offset, rows, cols, records.count, 1, rows, records.item_stride};
}

}  // namespace batches
