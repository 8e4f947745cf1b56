// Where a call reads and writes: the arrays that it is handed, in the layout that they are handed in, and nothing else.
#include "machine/library.hpp"
#include "model_calls.hpp"

namespace pelorus::conformance {

namespace {

/// Fails the check unless a call in another layout answers what the packed one answers.
void expect_same(const Instance& instance, const HotCall& packed, const HotCall& call, const ExecuteOptions& options,
                 const std::string& words) {
    const Execution expected = execute_well(instance, packed), done = execute(instance, call, options);
    std::string difference;
    if (!same_answer(packed, expected, done, difference))
        FAIL(call.function << " answers differently " << words << " (packed against that): " << difference
                           << (done.status < 0 ? "; " + done.told() : ""));
}

}  // namespace

PELORUS_CHECK(model, "inputs-unmodified", 2,
              "A call does not write to its inputs; they are another's estimate, shared by threads.",
              {"calls-come-back"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        ExecuteOptions options;
        options.has_slack = true;
        execute(instance, call, options);  // the inputs lie on pages that cannot be written
    });
}

PELORUS_CHECK(
    model, "writes-only-its-outputs", 2,
    "A call writes the elements of its output views and nothing else: not between items, not past the end, not "
    "beyond its scratch memory. The next track lies there.",
    {"inputs-unmodified"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        for (const std::int64_t gap : {0, 3}) {
            ExecuteOptions options;
            options.gap = gap;
            for (const std::string& stray : execute(instance, call, options).stray)
                FAIL_CHECK(call.function << ": " << stray);
        }
    });
}

PELORUS_CHECK(model, "scratch-handed-back", 2,
              "A call restores `used` of the scratch memory before it returns; else a long run ends in PLR_E_SCRATCH.",
              {"calls-succeed"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        const Execution done = execute_well(instance, call);
        if (done.scratch_left_used != 0)
            FAIL(call.function << " keeps " << done.scratch_left_used << " bytes of scratch memory");
    });
}

PELORUS_CHECK(model, "item-gaps", 2,
              "Items lie item_stride doubles apart, which may be more than their size: records nest in records.",
              {"calls-succeed"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        ExecuteOptions options;
        options.gap = 3;
        expect_same(instance, call, call, options, "with 3 doubles between items");
    });
}

PELORUS_CHECK(model, "common-inputs", 2,
              "An input with item_stride 0 is one matrix for all items; callers do not copy one time step a thousand "
              "times.",
              {"calls-succeed"}) {
    for_batches(bench, [&](const Instance& instance, const HotCall& call) {
        for (std::size_t a = 0; a < call.in.size(); ++a) {
            const Argument& argument = call.in[a];
            if (argument.is_absent || argument.is_common || !argument.offsets.empty()) continue;
            HotCall common = call, expanded = call;
            common.in[a].is_common = true;
            common.in[a].values = HotCall::item_of(argument, argument.values, 0);
            expanded.in[a].values.clear();
            for (std::int64_t i = 0; i < call.count; ++i)
                expanded.in[a].values.insert(expanded.in[a].values.end(), common.in[a].values.begin(),
                                             common.in[a].values.end());
            // Others' measurements and one's own state may not fit together: what matters is that both answer alike.
            expanded.may_refuse = true;
            expect_same(instance, expanded, common, {}, "where `" + argument.name + "` has item_stride 0");
        }
    });
}

PELORUS_CHECK(model, "strides-honoured", 2,
              "A model with PLR_FLAG_ANY_STRIDE reads and writes by row_stride and col_stride, whatever they are.",
              {"calls-succeed"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        if ((model_flags(instance) & PLR_FLAG_ANY_STRIDE) == 0) skip("it does not declare PLR_FLAG_ANY_STRIDE");
        ExecuteOptions options;
        options.transposed = true;
        expect_same(instance, call, call, options, "with arrays stored row by row");
    });
}

PELORUS_CHECK(model, "no-items", 2,
              "A batch of no items is answered PLR_OK, even where all data are NULL; a scan without tracks is an "
              "ordinary scan.",
              {"calls-succeed"}) {
    for_batches(bench, [&](const Instance& instance, const HotCall& call) {
        for (const bool is_null : {false, true}) {
            ExecuteOptions options;
            options.is_null_if_empty = is_null;
            const Execution done = execute(instance, call.of_items({}), options);
            if (!done.left_by.empty() || done.status != PLR_OK)
                FAIL(call.function << " of no items answers " << done.told() << (is_null ? " where data are NULL" : "")
                                   << ", expected PLR_OK");
        }
    });
}

PELORUS_CHECK(
    model, "wrong-shapes-refused", 3,
    "An output of another shape is refused (PLR_E_ARGUMENT). An input of another shape is refused as well, or "
    "at least not read beyond its end; whoever writes or reads on regardless corrupts what lies behind.",
    {"no-items"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        if (call.takes_pointers) return;
        const auto attempt = [&](const Argument& argument, HotCall wrong, bool is_output, std::size_t a) {
            if (argument.is_absent || argument.rows * argument.cols == 0) return;
            Argument& changed = is_output ? wrong.out[a] : wrong.in[a];
            changed.rows += changed.rows > 1 ? -1 : 1;
            // Inputs stay filled; an item that is larger than before begins the values again.
            if (!is_output)
                while (changed.values.size() < static_cast<std::size_t>(changed.rows * changed.cols * call.count))
                    changed.values.push_back(changed.values[changed.values.size() % argument.values.size()]);
            const Execution done = execute(instance, wrong);
            if (is_output && done.status >= 0)
                FAIL(call.function << " answers " << status_name(done.status) << " where `" << argument.name << "` has "
                                   << changed.rows << " rows, expected PLR_E_ARGUMENT (it has " << argument.rows
                                   << ")");
        };
        for (std::size_t a = 0; a < call.out.size(); ++a) attempt(call.out[a], call, true, a);
        for (std::size_t a = 0; a < call.in.size(); ++a) attempt(call.in[a], call, false, a);
    });
}

}  // namespace pelorus::conformance
