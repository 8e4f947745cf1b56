// The calls of a trajectory, with plausible arguments.
#include "trajectory_calls.hpp"

#include <cmath>

#include <catch2/catch.hpp>

#include "machine/guarded_memory.hpp"
#include "machine/library.hpp"

namespace pelorus::conformance {

namespace trajectory_calls {

Argument realised(const Instance& instance, plr_key key) {
    const std::int64_t size = info(instance).record_size;
    GuardedMemory memory(static_cast<std::size_t>(size), {"realise", "record"});
    plr_error error = empty_error();
    std::vector<std::uint64_t> scratch_memory((info(instance).scratch_bytes + 7) / 8 + 8);
    plr_scratch scratch{reinterpret_cast<unsigned char*>(scratch_memory.data()), info(instance).scratch_bytes, 0};
    plr_status item = PLR_OK;
    plr_call call{};
    call.struct_size = sizeof call;
    call.keys = &key;
    call.inputs = instance.inputs().empty() ? nullptr : instance.inputs().data();
    call.scratch = &scratch;
    call.error = &error;
    call.item_status = &item;
    const plr_view record{memory.data(), size, 1, 1, 1, size, size};
    const plr_status status = table(instance).realise(instance.self(), &call, &record);
    if (status != PLR_OK) FAIL("realise answered " << told(status, error));
    return input("record", size, 1, 1, [&](double* out, std::int64_t) { std::copy_n(memory.data(), size, out); });
}

HotCall states(const Instance& instance, const Argument& record, const std::vector<std::int64_t>& times,
               bool with_extents) {
    const plr_trajectory_info& facts = info(instance);
    HotCall call = make_call(with_extents ? "states" : "states (no extents)", facts.objects);
    call.is_per_item = false;
    const auto count = static_cast<std::int64_t>(times.size());
    const std::int64_t d = facts.extent_dimension;
    const auto integers = [&](const char* name) {
        Argument argument = output(name, facts.objects, 1, Content::opaque);
        argument.is_common = true;  // one array for all objects
        return argument;
    };
    call.in = {record};
    call.in[0].is_common = true;
    call.in[0].is_weightless = true;
    // NaN is an answer: the object does not exist then.
    call.out = {output("states", facts.state->size, count, Content::opaque),
                with_extents ? output("extents", d * d, count, Content::opaque) : absent("extents"),
                integers("ids"),
                integers("parents"),
                integers("births"),
                integers("deaths")};
    call.invoke = [trajectory = &table(instance), self = instance.self(), times](const plr_call& context,
                                                                                 const Views& v) {
        // Bare pointers tell the plugin no shape that it could refuse.
        for (const std::size_t integer : {ids_out, parents_out, births_out, deaths_out})
            if (v.out[integer].rows != v.out[states_out].count) return plr_status{PLR_E_ARGUMENT};
        plr_const_view one_record = v.in[0];
        one_record.count = 1;
        const plr_trajectory_states args{sizeof args,
                                         0,
                                         one_record,
                                         static_cast<std::int64_t>(times.size()),
                                         times.data(),
                                         v.out[states_out],
                                         v.out[extents_out],
                                         reinterpret_cast<std::uint64_t*>(v.out[ids_out].data),
                                         reinterpret_cast<std::int64_t*>(v.out[parents_out].data),
                                         reinterpret_cast<std::int64_t*>(v.out[births_out].data),
                                         reinterpret_cast<std::int64_t*>(v.out[deaths_out].data)};
        return trajectory->states(self, &context, &args);
    };
    return call;
}

std::vector<std::int64_t> ascending_times(Sample& sample, std::int64_t count, double longest_step) {
    std::vector<std::int64_t> times;
    double now = 0;
    for (std::int64_t k = 0; k < count; ++k) {
        times.push_back(std::llround(now * 1e9));
        now += longest_step * sample.uniform(0.1, 1.0);
    }
    return times;
}

}  // namespace trajectory_calls

namespace {

std::vector<HotCall> calls_of(const Instance& instance, Sample sample, std::int64_t count) {
    using namespace trajectory_calls;
    const Argument record = realised(instance, sample.key());
    const std::vector<std::int64_t> times = ascending_times(sample, count, 3.0);
    std::vector<HotCall> calls{trajectory_calls::states(instance, record, times, false)};
    if (info(instance).extent_dimension > 0) calls.push_back(trajectory_calls::states(instance, record, times, true));
    return calls;
}

const detail::KindRegistration registration(PLR_TRAJECTORY, &calls_of, [](const Instance& instance) {
    return trajectory_calls::info(instance).scratch_bytes;
});

}  // namespace

}  // namespace pelorus::conformance
