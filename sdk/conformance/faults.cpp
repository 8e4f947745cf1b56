// Arguments that are not plausible: one bad target does not fail the others, and is told of.
#include <cmath>
#include <limits>

#include "model_calls.hpp"

namespace pelorus::conformance {

namespace {

using Limits = std::numeric_limits<double>;

void append(std::vector<Fault>& to, std::vector<Fault>&& more) {
    for (Fault& fault : more) to.push_back(std::move(fault));
}

std::vector<Fault> infinities(const HotCall& call, Sample& sample) {
    std::vector<Fault> all = faults_of_element(call, sample, Limits::infinity());
    append(all, faults_of_element(call, sample, -Limits::infinity()));
    return all;
}

std::vector<Fault> extremes(const HotCall& call, Sample& sample) {
    std::vector<Fault> all;
    for (const double value : {1e150, -1e150, Limits::denorm_min()}) {
        append(all, faults_of_element(call, sample, value));
        append(all, faults_of_item(call, sample, value));
    }
    return all;
}

/// Fails the check unless each fault leaves the others alone, and its own item is flagged or finite.
template <class Make> void expect_survived(Bench& bench, Make&& make) {
    bool is_tried = false;
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        Sample sample = bench.sample(1);
        const Execution good = execute_well(instance, call);
        for (const Fault& fault : make(call, sample)) {
            is_tried = true;
            const Execution done = execute(instance, fault.call);
            check_others_unchanged(fault, good, done);
            const std::string broken =
                done.status < 0 || done.failed(fault.item) ? "" : not_finite(fault.call, done, fault.item);
            if (!broken.empty())
                FAIL(call.function << " " << fault.words << " answers without an item status, but " << broken);
        }
    });
    if (!is_tried) skip("no call has such arguments");
}

}  // namespace

PELORUS_CHECK(model, "exceptions-contained", 3,
              "No exception leaves a call, whatever the arguments; a host in another language ends there and then.",
              {"calls-succeed"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        Sample sample = bench.sample(1);
        std::vector<Fault> all = faults_of_element(call, sample, Limits::quiet_NaN());
        append(all, infinities(call, sample));
        append(all, extremes(call, sample));
        append(all, faults_of_rank(call, sample));
        for (const Fault& fault : all) {
            const std::string left_by = execute(instance, fault.call).left_by;
            if (!left_by.empty())
                FAIL(call.function << " " << fault.words << " was left by " << left_by
                                   << "; catch it and answer a status");
        }
    });
}

PELORUS_CHECK(model, "recovers-after-failure", 3,
              "A call after a failed one answers as before; one bad scan does not end a track for ever.",
              {"exceptions-contained", "same-bytes-again"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        Sample sample = bench.sample(1);
        const Execution good = execute_well(instance, call);
        for (const Fault& fault : faults_of_element(call, sample, Limits::quiet_NaN())) {
            execute(instance, fault.call);
            const Execution again = execute(instance, call);
            std::string difference;
            if (!same_answer(call, good, again, difference))
                FAIL(call.function << ": before and after a call " << fault.words << ", " << difference);
        }
    });
}

PELORUS_CHECK(model, "nan-stays-in-its-item", 3,
              "NaN in one item leaves the others' bits as they are; one bad target does not fail the other 999.",
              {"recovers-after-failure"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        Sample sample = bench.sample(1);
        const Execution good = execute_well(instance, call);
        for (const Fault& fault : faults_of_element(call, sample, Limits::quiet_NaN()))
            check_others_unchanged(fault, good, execute(instance, fault.call));
    });
}

PELORUS_CHECK(model, "nan-is-flagged", 3,
              "An item with NaN in its arguments fails, unless its outputs do not depend on that element; a number "
              "made of no number looks like a track.",
              {"nan-stays-in-its-item"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        Sample sample = bench.sample(1);
        const Execution good = execute_well(instance, call);
        for (const Fault& fault : faults_of_element(call, sample, Limits::quiet_NaN())) {
            const Execution done = execute(instance, fault.call);
            if (done.status < 0 || done.failed(fault.item)) continue;
            std::string difference;
            if (!same_item(call, good, fault.item, fault.call, done, fault.item, difference))
                FAIL(call.function << " " << fault.words
                                   << " answers something else without an item status (finite against NaN): "
                                   << difference);
        }
    });
}

PELORUS_CHECK(model, "infinity-is-flagged", 3,
              "An item with an infinite argument fails or is answered by finite numbers; an infinity that is passed on "
              "is a NaN one step later.",
              {"numbers-finite", "recovers-after-failure"}) {
    expect_survived(bench, infinities);
}

PELORUS_CHECK(model, "extremes-are-survived", 3,
              "Huge values (1e150) and denormal ones end no process and give no number that is not finite without an "
              "item status; lost tracks grow like that.",
              {"numbers-finite", "recovers-after-failure"}) {
    expect_survived(bench, extremes);
}

PELORUS_CHECK(model, "singular-covariances-survived", 3,
              "A covariance without full rank is answered by finite numbers or an item status; a perfect sensor has "
              "one.",
              {"numbers-finite", "recovers-after-failure"}) {
    expect_survived(bench, faults_of_rank);
}

}  // namespace pelorus::conformance
