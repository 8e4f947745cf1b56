// One call of a model, made with memory that watches the plugin.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <deque>
#include <memory>

#include <catch2/catch.hpp>
#include <time.h>

#include "guarded_memory.hpp"
#include "hot_call.hpp"
#include "library.hpp"

namespace pelorus::conformance {

namespace {

std::size_t at(std::int64_t index) noexcept { return static_cast<std::size_t>(index); }

/// Processor time that this process has used so far, in s.
double processor_time() noexcept {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// Room behind arrays where nobody asks what is written past their end, in doubles.
constexpr std::int64_t slack = 512;

/// One argument in memory, laid out as the options ask.
class Placed {
public:
    Placed(const Argument& argument, std::int64_t count, const std::string& function, const ExecuteOptions& options,
           bool is_input)
        : argument_(argument), count_(count) {
        matrices_ = !argument.offsets.empty() ? argument.offsets[at(count)]
                    : argument.is_common      ? std::min<std::int64_t>(1, count)
                                              : count;
        size_ = argument.rows * argument.cols;
        stride_ = size_ + options.gap;
        row_stride_ = options.transposed ? argument.cols : 1;
        col_stride_ = options.transposed ? 1 : argument.rows;
        const std::int64_t doubles = matrices_ == 0 ? 0 : (matrices_ - 1) * stride_ + size_;
        is_null_ = count == 0 && options.is_null_if_empty;
        if (options.is_guarded && (is_input || !options.has_slack)) {
            guarded_.emplace(at(doubles), ZoneName{function, argument.name},
                             is_input ? Lent::for_reading : Lent::for_writing);
            data_ = guarded_->data();
        } else {
            plain_.assign(at(doubles + (is_input ? 0 : slack)), GuardedMemory::pattern());
            data_ = plain_.data();
        }
        if (!is_input) return;
        double* const fill = guarded_ ? guarded_->fill() : data_;
        for (std::int64_t m = 0; m < matrices_; ++m)
            for (std::int64_t e = 0; e < size_; ++e)
                fill[offset(m, e % argument.rows, e / argument.rows)] = argument.values[at(m * size_ + e)];
    }

    plr_view view() const {
        if (argument_.is_absent) return {nullptr, 0, 0, 0, 0, 0, 0};
        const bool ragged = !argument_.offsets.empty();
        return {is_null_ ? nullptr : data_,       argument_.rows, argument_.cols,
                ragged ? matrices_ : count_,      row_stride_,    col_stride_,
                argument_.is_common ? 0 : stride_};
    }
    plr_const_view const_view() const {
        const plr_view v = view();
        return {v.data, v.rows, v.cols, v.count, v.row_stride, v.col_stride, v.item_stride};
    }

    /// What the call wrote, packed; and what it wrote where it should not have.
    std::vector<double> collect(std::vector<std::string>& stray) const {
        std::vector<double> packed(at(matrices_ * size_));
        for (std::int64_t m = 0; m < matrices_; ++m) {
            for (std::int64_t e = 0; e < size_; ++e)
                packed[at(m * size_ + e)] = data_[offset(m, e % argument_.rows, e / argument_.rows)];
            if (m + 1 == matrices_) continue;
            for (std::int64_t g = size_; g < stride_; ++g)
                if (!GuardedMemory::is_pattern(data_[m * stride_ + g]))
                    stray.push_back("`" + argument_.name + "`: written " + std::to_string(g - size_ + 1) +
                                    " doubles past item " + std::to_string(m) + ", between two items");
        }
        if (guarded_ && !guarded_->is_intact_before())
            stray.push_back("`" + argument_.name + "`: written before its first element");
        return packed;
    }

private:
    std::int64_t offset(std::int64_t matrix, std::int64_t row, std::int64_t col) const noexcept {
        return matrix * stride_ + row * row_stride_ + col * col_stride_;
    }
    const Argument& argument_;
    std::int64_t count_, matrices_ = 0, size_ = 0, stride_ = 0, row_stride_ = 1, col_stride_ = 1;
    std::optional<GuardedMemory> guarded_;
    std::vector<double> plain_;
    double* data_ = nullptr;
    bool is_null_ = false;
};

/// Scratch memory of exactly the size that info asks for, aligned to 64 bytes, with a guard page behind it.
class ScratchMemory {
public:
    ScratchMemory(std::uint64_t bytes, const std::string& function, const ExecuteOptions& options) {
        const std::uint64_t rounded = (bytes + 63) / 64 * 64;  // so that its beginning is aligned; the size is not
        const std::size_t doubles = rounded / sizeof(double) + (options.has_slack ? at(slack) : 0);
        if (options.is_guarded) {
            guarded_.emplace(doubles, ZoneName{function, "scratch memory"});
            scratch_.data = reinterpret_cast<unsigned char*>(guarded_->data());
        } else {
            plain_.resize(doubles * sizeof(double) + 64);
            const auto address = reinterpret_cast<std::uintptr_t>(plain_.data());
            scratch_.data = plain_.data() + (64 - address % 64) % 64;
        }
        scratch_.size = options.has_slack ? doubles * sizeof(double) : bytes;
        has_rest_ = options.is_guarded && !options.has_slack;
        rounded_ = rounded;
        for (std::uint64_t i = bytes; has_rest_ && i < rounded; ++i) scratch_.data[i] = rest_mark;
    }
    plr_scratch* get() noexcept { return &scratch_; }

    /// What the call wrote between the end and the guard page.
    void collect(std::vector<std::string>& stray) const {
        if (!has_rest_) return;
        for (std::uint64_t i = rounded_; i > scratch_.size; --i)
            if (scratch_.data[i - 1] != rest_mark) {
                stray.push_back("scratch memory: written " + std::to_string(i - scratch_.size) + " bytes past its end");
                return;
            }
    }

private:
    static constexpr unsigned char rest_mark = 0xA5;
    bool has_rest_ = false;
    std::uint64_t rounded_ = 0;
    std::optional<GuardedMemory> guarded_;
    std::vector<unsigned char> plain_;
    plr_scratch scratch_{};
};

/// Leaves that byte wherever the next call will have its variables.
[[gnu::noinline]] void fill_stack(unsigned char byte) {
    unsigned char below[1 << 16];
    std::memset(below, byte, sizeof below);
    asm volatile("" : : "r"(below) : "memory");  // nobody reads it: the compiler would leave it out
}

/// A struct of the caller's, with room behind it for what a later version adds.
template <class Struct> struct Longer {
    Struct known{};
    unsigned char later[64] = {};
};

}  // namespace

Execution execute(const Instance& instance, const HotCall& hot, const ExecuteOptions& options) {
    std::deque<Placed> in, out;
    Views views;
    std::deque<std::vector<std::int64_t>> offsets;
    for (const Argument& argument : hot.in) {
        in.emplace_back(argument, hot.count, hot.function, options, true);
        views.in.push_back(in.back().const_view());
        offsets.push_back(argument.offsets);
        views.offsets.push_back(argument.offsets.empty() ? nullptr : offsets.back().data());
    }
    for (const Argument& argument : hot.out) {
        out.emplace_back(argument, hot.count, hot.function, options, false);
        views.out.push_back(out.back().view());
    }
    Execution done;
    done.items.assign(options.without_item_status ? 0 : at(hot.count), PLR_OK);
    ScratchMemory scratch(scratch_bytes(instance) + hot.scratch_beyond, hot.function, options);
    std::vector<plr_key> keys;
    for (std::int64_t i = 0; i < hot.count; ++i) {
        const std::uint64_t id = options.item_ids.empty() ? static_cast<std::uint64_t>(i) : options.item_ids[at(i)];
        keys.push_back({{0x5DEECE66Du + id, 0xB5297A4Du}});
    }
    const std::vector<double>& inputs = options.inputs.empty() ? instance.inputs() : options.inputs;
    Longer<plr_error> error{empty_error(), {}};
    error.known.struct_size += options.extra_struct_bytes;
    Longer<plr_call> longer;
    plr_call& call = longer.known;
    call.struct_size = static_cast<std::uint32_t>(sizeof call) + options.extra_struct_bytes;
    call.time = 1'000'000'000;
    call.item_ids = options.item_ids.empty() ? nullptr : options.item_ids.data();
    call.keys = keys.data();
    call.inputs = inputs.empty() || options.without_inputs ? nullptr : inputs.data();
    call.input_stride = options.input_stride;
    call.item_offset = options.item_offset;
    call.scratch = scratch.get();
    call.error = &error.known;
    call.item_status = options.without_item_status ? nullptr : done.items.data();
    const double used = processor_time();
    const auto start = std::chrono::steady_clock::now();
    watch::Guard guard(options.watch);
    if (options.stack_of) fill_stack(*options.stack_of);
    try {
        done.status = hot.invoke(call, views);
        done.offence = guard.end();
    } catch (...) {
        done.offence = guard.end();
        done.left_by = exception_text();
    }
    done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    // Of a long call the processor time counts: a busy machine is no fault of the plugin's. A short one takes less than the
    // asking.
    done.seconds = std::min(done.seconds, processor_time() - used);
    done.error = error.known;
    done.scratch_left_used = scratch.get()->used;
    for (const Placed& placed : out) done.out.push_back(placed.collect(done.stray));
    scratch.collect(done.stray);
    return done;
}

Execution execute_leniently(const Instance& instance, const HotCall& call) {
    ExecuteOptions options;
    options.is_guarded = false;
    options.has_slack = true;
    return execute(instance, call, options);
}

Execution execute_well(const Instance& instance, const HotCall& call, const ExecuteOptions& options) {
    Execution done = execute(instance, call, options);
    if (!done.left_by.empty()) FAIL(call.function << " was left by " << done.left_by);
    if (done.status == PLR_ITEMS_FAILED && call.may_refuse) return done;
    if (done.status != PLR_OK) FAIL(call.function << " answered " << done.told());
    return done;
}

}  // namespace pelorus::conformance
