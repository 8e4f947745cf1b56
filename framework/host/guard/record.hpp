/// What the guard knows of one instance.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pelorus/abi/plugin.h>

#include "host/guard/fault.hpp"
#include "host/guard/mode.hpp"

namespace pelorus::host {

/// The sizes that an instance's info tells, by the letters of the ABI headers; 0 where a kind has none.
struct GuardSizes {
    std::int64_t n = 0, c = 0, m = 0, i = 0, w = 0, r = 0, d = 0, o = 0, h = 0;
    std::int64_t flags = 0, version = 0, scratch = 0;
    std::int64_t least_d = 0;      ///< partitioners answer several dimensions
    std::vector<std::int64_t> ms;  ///< estimators: m of each sensor

    /// "" where all are the same; otherwise `info() answers 9 state components, it answered 6 when the instance was made`.
    static std::string difference(const GuardSizes& made_with, const GuardSizes& now);
};

/// Immutable but for counters. Lives as long as its instance.
struct GuardRecord {
    static constexpr std::size_t most_functions = 8;

    std::string address, plugin;  ///< `tracker.estimator.motion`, `motion.singer`
    std::string holder;           ///< address of the instance whose slot it stands in
    plr_instance real{};          ///< the plugin's own
    GuardMode mode = GuardMode::start;
    std::int64_t input_size = 0;     ///< doubles an item in plr_call.inputs
    bool cells_may_overlap = false;  ///< partitioners
    std::shared_ptr<FaultLatch> latch;
    GuardSizes sizes;  ///< when the instance was made
    GuardSizes (*ask_sizes)(const plr_instance&) = nullptr;
    const void* info = nullptr;              ///< what info() answered then
    std::unique_ptr<unsigned char[]> table;  ///< the guard table that holders get
    mutable std::array<std::atomic<std::uint32_t>, most_functions> calls{};

    const plr_table_head* guard_table() const noexcept { return reinterpret_cast<const plr_table_head*>(table.get()); }
    /// Whether this call of the function is one of those to be checked; counts it.
    bool is_to_check(std::size_t function) const noexcept {
        constexpr std::uint32_t checked_at_start = 16;
        if (mode == GuardMode::all) return true;
        std::atomic<std::uint32_t>& made = calls[function];
        return made.load(std::memory_order_relaxed) < checked_at_start &&
               made.fetch_add(1, std::memory_order_relaxed) < checked_at_start;
    }
    /// `tracker.estimator.motion (motion.singer), propagate`
    std::string call_name(const char* function) const { return address + " (" + plugin + "), " + function; }
    /// Latches a fault and tells it in `error`, over whatever the part told. Answers `code`.
    plr_status fail(plr_error* error, plr_status code, std::int64_t item, const std::string& line) const noexcept;
};

}  // namespace pelorus::host
