// The contract of estimators: what info tells, what may be left out, what may be called in place.
#include <cmath>
#include <cstring>
#include <iomanip>
#include <set>

#include "estimator_bench.hpp"
#include "machine/bench.hpp"
#include "machine/check.hpp"
#include "machine/guarded_memory.hpp"
#include "machine/library.hpp"

namespace pelorus::conformance {

namespace {

void examine_space(const plr_space* space, const char* which) {
    if (space == nullptr || space->size == 0 || space->components == nullptr) FAIL("info." << which << " is empty");
    std::set<std::string> names;
    const auto* at = reinterpret_cast<const unsigned char*>(space->components);
    for (std::uint32_t k = 0; k < space->size; ++k) {
        const auto& component = *reinterpret_cast<const plr_component*>(at);
        at += space->components->struct_size;
        if (component.name == nullptr || component.name[0] == 0 || component.unit == nullptr)
            FAIL("info." << which << ": component " << k << " has no name or no unit");
        if (!names.insert(component.name).second)
            FAIL("info." << which << " has two components `" << component.name << "`");
        if (!std::isfinite(component.prior_mean) || !(component.prior_deviation > 0) ||
            !std::isfinite(component.prior_deviation))
            FAIL("info." << which << ": `" << component.name << "` has the prior " << component.prior_mean << " +- "
                         << component.prior_deviation << "; a track that does not know it could not start");
    }
}

/// Fails unless the two are the same; what a plugin leaves unwritten of a record does not count.
void same_bits(const std::string& what, const std::vector<double>& one, const std::vector<double>& other) {
    for (std::size_t e = 0; e < one.size(); ++e)
        if (!GuardedMemory::is_pattern(one[e]) && std::memcmp(&one[e], &other[e], sizeof(double)) != 0)
            FAIL(what << ": element " << e << std::setprecision(17) << " is " << other[e] << " instead of " << one[e]);
}

/// The subject with a further sensor beside its own, or as it is where it does not take one.
std::unique_ptr<Instance> with_two_sensors(Bench& bench) {
    const plr_description& description = bench.description();
    const auto* at = reinterpret_cast<const unsigned char*>(description.slots);
    for (std::uint32_t s = 0; s < description.slot_count; ++s) {
        const auto& slot = *reinterpret_cast<const plr_slot*>(at);
        at += slot.struct_size;
        if (std::strcmp(slot.kind, "sensor") != 0 || (slot.max >= 0 && slot.max < 2)) continue;
        Node node = bench.subject().node;
        for (const char* name : {"further", "another"}) {
            Node part;
            part.slot = slot.name;
            part.name = name;
            part.use = reference_part("sensor")->description->id;
            node.parts.push_back(part);
        }
        try {
            return std::make_unique<Instance>(bench.host(), bench.plugin(), node, Surroundings{});
        } catch (const std::exception&) {
            break;  // its motion has other axes
        }
    }
    return bench.make();
}

}  // namespace

PELORUS_CHECK(estimator, "estimator-spaces-well-formed", 2,
              "The state and its Cartesian components are named once each, positions first, with a prior for each; a "
              "track that does not know a component starts from it.",
              {}) {
    const auto instance = bench.make();
    const plr_estimator_info& info = *instance->table<plr_estimator>().info(instance->self());
    examine_space(info.state, "state");
    examine_space(info.cartesian, "cartesian");
    const std::int64_t axes = axes_of(*info.cartesian);
    if (axes < 1 || axes > 3) FAIL("info.cartesian has " << axes << " positions, expected 1 to 3");
    const char* const positions[] = {"position.x", "position.y", "position.z"};
    for (std::int64_t k = 0; k < axes; ++k)
        if (component_name(*info.cartesian, k) != positions[k])
            FAIL("info.cartesian: component " << k << " is " << component_name(*info.cartesian, k) << ", expected "
                                              << positions[k] << ": positions come first");
}

PELORUS_CHECK(estimator, "estimator-sensors-as-in-slot", 2,
              "info.sensors are the very parts of the slot, in its order; a tracker asks them for noise and sends each "
              "scan to the index of its sensor.",
              {}) {
    const auto instance = with_two_sensors(bench);
    const EstimatorBench filter(*instance);
    const auto parts = filter.parts(PLR_SENSOR);
    if (parts.empty()) skip("has no sensors of its own");
    if (parts.size() != filter.info.sensor_count)
        FAIL("info.sensor_count is " << filter.info.sensor_count << ", the slot holds " << parts.size());
    const auto* at = reinterpret_cast<const unsigned char*>(filter.info.sensors);
    for (std::size_t s = 0; s < parts.size(); ++s) {
        const auto& told = *reinterpret_cast<const plr_part*>(at);
        at += filter.info.sensors->struct_size;
        if (told.instance.self != parts[s]->instance.self || told.instance.table != parts[s]->instance.table)
            FAIL("info.sensors[" << s << "] is another instance than part " << s << " of the slot, `" << parts[s]->name
                                 << "`");
        if (std::strcmp(told.name, parts[s]->name) != 0)
            FAIL("info.sensors[" << s << "] is called `" << told.name << "`, the part `" << parts[s]->name << "`");
    }
}

PELORUS_CHECK(estimator, "estimator-assignable-as-declared", 2,
              "PLR_ESTIMATOR_ASSIGNABLE says whether assign is answered; a multiple-model filter mixes through it.",
              {}) {
    const auto instance = bench.make();
    const EstimatorCalls calls(*instance);
    const bool is_declared = (calls.info.flags & PLR_ESTIMATOR_ASSIGNABLE) != 0;
    if (is_declared && calls.table.assign == nullptr) FAIL("info.flags say PLR_ESTIMATOR_ASSIGNABLE, assign is NULL");
    if (!is_declared && calls.table.assign != nullptr)
        FAIL("assign is there, info.flags do not say PLR_ESTIMATOR_ASSIGNABLE: nobody will call it");
}

PELORUS_CHECK(estimator, "estimator-backward-as-declared", 2,
              "predict answers dt < 0 where PLR_ESTIMATOR_BACKWARD says so, and else PLR_E_UNSUPPORTED; a late scan "
              "must not be filtered by a step that means nothing.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    Sample sample = bench.sample();
    Argument dt = given("dt", Eigen::MatrixXd::Constant(1, 1, -0.5));
    // Not beyond what a filter of late measurements remembers.
    const Argument record = filter.step(filter.tracks(sample, 1), 1.0);
    const Execution done = execute(*instance, filter.predict(dt, record));
    const bool is_declared = (filter.info.flags & PLR_ESTIMATOR_BACKWARD) != 0;
    const plr_status status = done.status == PLR_ITEMS_FAILED ? done.items[0] : done.status;
    if (is_declared && status != PLR_OK)
        FAIL("predict by -0.5 s: info.flags say PLR_ESTIMATOR_BACKWARD, answered " << done.told());
    if (!is_declared && status != PLR_E_UNSUPPORTED)
        FAIL("predict by -0.5 s without PLR_ESTIMATOR_BACKWARD: answered " << status_name(status)
                                                                           << ", expected PLR_E_UNSUPPORTED");
}

PELORUS_CHECK(estimator, "estimator-zero-step-copies", 2,
              "A prediction by dt = 0 is a copy of the record, bit for bit: a second sensor at the same time must not "
              "let time pass.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    Sample sample = bench.sample();
    const Argument record = filter.tracks(sample, 5);
    same_bits("predict by dt = 0 changes the record", record.values, filter.step(record, 0.0).values);
}

PELORUS_CHECK(estimator, "estimator-in-place-same-bits", 2,
              "predict, update and assign give the same bits where `out` is `record` itself; trackers call them so.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    for (HotCall call : hot_calls(*instance, bench.sample(), 5)) {
        std::size_t record = 0;
        while (record < call.in.size() && call.in[record].name != "record") ++record;
        if (record == call.in.size() || call.out[0].name != "out") continue;
        const Execution apart = execute_well(*instance, call);
        // The record is copied to the output, and the output is given for both.
        call.invoke = [invoke = call.invoke, record](const plr_call& context, const Views& v) {
            const plr_const_view& from = v.in[record];
            std::copy_n(from.data, from.rows * from.count, v.out[0].data);
            Views views = v;
            views.in[record].data = v.out[0].data;
            return invoke(context, views);
        };
        same_bits(call.function + " with out == record", apart.out[0], execute_well(*instance, call).out[0]);
    }
}

