#include "host/guard/checked_call.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/plugin_error.hpp"

namespace pelorus::host {

namespace {

bool is_legal(plr_status status) noexcept { return status >= PLR_E_EXCEPTION && status <= PLR_ITEMS_FAILED; }

bool has_bad_strides(std::int64_t rows, std::int64_t cols, std::int64_t count, std::int64_t row_stride,
                     std::int64_t col_stride, std::int64_t item_stride) {
    return rows < 0 || cols < 0 || count < 0 || row_stride < 0 || col_stride < 0 || item_stride < 0;
}

template <class View> void expect_strides(const char* name, const View& view) {
    if (has_bad_strides(view.rows, view.cols, view.count, view.row_stride, view.col_stride, view.item_stride))
        throw BrokenContract(fmt::format("{} has a negative size or stride", name), -1, true);
}

}  // namespace

// ------------------------------------------------------------------------------------------- before the call

void CheckedCall::items(std::int64_t count) {
    if (count < 0) throw BrokenContract(fmt::format("the batch has {} items", count), -1, true);
    items_ = count;
}

void CheckedCall::expect(const char* name, std::int64_t rows, std::int64_t cols, std::int64_t count,
                         std::int64_t wanted_rows, std::int64_t wanted_cols, std::int64_t wanted_count) const {
    if (wanted_rows == any_size) wanted_rows = rows;
    if (wanted_cols == any_size) wanted_cols = cols;
    if (rows == wanted_rows && cols == wanted_cols && count == wanted_count) return;
    throw BrokenContract(fmt::format("{} is {} x {} x {}, expected {} x {} x {}", name, rows, cols, count, wanted_rows,
                                     wanted_cols, wanted_count),
                         -1, true);
}

void CheckedCall::add_input(const char* name, const plr_const_view& view, bool per_item, bool excuses) {
    inputs_.push_back({name, view, fingerprint(view), per_item, excuses});
}

void CheckedCall::input(const char* name, const plr_const_view& view, std::int64_t rows, std::int64_t cols) {
    if (view.data == nullptr) return;
    expect_strides(name, view);
    expect(name, view.rows, view.cols, view.count, rows, cols, items_);
    add_input(name, view, true, true);
}

void CheckedCall::record(const char* name, const plr_const_view& view, std::int64_t rows) {
    if (view.data == nullptr || rows == 0) return;
    expect_strides(name, view);
    expect(name, view.rows, view.cols, view.count, rows, 1, items_);
    add_input(name, view, true, false);
}

void CheckedCall::shared_input(const char* name, const plr_const_view& view, std::int64_t rows, std::int64_t cols,
                               std::int64_t count) {
    if (view.data == nullptr) return;
    expect_strides(name, view);
    expect(name, view.rows, view.cols, view.count, rows, cols, count);
    add_input(name, view, false, true);
}

void CheckedCall::bytes(const char* name, const void* data, std::size_t size) {
    if (data != nullptr && size > 0) bytes_.push_back({name, data, size, fingerprint(data, size)});
}

void CheckedCall::add_output(const char* name, plr_view& view, Content content, bool per_item, bool keeps_content) {
    if (view.data == nullptr) return;
    outputs_.push_back({name, StandIn(view, keeps_content || content == Content::opaque), content, per_item});
    view.data = outputs_.back().memory.data();
}

void CheckedCall::output(const char* name, plr_view& view, std::int64_t rows, std::int64_t cols, Content content) {
    if (view.data == nullptr) return;
    expect_strides(name, view);
    expect(name, view.rows, view.cols, view.count, rows, cols, items_);
    add_output(name, view, content, true);
}

void CheckedCall::shared_output(const char* name, plr_view& view, std::int64_t rows, std::int64_t cols,
                                std::int64_t count, Content content) {
    if (view.data == nullptr) return;
    expect_strides(name, view);
    expect(name, view.rows, view.cols, view.count, rows, cols, count);
    add_output(name, view, content, false);
}

void CheckedCall::record_output(const char* name, plr_view& view, std::int64_t rows, const char* in_name,
                                plr_const_view& in) {
    const double* const callers = view.data;
    if (in.data == nullptr || in.data != callers) record(in_name, in, rows);
    if (rows == 0) return;
    output(name, view, rows, 1, Content::opaque);
    if (in.data != nullptr && in.data == callers) in.data = view.data;
}

void CheckedCall::begin() {
    const auto n = static_cast<std::size_t>(items_);
    bytes("the call's item ids", call_.item_ids, n * sizeof(std::uint64_t));
    bytes("the call's keys", call_.keys, n * sizeof(plr_key));
    if (call_.inputs != nullptr && record_.input_size > 0)
        add_input("the call's inputs",
                  {call_.inputs, record_.input_size, 1, items_, 1, record_.input_size, call_.input_stride}, true, true);
    if (call_.scratch != nullptr) scratch_used_ = call_.scratch->used;
    if (call_.item_status != nullptr) status_before_.assign(call_.item_status, call_.item_status + items_);
}

// -------------------------------------------------------------------------------------------- after the call

void CheckedCall::end(plr_status status, bool threw) {
    for (Output& output : outputs_) output.memory.hand_over();
    check_memory();
    if (threw) return;
    if (call_.scratch != nullptr && call_.scratch->used != scratch_used_) {
        const std::uint64_t left = call_.scratch->used;
        call_.scratch->used = scratch_used_;
        throw BrokenContract(
            fmt::format("scratch.used is {} after the call, it was {} before: what is taken has to be given back", left,
                        scratch_used_));
    }
    check_status(status);
    const std::string difference = GuardSizes::difference(record_.sizes, record_.ask_sizes(record_.real));
    if (!difference.empty()) throw BrokenContract(difference + "; it has to be constant");
    if (status < 0) return;
    for (const Output& output : outputs_) check_output(output);
}

void CheckedCall::check_memory() {
    for (const Output& output : outputs_)
        if (!output.memory.is_intact())
            throw BrokenContract(fmt::format("it wrote outside {}, which is {} x {} x {}", output.name,
                                             output.memory.callers().rows, output.memory.callers().cols,
                                             output.memory.callers().count));
    for (const Input& input : inputs_)
        if (fingerprint(input.view) != input.before)
            throw BrokenContract(fmt::format("it changed its input {}", input.name));
    for (const Bytes& one : bytes_)
        if (fingerprint(one.data, one.size) != one.before)
            throw BrokenContract(fmt::format("it changed its input {}", one.name));
}

void CheckedCall::check_status(plr_status status) const {
    if (!is_legal(status))
        throw BrokenContract(
            fmt::format("it answered status {}, expected PLR_OK, PLR_ITEMS_FAILED or PLR_E_... (1 to {})", status,
                        static_cast<int>(PLR_E_EXCEPTION)));
    if (call_.item_status == nullptr || status < 0) return;
    bool any_failed = false;
    for (std::int64_t i = 0; i < items_; ++i) {
        const plr_status now = call_.item_status[i];
        if (!is_legal(now))
            throw BrokenContract(fmt::format("its item_status is {}, expected PLR_OK or PLR_E_...", now), i);
        any_failed = any_failed || now != PLR_OK;
        if (status == PLR_OK && now != PLR_OK && status_before_[static_cast<std::size_t>(i)] == PLR_OK)
            throw BrokenContract(
                fmt::format("its item_status is {}, but the call answered PLR_OK, expected PLR_ITEMS_FAILED",
                            status_name(now)),
                i);
    }
    if (status == PLR_ITEMS_FAILED && !any_failed)
        throw BrokenContract("it answered PLR_ITEMS_FAILED, but the item_status of every item is PLR_OK");
}

bool CheckedCall::item_counts(std::int64_t item) const noexcept {
    return call_.item_status == nullptr || item >= items_ || call_.item_status[item] == PLR_OK;
}

bool CheckedCall::inputs_are_finite(std::int64_t item) const noexcept {
    return std::none_of(inputs_.begin(), inputs_.end(), [item](const Input& input) {
        if (!input.excuses) return false;
        plr_const_view view = input.view;
        if (input.per_item) {
            view.data += item * view.item_stride;
            view.count = 1;
        }
        return any_element(view, [&](const ElementPlace&, std::int64_t at) { return !std::isfinite(view.data[at]); });
    });
}

void CheckedCall::check_output(const Output& output) const {
    if (output.content == Content::opaque) return;
    const plr_view& view = output.memory.callers();
    const auto counts = [&](std::int64_t item) { return output.per_item ? item_counts(item) : true; };
    ElementPlace place{};
    const auto fault = [&](const std::string& text) {
        return BrokenContract(fmt::format("{} {} (row {}, column {})", output.name, text, place.row, place.col),
                              output.per_item ? place.item : -1);
    };
    if (output.memory.left_out(counts, place)) throw fault("was not written");
    if (output.content == Content::any) return;
    std::int64_t excused = -1;  // item
    const bool is_bad = any_element(view, [&](const ElementPlace& at, std::int64_t offset) {
        place = at;
        const double value = view.data[offset];
        if (at.item == excused || std::isfinite(value)) return false;
        if (output.content == Content::not_nan && !std::isnan(value)) return false;
        if (counts(at.item) && inputs_are_finite(output.per_item ? at.item : 0)) return true;
        excused = at.item;
        return false;
    });
    if (is_bad)
        throw fault(fmt::format(
            "is {}, expected {}",
            view.data[place.item * view.item_stride + place.col * view.col_stride + place.row * view.row_stride],
            output.content == Content::not_nan ? "a number" : "a finite number"));
    if (output.content != Content::covariance) return;
    for (std::int64_t item = 0; item < view.count; ++item)
        if (counts(item) && inputs_are_finite(output.per_item ? item : 0)) check_covariance(output, item);
}

void CheckedCall::check_covariance(const Output& output, std::int64_t item) const {
    constexpr double rounding = 1e-6, of_the_largest = 1e-12;
    const plr_view& view = output.memory.callers();
    const auto at = [&](std::int64_t row, std::int64_t col) {
        return view.data[item * view.item_stride + col * view.col_stride + row * view.row_stride];
    };
    double largest = 0;
    for (std::int64_t i = 0; i < view.rows; ++i)
        for (std::int64_t j = 0; j < view.cols; ++j) largest = std::max(largest, std::abs(at(i, j)));
    for (std::int64_t i = 0; i < view.rows; ++i) {
        if (at(i, i) < -of_the_largest * largest)
            throw BrokenContract(fmt::format("{} has {} on its diagonal (row {}), expected no negative variance",
                                             output.name, at(i, i), i),
                                 item);
        for (std::int64_t j = 0; j < i; ++j) {
            const double allowed =
                rounding * std::sqrt(std::abs(at(i, i))) * std::sqrt(std::abs(at(j, j))) + of_the_largest * largest;
            if (std::abs(at(i, j) - at(j, i)) > allowed)
                throw BrokenContract(
                    fmt::format("{} is not symmetric: {} at row {}, column {}, but {} at row {}, column {}",
                                output.name, at(i, j), i, j, at(j, i), j, i),
                    item);
        }
    }
}

}  // namespace pelorus::host
