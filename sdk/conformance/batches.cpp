// Every item of a batch is answered for itself, with its own inputs, and fails for itself.
#include <limits>

#include "machine/library.hpp"
#include "model_calls.hpp"

namespace pelorus::conformance {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// attempt(fault) for calls of which an item fails, with NaN in an argument.
template <class Try> void for_failures(Bench& bench, Try&& attempt) {
    bool is_tried = false;
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        Sample sample = bench.sample(1);
        for (const Fault& fault : faults_of_element(call, sample, nan)) {
            const Execution done = execute(instance, fault.call);
            if (done.status < 0 || !done.failed(fault.item)) continue;
            is_tried = true;
            attempt(instance, fault, done);
        }
    });
    if (!is_tried) skip("no item fails, even with NaN in the arguments");
}

/// The declared inputs of a subject, each a little off its default; other ones for another `variant`.
std::vector<double> inputs_off_default(const Instance& instance, int variant) {
    std::vector<double> values = instance.inputs();
    for (std::size_t k = 0; k < values.size(); ++k)
        values[k] = values[k] * (1 + 0.01 * variant) + 0.001 * variant * static_cast<double>(k + 1);
    return values;
}

}  // namespace

PELORUS_CHECK(model, "batch-equals-singles", 2,
              "A batch gives each item the very bits that it would get alone; otherwise results depend on who else is "
              "tracked, and on how work is split.",
              {"calls-succeed"}) {
    for_batches(bench, [&](const Instance& instance, const HotCall& call) {
        const Execution whole = execute_well(instance, call);
        for (std::int64_t i = 0; i < call.count; ++i) {
            const HotCall single = call.of_items({i});
            ExecuteOptions options;
            options.item_ids = ids_of({i});
            const Execution alone = execute_well(instance, single, options);
            std::string difference;
            if (!same_item(call, whole, i, single, alone, 0, difference))
                FAIL(call.function << ": in a batch of " << call.count << " and alone, " << difference);
        }
    });
}

PELORUS_CHECK(model, "items-in-any-order", 2,
              "Items in another order, with their ids, get the same bits; tracks are listed as they come and go.",
              {"batch-equals-singles"}) {
    for_batches(bench, [&](const Instance& instance, const HotCall& call) {
        const Execution whole = execute_well(instance, call);
        const std::vector<std::int64_t> order = bench.sample(1).permutation(call.count);
        const HotCall shuffled = call.of_items(order);
        ExecuteOptions options;
        options.item_ids = ids_of(order);
        const Execution done = execute_well(instance, shuffled, options);
        std::string difference;
        for (std::size_t k = 0; k < order.size(); ++k)
            if (!same_item(call, whole, order[k], shuffled, done, static_cast<std::int64_t>(k), difference))
                FAIL(call.function << ": in order and as number " << k << " of another order, " << difference);
    });
}

PELORUS_CHECK(model, "inputs-null-is-default", 2,
              "plr_call.inputs NULL means that every declared input has its default; a holder without values passes "
              "that.",
              {"calls-succeed"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        if (instance.inputs().empty()) skip("it declares no inputs");
        ExecuteOptions options;
        options.without_inputs = true;
        const Execution given = execute_well(instance, call), missing = execute_well(instance, call, options);
        std::string difference;
        if (!same_answer(call, given, missing, difference))
            FAIL(call.function << ": with the defaults of its inputs and with inputs NULL, " << difference);
    });
}

PELORUS_CHECK(model, "inputs-per-item", 2,
              "With input_stride each item has inputs of its own; one platform's pose is not another's.",
              {"batch-equals-singles"}) {
    for_batches(bench, [&](const Instance& instance, const HotCall& call) {
        if (instance.inputs().empty()) skip("it declares no inputs");
        ExecuteOptions together;
        together.input_stride = static_cast<std::int64_t>(instance.inputs().size());
        for (int i = 0; i < call.count; ++i) {
            const std::vector<double> own = inputs_off_default(instance, i);
            together.inputs.insert(together.inputs.end(), own.begin(), own.end());
        }
        const Execution whole = execute(instance, call, together);
        if (whole.status != PLR_OK && whole.status != PLR_ITEMS_FAILED)
            FAIL(call.function << ", with inputs of its own for each item, answered " << whole.told()
                               << "; expected that it fails for no item but those whose inputs it cannot take");
        for (std::int64_t i = 0; i < call.count; ++i) {
            const HotCall single = call.of_items({i});
            ExecuteOptions options;
            options.item_ids = ids_of({i});
            options.inputs = inputs_off_default(instance, static_cast<int>(i));
            const Execution alone = execute(instance, single, options);
            std::string difference;
            if (!same_item(call, whole, i, single, alone, 0, difference))
                FAIL(call.function << ": with inputs of its own in a batch and alone, " << difference);
        }
    });
}

PELORUS_CHECK(model, "item-statuses-agree", 2,
              "PLR_OK means that no item failed, PLR_ITEMS_FAILED that item_status names at least one; callers look at "
              "the second only after the first.",
              {"calls-succeed"}) {
    for_failures(bench, [&](const Instance&, const Fault& fault, const Execution& done) {
        if (done.status != PLR_ITEMS_FAILED)
            FAIL(fault.call.function << " " << fault.words << " answers " << status_name(done.status)
                                     << " and marks item " << fault.item << " as failed; expected PLR_ITEMS_FAILED");
        for (const plr_status each : done.items)
            if (each > 0)
                FAIL(fault.call.function << " " << fault.words << " gives an item the status " << each
                                         << ", which is no failure");
    });
}

PELORUS_CHECK(model, "failures-are-told", 2,
              "Who fails says why: error.code and a message; a run of months is searched by them.", {"calls-succeed"}) {
    for_failures(bench, [&](const Instance&, const Fault& fault, const Execution& done) {
        if (done.error.code == PLR_OK || done.error.message[0] == 0)
            FAIL(fault.call.function << " " << fault.words << " fails item " << fault.item << " and leaves error."
                                     << (done.error.code == PLR_OK ? "code" : "message") << " empty");
    });
}

PELORUS_CHECK(model, "item-status-may-be-null", 2,
              "Where the caller keeps no item statuses, the first failure decides the answer.",
              {"item-statuses-agree"}) {
    for_failures(bench, [&](const Instance& instance, const Fault& fault, const Execution& done) {
        ExecuteOptions options;
        options.without_item_status = true;
        const Execution bare = execute(instance, fault.call, options);
        const plr_status expected = done.items[static_cast<std::size_t>(fault.item)];
        if (bare.status != expected)
            FAIL(fault.call.function << " " << fault.words << " without item_status answers "
                                     << status_name(bare.status) << ", expected that item's " << status_name(expected));
    });
}

PELORUS_CHECK(model, "item-offset-is-added", 2,
              "error.item counts from the outermost batch: the item's index plus item_offset; else the report blames "
              "another track.",
              {"failures-are-told"}) {
    for_failures(bench, [&](const Instance& instance, const Fault& fault, const Execution&) {
        ExecuteOptions options;
        options.item_offset = 1000;
        const Execution done = execute(instance, fault.call, options);
        if (done.error.item != fault.item + 1000)
            FAIL(fault.call.function << " " << fault.words << " tells error.item " << done.error.item
                                     << " where item_offset is 1000, expected " << fault.item + 1000);
    });
}

}  // namespace pelorus::conformance