PELORUS_CHECK(estimator, "estimator-refuses-unknown-sensor", 2,
              "project and update refuse an index that info.sensors does not have; the sensor that happens to lie "
              "there is none.",
              {"calls-come-back"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    Sample sample = bench.sample();
    const Argument record = filter.tracks(sample, 2);
    const Measured measured = measured_near(filter, 0, record, sample);
    const HotCall project = filter.project(0, record),
                  update = filter.update(0, record, measured.measurement, measured.noise);
    const auto count = static_cast<std::int32_t>(filter.info.sensor_count);
    for (const std::int32_t wrong : {-1, count, count + 1000}) {
        for (HotCall call : {project, update}) {
            const bool is_update = call.function == "update";
            call.invoke = [is_update, wrong, own = &filter.table, self = instance->self()](const plr_call& context,
                                                                                           const Views& v) {
                if (is_update) {
                    const plr_estimator_update args{sizeof args, wrong,    v.in[0],  v.in[1], v.in[2],
                                                    v.out[0],    v.out[1], v.out[2], v.out[3]};
                    return own->update(self, &context, &args);
                }
                const plr_estimator_project args{sizeof args, wrong, v.in[0], v.out[0], v.out[1], v.out[2], v.out[3]};
                return own->project(self, &context, &args);
            };
            const Execution done = execute(*instance, call);
            if (done.status == PLR_OK || (done.status == PLR_ITEMS_FAILED && !(done.failed(0) && done.failed(1))))
                FAIL(call.function << " by sensor " << wrong << " of " << count << ": answered "
                                   << status_name(done.status) << ", expected PLR_E_ARGUMENT");
        }
    }
}

PELORUS_CHECK(estimator, "estimator-optional-outputs", 2,
              "Outputs that may be absent (data NULL) are left out, and the others get the same bits; who wants a gate "
              "does not pay for a cross-covariance.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    // By name: the outputs that estimator.h lets a caller leave out.
    const std::set<std::string> optional{"cross", "cartesian_cross", "log_likelihood", "innovation",
                                         "innovation_covariance"};
    for (const HotCall& call : hot_calls(*instance, bench.sample(), 3)) {
        const bool tells_moments =
            call.function == "summary" || call.function == "moments" || call.function == "smoothed";
        const Execution all = execute_well(*instance, call);
        for (std::size_t left_out = 0; left_out < call.out.size(); ++left_out) {
            const std::string& name = call.out[left_out].name;
            if (optional.count(name) == 0 && !(tells_moments && name == "covariance")) continue;
            HotCall fewer = call;
            fewer.out[left_out].is_absent = true;
            INFO(call.function << " without `" << name << "`");
            const Execution some = execute_well(*instance, fewer);
            for (std::size_t o = 0; o < call.out.size(); ++o)
                if (o != left_out)
                    same_bits(call.function + " without `" + name + "`: `" + call.out[o].name + "`", all.out[o],
                              some.out[o]);
        }
    }
}

}  // namespace pelorus::conformance
