// The same arguments give the same bytes: again, in another instance, in another process, after whatever else was asked.
#include <cstring>
#include <functional>

#include "machine/apart.hpp"
#include "machine/services.hpp"
#include "model_calls.hpp"

namespace pelorus::conformance {

namespace {

/// What `body` answers in a process that is forked for it; empty where that did not come back.
std::vector<double> in_another_process(const std::function<std::vector<double>()>& body) {
    const std::string bytes =
        apart([&] {
            const std::vector<double> values = body();
            return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
        }).written;
    std::vector<double> values(bytes.size() / sizeof(double));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
    return values;
}

/// An answer as numbers: the statuses, then the outputs.
void append(std::vector<double>& to, const Execution& done) {
    to.push_back(done.status);
    to.insert(to.end(), done.items.begin(), done.items.end());
    for (const std::vector<double>& out : done.out) to.insert(to.end(), out.begin(), out.end());
}

/// Takes an answer like `done` from the numbers; false where they are too few.
bool take(const std::vector<double>& from, std::size_t& position, Execution& done) {
    std::size_t wanted = 1 + done.items.size();
    for (const std::vector<double>& out : done.out) wanted += out.size();
    if (position + wanted > from.size()) return false;
    done.status = static_cast<plr_status>(from[position++]);
    for (plr_status& item : done.items) item = static_cast<plr_status>(from[position++]);
    for (std::vector<double>& out : done.out)
        for (double& value : out) std::memcpy(&value, &from[position++], sizeof value);
    return true;
}

/// Calls that a memory of an earlier call would confuse with this one: one argument is another sample's, or hardly another.
std::vector<HotCall> neighbours(const HotCall& call, const HotCall& other) {
    std::vector<HotCall> all;
    for (std::size_t a = 0; a < call.in.size(); ++a) {
        if (call.in[a].is_absent) continue;
        HotCall nudged = call;
        for (double& value : nudged.in[a].values) value *= 1 + 1e-10;
        all.push_back(nudged);
        if (other.in[a].values.size() != call.in[a].values.size()) continue;
        HotCall mixed = call;
        mixed.in[a].values = other.in[a].values;
        all.push_back(mixed);
    }
    return all;
}

}  // namespace

PELORUS_CHECK(model, "same-bytes-again", 2,
              "The same call gives the same bytes again, whatever was left on the stack before: nothing is read that "
              "was never set. A run that cannot be repeated cannot be explained.",
              {"writes-only-its-outputs"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        // Whether the call goes well does not matter here: what was never set may be what makes it fail.
        const auto answer_over = [&](unsigned char left_on_stack) {
            ExecuteOptions options;
            options.stack_of = left_on_stack;
            return execute(instance, call, options);
        };
        constexpr unsigned char one = 0x40, other = 0xC1;  // as doubles: 32.5 and -2261634.5
        const Execution first = answer_over(one);
        std::string difference;
        for (int again = 0; again < 2; ++again)
            if (!same_answer(call, first, answer_over(one), difference))
                FAIL(call.function << ": called twice with the same arguments, " << difference);
        if (!same_answer(call, first, answer_over(other), difference))
            FAIL(call.function << " depends on memory that was never set: with other bytes left on the stack, "
                               << difference
                               << "; a local variable or matrix without a value (Matrix::Zero()), which "
                                  "-Wmaybe-uninitialized or valgrind may name");
    });
}

PELORUS_CHECK(model, "same-bytes-of-another-instance", 3,
              "Two instances made alike answer alike, whatever their addresses and however many there are.",
              {"calls-succeed"}) {
    const auto one = bench.make(), other = bench.make();
    const auto calls = hot_calls(*one, bench.sample(), ordinary_batch);
    const auto theirs = hot_calls(*other, bench.sample(), ordinary_batch);
    for (std::size_t c = 0; c < calls.size(); ++c) {
        std::string difference;
        if (!same_answer(calls[c], execute_well(*one, calls[c]), execute_well(*other, theirs[c]), difference))
            FAIL(calls[c].function << ": of two instances made alike, " << difference);
    }
}

