/// What the checks of all models share: their calls, one after the other, and arguments that are not plausible.
#pragma once

#include <string>
#include <vector>

#include "machine/arguments.hpp"
#include "machine/bench.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance {

/// Items of an ordinary call: no multiple of the widths that loops are unrolled to.
constexpr std::int64_t ordinary_batch = 7;

/// attempt(instance, call) for every call of the subject.
template <class Try> void for_calls(Bench& bench, Try&& attempt, std::int64_t count = ordinary_batch) {
    const auto instance = bench.make();
    for (const HotCall& call : hot_calls(*instance, bench.sample(), count)) attempt(*instance, call);
}

/// The same for calls that work on batches.
template <class Try> void for_batches(Bench& bench, Try&& attempt, std::int64_t count = ordinary_batch) {
    bool is_tried = false;
    for_calls(
        bench,
        [&](const Instance& instance, const HotCall& call) {
            if (!call.is_per_item) return;
            is_tried = true;
            attempt(instance, call);
        },
        count);
    if (!is_tried) skip("its calls are of one item by nature");
}

/// 0, 1, ...: the ids that item_ids NULL stands for.
std::vector<std::uint64_t> ids_of(const std::vector<std::int64_t>& items);

/// A call in which one item of one argument is not plausible.
struct Fault {
    HotCall call;
    std::size_t argument;
    std::int64_t item;
    std::string words;  ///< `with nan in state[2] of item 3`
};
/// The value in one element, of each argument in turn.
std::vector<Fault> faults_of_element(const HotCall& call, Sample& sample, double value);
/// The value in all elements of an item, of each argument in turn.
std::vector<Fault> faults_of_item(const HotCall& call, Sample& sample, double value);
/// An item's covariance without full rank: zero, and of rank one.
std::vector<Fault> faults_of_rank(const HotCall& call, Sample& sample);

/// Fails the check unless every item but the fault's is answered as in `good`. A call that is one item by nature has no others.
void check_others_unchanged(const Fault& fault, const Execution& good, const Execution& done);
/// The first element of the item's outputs that is not finite (or not a number, where infinity is an answer), or "".
std::string not_finite(const HotCall& call, const Execution& done, std::int64_t item);

}  // namespace pelorus::conformance
