// Creation and destruction of instances of any kind. Refusals: refusals.cpp; what hosts differ in: hosts.cpp.
#include <chrono>
#include <cstring>

#include <fmt/format.h>

#include "machine/answers.hpp"
#include "machine/apart.hpp"
#include "machine/bench.hpp"
#include "machine/creation.hpp"
#include "machine/fault_handler.hpp"
#include "machine/process_state.hpp"
#include "machine/variation.hpp"
#include "machine/watch.hpp"

namespace pelorus::conformance {

namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Every text and number of a description, so that a change is seen. Texts may move, what they say may not.
std::string description_text(const plr_description& d) {
    std::string text = fmt::format("{} {} {} {} {} {} {} {}\n", d.flags, d.id, d.kind, d.version, d.title, d.purpose,
                                   d.equation, d.source);
    for (std::uint32_t i = 0; i < d.parameter_count; ++i) {
        const plr_parameter& p = element_of(d.parameters, i);
        text += fmt::format("parameter {}: type {}, flags {}, unit {}, default {}, min {}, max {}, rows {} to {}\n",
                            p.name, p.type, p.flags, p.unit, p.default_text == nullptr ? "none" : p.default_text, p.min,
                            p.max, p.rows_min, p.rows_max);
        for (std::uint32_t c = 0; c < p.choice_count; ++c)
            text += fmt::format("parameter {}: choice: {}\n", p.name, p.choices[c]);
    }
    for (std::uint32_t i = 0; i < d.slot_count; ++i) {
        const plr_slot& s = element_of(d.slots, i);
        text += fmt::format("slot {}: {} {} to {}\n", s.name, s.kind, s.min, s.max);
    }
    for (std::uint32_t i = 0; i < d.input_count; ++i) {
        const plr_input& input = element_of(d.inputs, i);
        text += fmt::format("input {} [{}]:", input.name, input.unit);
        for (std::uint32_t e = 0; e < input.size; ++e) text += fmt::format(" {}", input.defaults[e]);
        text += "\n";
    }
    return text;
}

/// The info struct of a model: the first function of every model's table behind the head.
struct ModelTable {
    plr_table_head head;
    const std::uint32_t* (*info)(const void* self);
};
std::string info_bytes(const Instance& instance) {
    const std::uint32_t* const info = instance.table<ModelTable>().info(instance.self());
    return {reinterpret_cast<const char*>(info), *info};
}

}  // namespace

PELORUS_CHECK(
    every, "instance-is-made", 1,
    "create answers an instance for the defaults (and for each setting that is tried); without one nothing else "
    "can be tried.",
    {"description-is-accepted", "defaults-are-read"}) {
    const auto instance = bench.make();
    REQUIRE(instance->self() != nullptr);
}

PELORUS_CHECK(
    every, "instance-is-accepted", 1,
    "The call table is whole, and what info() says fits together: no function missing that the instance promises, "
    "names and units of its spaces in order. A host refuses any other.",
    {"instance-is-made"}) {
    const auto instance = bench.make();
    const std::string problem =
        bench.host().instance_problem(instance->plugin(), {instance->self(), &instance->head()});
    if (!problem.empty()) FAIL(problem);
}

PELORUS_CHECK(
    every, "unknown-extensions-are-null", 2,
    "extension() answers NULL for an id that it does not know; whoever asked would call through a table of another "
    "shape.",
    {"instance-is-accepted"}) {
    const auto instance = bench.make();
    for (const char* const id :
         {"", "org.example.no_such_extension/1", "pelorus.motion.structure/999", "pelorus.", "x"})
        if (instance->extension<void>(id) != nullptr)
            FAIL_CHECK("extension(\"" << id << "\") answered a table; there is no such extension");
}

PELORUS_CHECK(
    every, "description-is-constant", 2,
    "A description says the same before and after instances were made with other values; hosts have read it once, and "
    "check configs by it.",
    {"instance-is-accepted", "calls-come-back"}) {
    bench.once_a_plugin();
    const std::string before = description_text(bench.description());
    const auto compare = [&](const std::string& after_what) {
        const std::string difference = first_difference(before, description_text(bench.description()));
        if (!difference.empty()) FAIL("what it says of itself has changed after " << after_what << ": " << difference);
    };
    for (const std::string& other : variations_of(bench)) {
        try {
            bench.try_make(other);
        } catch (const std::exception&) {
            // Values that do not go together; they were read all the same.
        }
        compare("create with " + other);
    }
    const auto instance = bench.make();
    answers_of(*instance, bench.sample());
    compare("the first calls");
}

PELORUS_CHECK(
    model, "info-is-constant", 2,
    "info() answers the same as long as the instance lives; callers have sized their memory by its first answer.",
    {"calls-come-back"}) {
    const auto instance = bench.make();
    const std::string before = info_bytes(*instance);
    answers_of(*instance, bench.sample());
    const std::string after = info_bytes(*instance);
    for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i)
        if (before[i] != after[i])
            FAIL("byte " << i << " of the struct that info() answers has changed after the first calls");
    if (before.size() != after.size()) FAIL("info() answers a struct of another size after the first calls");
}