PELORUS_CHECK(model, "same-bytes-in-another-process", 3,
              "Another process answers the same bytes; campaigns split their runs among many.", {"calls-succeed"}) {
    const auto theirs = in_another_process([&] {
        const auto instance = bench.make();
        std::vector<double> all;
        for (const HotCall& call : hot_calls(*instance, bench.sample(), ordinary_batch))
            append(all, execute(*instance, call));
        return all;
    });
    std::size_t position = 0;
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        const Execution mine = execute_well(instance, call);
        Execution other = mine;
        if (!take(theirs, position, other)) FAIL(call.function << " did not come back in another process");
        std::string difference;
        if (!same_answer(call, mine, other, difference))
            FAIL(call.function << ": here and in another process, " << difference);
    });
}

PELORUS_CHECK(model, "independent-of-earlier-calls", 3,
              "An answer does not depend on what was asked before: no cache that takes one time step or track for "
              "another. All that evolves lies in records that the caller owns.",
              {"same-bytes-in-another-process", "same-bytes-of-another-instance"}) {
    const auto instance = bench.make();
    // One item a call: a memory that holds the last item alone would forget within a batch.
    const auto calls = hot_calls(*instance, bench.sample(), 1);
    const auto others = hot_calls(*instance, bench.sample(1), 1);
    const auto fail = [&](const HotCall& call, const HotCall& another, const std::string& difference) {
        const std::string place = place_of_static_write([&] {
            execute(*instance, another);
            execute(*instance, call);
        });
        FAIL(call.function << " remembers an earlier call with other arguments: before and after it, " << difference
                           << (place.empty() ? "" : "; it writes to static memory at " + place));
    };
    for (std::size_t c = 0; c < calls.size(); ++c) {
        const std::vector<HotCall> between = neighbours(calls[c], others[c]);
        // What comes first is remembered as well: elsewhere the order is reversed.
        const std::vector<double> reversed = in_another_process([&] {
            std::vector<double> all;
            for (std::size_t b = between.size(); b-- > 0;) append(all, execute(*instance, between[b]));
            return all;
        });
        const Execution first = execute_well(*instance, calls[c]);
        std::vector<Execution> answers;
        std::string difference;
        for (const HotCall& other : between) {
            answers.push_back(execute(*instance, other));
            if (!same_answer(calls[c], first, execute(*instance, calls[c]), difference))
                fail(calls[c], others[c], difference);
        }
        std::size_t position = 0;
        for (std::size_t b = between.size(); b-- > 0;) {
            Execution elsewhere = answers[b];
            if (take(reversed, position, elsewhere) && !same_answer(between[b], answers[b], elsewhere, difference))
                fail(between[b], others[c], difference);
        }
    }
}

PELORUS_CHECK(model, "thread-count-invariant", 3,
              "A model that spreads its work over plr_parallel answers the same bytes on one thread and on four; else "
              "results depend on the machine.",
              {"same-bytes-of-another-instance"}) {
    constexpr std::int64_t many = 61;
    Services services[2] = {Services(bench.host()), Services(bench.host())};
    std::vector<Execution> answers;
    for (Services& each : services) {
        each.threads = &each == services ? 1 : 4;
        Surroundings surroundings;
        surroundings.services = &each;
        const auto instance = bench.make(surroundings);
        if (each.asked_for.count(PLR_SERVICE_PARALLEL) == 0) skip("it does not ask for " PLR_SERVICE_PARALLEL);
        std::size_t c = 0;
        for (const HotCall& call : hot_calls(*instance, bench.sample(), many)) {
            Execution done = execute_well(*instance, call);
            std::string difference;
            if (&each == services)
                answers.push_back(std::move(done));
            else if (!same_answer(call, answers[c], done, difference))
                FAIL(call.function << ": on one thread and on four, " << difference);
            ++c;
        }
    }
}

}  // namespace pelorus::conformance
