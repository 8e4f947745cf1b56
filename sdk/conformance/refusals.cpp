// How a plugin refuses to be created, and what it leaves behind then.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>

#include <fmt/format.h>

#include "machine/bench.hpp"
#include "machine/creation.hpp"
#include "machine/fault_handler.hpp"
#include "machine/library.hpp"
#include "machine/process_state.hpp"
#include "machine/refusal.hpp"
#include "machine/watch.hpp"

namespace pelorus::conformance {

namespace {

constexpr std::size_t most_refusals = 12;

/// Values that the plugin refuses.
struct Refusal {
    std::string title;
    const plr_config& config;
    bool are_described;  ///< false: the host would have refused them by the description
};

/// Calls `attempt(refusal)` for some of them. Skips the check if there are none.
void for_refusals(const Instance& holder, const std::function<void(const Refusal&)>& attempt) {
    const plr_description& description = holder.description();
    std::size_t found = 0;
    const auto try_all = [&](const std::vector<Trial>& trials, bool are_described) {
        for (const Trial& trial : trials) {
            AlteredConfig altered(holder);
            if (found == most_refusals || !apply(trial, description, altered)) continue;
            set_subject_of_fault(trial.title.c_str());
            if (!Creation(holder.plugin(), altered.get()).is_made()) {
                attempt({trial.title, altered.get(), are_described});
                ++found;
            }
            set_subject_of_fault("");
        }
    };
    try_all(trials_within(description), true);
    try_all(trials_outside(description), false);
    if (found == 0) skip("it refuses no value that is tried");
}

}  // namespace

PELORUS_CHECK(
    every, "refusals-are-told", 2,
    "A create that refuses answers a status, the same code in the error, one line of text, and in `where` the "
    "parameter or slot; from that alone the user must find what to change in a config.",
    {"bounds-are-survived", "absurd-values-are-survived"}) {
    const auto holder = bench.make();
    for_refusals(*holder, [&](const Refusal& refusal) {
        const Creation refused(holder->plugin(), refusal.config);
        const std::string problem = refusal_problem(refused, holder->description(), refusal.are_described);
        if (!problem.empty()) FAIL_CHECK("with {" << refusal.title << "}: " << problem);
    });
}

PELORUS_CHECK(
    every, "first-error-is-kept", 2,
    "A create that finds an error told already leaves it alone; otherwise the last of several causes hides the "
    "first.",
    {"bounds-are-survived", "absurd-values-are-survived"}) {
    const auto holder = bench.make();
    for_refusals(*holder, [&](const Refusal& refusal) {
        plr_error error = empty_error();
        error.code = PLR_E_IO;
        std::strcpy(error.message, "the first error");
        std::strcpy(error.where, "elsewhere");
        const plr_error before = error;
        const Creation refused(holder->plugin(), refusal.config, error);
        if (std::memcmp(&before, &error, sizeof error) != 0)
            FAIL_CHECK("with {" << refusal.title << "}: create has overwritten an error that was there before: now "
                                << told(error.code, error));
    });
}

PELORUS_CHECK(
    every, "error-struct-is-respected", 2,
    "create writes into plr_error what it knows and nothing else: not struct_size, not what a later version has behind "
    "it, and nothing beyond the end of one that is shorter than its own.",
    {"bounds-are-survived", "absurd-values-are-survived"}) {
    const auto holder = bench.make();
    for_refusals(*holder, [&](const Refusal& refusal) {
        constexpr std::size_t later = 64;
        std::vector<std::uint64_t> memory((sizeof(plr_error) + later) / sizeof(std::uint64_t), 0xA5A5A5A5A5A5A5A5u);
        auto& error = *reinterpret_cast<plr_error*>(memory.data());
        error = empty_error();
        error.struct_size = sizeof error + later;
        const Creation refused(holder->plugin(), refusal.config, error);
        if (error.struct_size != sizeof error + later)
            FAIL("with {" << refusal.title << "}: create has set error.struct_size to " << error.struct_size);
        for (std::size_t i = sizeof error / sizeof(std::uint64_t); i < memory.size(); ++i)
            if (memory[i] != 0xA5A5A5A5A5A5A5A5u)
                FAIL("with {" << refusal.title << "}: create wrote behind the plr_error that it knows");
        constexpr std::size_t shorter = offsetof(plr_error, where);
        std::fill(memory.begin() + shorter / sizeof(std::uint64_t), memory.end(), 0xA5A5A5A5A5A5A5A5u);
        error.struct_size = shorter;
        error.code = PLR_OK;
        const Creation again(holder->plugin(), refusal.config, error);
        for (std::size_t i = shorter / sizeof(std::uint64_t); i < memory.size(); ++i)
            if (memory[i] != 0xA5A5A5A5A5A5A5A5u)
                FAIL("with {" << refusal.title << "}: create wrote beyond the end of a plr_error whose struct_size is "
                              << shorter);
    });
}

PELORUS_CHECK(
    every, "refusals-leave-nothing", 3,
    "A create that refuses leaves no memory, thread or file behind, and the next one with good values succeeds; a "
    "sweep over parameters refuses often.",
    {"instances-leave-nothing", "bounds-are-survived", "absurd-values-are-survived"}) {
    const auto holder = bench.make();
    for_refusals(*holder, [&](const Refusal& refusal) {
        constexpr int warm_up = 8, count = 30;
        for (int i = 0; i < warm_up; ++i) Creation(holder->plugin(), refusal.config);
        const std::size_t threads = thread_count(), files = open_file_count();
        const std::int64_t blocks = watch::blocks_in_use();
        for (int i = 0; i < count; ++i) Creation(holder->plugin(), refusal.config);
        const std::int64_t more = watch::blocks_in_use() - blocks;
        if (more > 0)
            FAIL_CHECK("with {" << refusal.title << "}: " << count << " refusals left " << more
                                << " blocks of memory behind");
        if (thread_count() > threads || open_file_count() > files)
            FAIL_CHECK("with {" << refusal.title << "}: refusals left threads running or files open");
        const Creation after(holder->plugin(), holder->config());
        if (!after.is_made())
            FAIL("after a refusal (with {" << refusal.title << "}) a create with good values: " << after.told());
    });
}

}  // namespace pelorus::conformance
