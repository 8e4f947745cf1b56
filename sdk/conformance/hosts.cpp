// Hosts that differ from ours: of an earlier or later minor version, or without some of the services.
#include <cstddef>
#include <cstring>

#include <fmt/format.h>

#include "machine/answers.hpp"
#include "machine/bench.hpp"
#include "machine/creation.hpp"
#include "machine/fault_handler.hpp"
#include "machine/hot_call.hpp"
#include "machine/library.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

/// Makes the instance without those services and lets it work. It may decline, if it says for want of what.
void try_without(const Bench& bench, const std::set<std::string>& withheld, const std::string& title) {
    Services services(bench.host());
    services.withheld = withheld;
    Surroundings surroundings;
    surroundings.services = &services;
    set_subject_of_fault(title.c_str());
    try {
        const auto instance = bench.try_make("", surroundings);
        answers_of(*instance, bench.sample());
    } catch (const CreateFailed& failed) {
        const std::string told = failed.what();
        if (failed.status != PLR_E_UNSUPPORTED)
            FAIL_CHECK(title << ": create answered " << told << "; expected an instance or PLR_E_UNSUPPORTED");
        bool names_one = false;
        for (const std::string& each : services.asked_for)
            if (withheld.count(each) + withheld.count("*") != 0)
                names_one = names_one || told.find(each) != std::string::npos;
        if (!names_one) FAIL_CHECK(title << ": create answered " << told << ", which names no missing service");
    }
    set_subject_of_fault("");
}

constexpr std::uint32_t longer_structs[] = {8, 40};

std::string stepping_problem(std::uint32_t extra, const std::string& difference) {
    return fmt::format("an instance of a config whose structs are {} bytes longer answers otherwise: {}", extra,
                       difference);
}

/// What a stage answers is what it publishes and writes.
void try_stepping_of_stage(const Bench& bench) {
    const Script script = plain_script(bench);
    const auto played = [&](std::uint32_t extra) {
        PlayOptions options;
        options.extra_struct_bytes = extra;
        StagePlayer player(bench, options);
        play(player, script);
        player.finish_well();
        return trace_of(player);
    };
    const Trace expected = played(0);
    for (const std::uint32_t extra : longer_structs) {
        const std::string difference = difference_of(expected, played(extra));
        if (!difference.empty()) FAIL(stepping_problem(extra, difference));
    }
}

}  // namespace

PELORUS_CHECK(
    every, "services-may-be-missing", 2,
    "Without one or all of the host's services an instance does without, or create answers PLR_E_UNSUPPORTED and names "
    "the one that it needs; small hosts offer few.",
    {"instance-is-accepted", "calls-come-back"}) {
    std::set<std::string> used;
    {
        Services services(bench.host());
        Surroundings surroundings;
        surroundings.services = &services;
        bench.make(surroundings);
        used = services.asked_for;
    }
    for (const std::string& id : used) try_without(bench, {id}, "host without " + id);
    try_without(bench, {"*"}, "host without services");
}

PELORUS_CHECK(
    every, "config-is-stepped", 3,
    "Arrays of structs in a config are stepped through by the struct_size of their first element, not by sizeof; a "
    "host of a later minor version has longer structs, and the second parameter would be read from within the first.",
    {"instance-is-accepted", "same-bytes-of-another-instance", "stage-same-bytes-again"}) {
    const std::string expected = answers_of(*bench.make(), bench.sample());
    for (const std::uint32_t extra : longer_structs) {
        Surroundings surroundings;
        surroundings.extra_struct_bytes = extra;
        const auto instance = bench.make(surroundings);
        const std::string difference = first_difference(expected, answers_of(*instance, bench.sample()));
        if (!difference.empty()) FAIL(stepping_problem(extra, difference));
    }
    if (std::strcmp(bench.plugin().table_id, PLR_STAGE) == 0) try_stepping_of_stage(bench);
}

PELORUS_CHECK(every, "short-config-is-refused", 2,
              "A config whose struct_size is less than PLR_CONFIG_LEAST_SIZE is refused, whoever made it: what lies "
              "behind its end is not the host's word. A longer one, if not as long as the plugin's own, is that of an "
              "earlier host.",
              {"instance-is-accepted"}) {
    const auto holder = bench.make();
    for (const std::size_t size : {std::size_t{8}, offsetof(plr_config, parts), PLR_CONFIG_LEAST_SIZE - 8}) {
        plr_config config = holder->config();
        config.struct_size = static_cast<std::uint32_t>(size);
        const Creation made(holder->plugin(), config);
        if (!made.left_by().empty() || made.status() >= 0)
            FAIL("with config.struct_size " << size << " (every plr_config has " << PLR_CONFIG_LEAST_SIZE
                                            << " bytes): " << made.told() << "; expected PLR_E_ARGUMENT");
    }
}

PELORUS_CHECK(
    every, "later-host-is-accepted", 2,
    "A host of a later minor version, whose structs and tables are longer, is as good as ours: minor versions only "
    "add.",
    {"instance-is-accepted"}) {
    Services services(bench.host());
    services.abi_minor = PLR_ABI_MINOR + 1;
    services.extra_struct_bytes = 32;
    Surroundings surroundings;
    surroundings.services = &services;
    try {
        bench.try_make("", surroundings);
    } catch (const CreateFailed& failed) {
        FAIL("host of ABI " << PLR_ABI_MAJOR << "." << PLR_ABI_MINOR + 1 << ": create answered " << failed.what());
    }
}

PELORUS_CHECK(
    every, "earlier-host-is-answered", 2,
    "A host of an earlier minor version is served, or refused by PLR_E_UNSUPPORTED with a reason; the user must learn "
    "that the host is too old, not that something went wrong.",
    {"instance-is-accepted"}) {
    Services services(bench.host());
    services.abi_minor = PLR_ABI_MINOR - 1;
    Surroundings surroundings;
    surroundings.services = &services;
    try {
        bench.try_make("", surroundings);
    } catch (const CreateFailed& failed) {
        if (failed.status != PLR_E_UNSUPPORTED || failed.error.message[0] == 0)
            FAIL("host of ABI " << PLR_ABI_MAJOR << "." << PLR_ABI_MINOR - 1 << ": create answered " << failed.what()
                                << "; expected an instance, or PLR_E_UNSUPPORTED and a reason");
    }
}

PELORUS_CHECK(
    model, "longer-call-is-accepted", 2,
    "A call whose plr_call and plr_error are longer at the tail is answered like any other; the caller may be of a "
    "later minor version.",
    {"numbers-finite", "same-bytes-again"}) {
    const auto instance = bench.make();
    for (const HotCall& call : hot_calls(*instance, bench.sample(), 3)) {
        ExecuteOptions longer;
        longer.extra_struct_bytes = 64;
        const Execution expected = execute_well(*instance, call), done = execute(*instance, call, longer);
        if (!done.left_by.empty()) FAIL(call.function << " was left by " << done.left_by);
        if (done.status != expected.status)
            FAIL(call.function << ", called with a longer plr_call, answered " << done.told());
        for (std::int64_t i = 0; i < call.count; ++i) {
            std::string difference;
            if (!same_item(call, expected, i, call, done, i, difference))
                FAIL(call.function << ", called with a longer plr_call, answers otherwise: " << difference);
        }
    }
}

}  // namespace pelorus::conformance