PELORUS_CHECK(
    every, "instances-leave-nothing", 3,
    "Instances, made and destroyed one after the other (a thousand, or as many as take 0.05 s, 32 at least), leave no "
    "memory, thread or file behind; a host that runs for months makes many.",
    {"instance-is-accepted"}) {
    constexpr int warm_up = 32, most = 1000;
    constexpr double time_limit = 0.05;  // s
    const auto holder = bench.make();
    const auto make_one = [&] {
        const Creation made(holder->plugin(), holder->config());
        if (!made.is_made()) FAIL("a second instance of the same values: " << made.told());
    };
    for (int i = 0; i < warm_up; ++i) make_one();  // what is set up once for all may stay
    const std::size_t threads = thread_count(), files = open_file_count();
    const std::int64_t blocks = watch::blocks_in_use();
    const double start = seconds();
    int count = 0;
    while (count < most && (count < warm_up || seconds() < start + time_limit)) {
        make_one();
        ++count;
    }
    const std::int64_t more_blocks = watch::blocks_in_use() - blocks;
    if (more_blocks > 0)
        FAIL_CHECK(
            fmt::format("{} instances left {} blocks of memory behind, {:.2g} each; `valgrind --leak-check=full "
                        "pelorus check` on a config with it names the line",
                        count, more_blocks, static_cast<double>(more_blocks) / count));
    if (thread_count() > threads) FAIL_CHECK(count << " instances left " << thread_count() - threads << " threads");
    if (open_file_count() > files)
        FAIL_CHECK(count << " instances left " << open_file_count() - files << " files open");
    if (count < most) note(fmt::format("{} instances in {} s", count, time_limit));
}

PELORUS_CHECK(
    every, "instances-are-independent", 3,
    "An instance answers the same alone in its process and beside one of other values; whatever is kept in static "
    "variables belongs to the first one made.",
    {"instance-is-accepted", "same-bytes-of-another-instance", "same-bytes-in-another-process"}) {
    bench.once_a_plugin();
    const Sample sample = bench.sample();
    std::string other, alone;
    for (const std::string& variation : variations_of(bench)) {
        const Apart tried = apart([&] { return answers_of(*bench.try_make(variation), sample); });
        if (!tried.problem.empty() || tried.written.empty()) continue;
        other = variation;
        alone = tried.written;
        break;
    }
    const auto first = bench.make();
    const std::string answers = answers_of(*first, sample);
    if (answers.empty()) skip("it answers nothing that could be compared");
    if (other.empty()) other = "{}";  // no other values: then another instance of the same ones
    const auto second = bench.try_make(other);
    const std::string beside = answers_of(*second, sample);
    if (!alone.empty() && alone != beside)
        FAIL("an instance with " << other << ", alone in its process and beside one of other values: "
                                 << first_difference(alone, beside));
    const std::string again = answers_of(*first, sample);
    if (again != answers)
        FAIL("an instance before and after another one with " << other
                                                              << " was made: " << first_difference(answers, again));
}

PELORUS_CHECK(
    every, "allocation-failures-are-answered", 4,
    "When memory runs out within create (any one of its first 2000 allocations fails) it answers an error and leaves "
    "nothing behind; the host then ends one run, not the process.",
    {"instances-leave-nothing"}) {
    if (!watch::is_available()) skip("sanitizers watch the memory of this build");
    constexpr std::int64_t most = 2000;
    const auto holder = bench.make();
    for (std::int64_t n = 0;; ++n) {
        if (n == most) {
            note(fmt::format("more than {} allocations, of which the first {} were tried", most, most));
            break;
        }
        const std::string title = fmt::format("allocation {} of create fails", n);
        set_subject_of_fault(title.c_str());
        const auto attempt = [&] {
            const Creation made = Creation::with_failing_allocation(holder->plugin(), holder->config(), n);
            if (!made.left_by().empty()) FAIL(title << ": " << made.told());
            if (!made.is_made() && made.status() >= 0)
                FAIL(title << ": create answered " << made.told() << ", and no instance");
            return made.has_failed_allocation();
        };
        if (!attempt()) {
            note(fmt::format("{} allocations", n));
            break;
        }
        const std::int64_t blocks = watch::blocks_in_use();
        attempt();
        if (watch::blocks_in_use() > blocks)
            FAIL(title << ": it leaves " << watch::blocks_in_use() - blocks << " blocks of memory behind");
    }
    set_subject_of_fault("");
    const Creation after(holder->plugin(), holder->config());
    if (!after.is_made()) FAIL("after failed allocations a create with enough memory: " << after.told());
}

}  // namespace pelorus::conformance
