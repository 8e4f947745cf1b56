// The calls of a motion, with plausible arguments.
#include "motion_calls.hpp"

namespace pelorus::conformance {

namespace motion_calls {

namespace {

/// A call of that function of the table for as many items as the argument has.
HotCall call_for(const char* function, const Argument& per_item) {
    const std::int64_t size = per_item.rows * per_item.cols;
    return make_call(function, size == 0 ? 0 : static_cast<std::int64_t>(per_item.values.size()) / size);
}
std::int64_t states_of(const Instance& instance) { return info(instance).state->size; }
std::int64_t cartesians_of(const Instance& instance) { return info(instance).cartesian->size; }

Argument weightless(Argument argument, bool is_weightless = true) {
    argument.is_weightless = is_weightless;
    return argument;
}

/// The inputs of noise. Which of them it reads is its own affair, dt apart.
std::vector<Argument> noise_inputs(const Argument& dt, const Argument& state, const Argument& covariance,
                                   const Argument& predicted, const Argument& extent, const Argument& record) {
    return {renamed(dt, "dt"),
            weightless(renamed(state, "state")),
            weightless(renamed(covariance, "covariance")),
            weightless(renamed(predicted, "predicted")),
            weightless(renamed(extent, "extent")),
            weightless(renamed(record, "record"))};
}
plr_motion_noise noise_arguments(const Views& v) {
    return {sizeof(plr_motion_noise), 0, v.in[0], v.in[1], v.in[2], v.in[3], v.in[4], v.in[5], v.out[0]};
}

}  // namespace

HotCall propagate(const Instance& instance, const Argument& dt, const Argument& state, const Argument& record,
                  const Argument& mean) {
    HotCall call = call_for(state.cols == 1 ? "propagate" : "propagate (points)", state);
    call.in = {renamed(dt, "dt"), renamed(state, "state"), weightless(renamed(record, "record")),
               weightless(renamed(mean, "mean"))};
    call.out = {output("out", state.rows, state.cols)};
    call.invoke = [motion = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_motion_propagate args{sizeof args, 0, v.in[0], v.in[1], v.in[3], v.in[2], v.out[0]};
        return motion->propagate(self, &context, &args);
    };
    return call;
}

HotCall jacobian(const Instance& instance, const Argument& dt, const Argument& state, const Argument& record,
                 const Argument& mean) {
    HotCall call = call_for("jacobian", state);
    const bool is_linear = (info(instance).flags & PLR_MOTION_LINEAR) != 0;
    call.in = {renamed(dt, "dt"), weightless(renamed(state, "state"), is_linear), weightless(renamed(record, "record")),
               weightless(renamed(mean, "mean"))};
    call.out = {output("out", state.rows, state.rows)};
    call.invoke = [motion = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_motion_jacobian args{sizeof args, 0, v.in[0], v.in[1], v.in[3], v.in[2], v.out[0]};
        return motion->jacobian(self, &context, &args);
    };
    return call;
}

HotCall noise(const Instance& instance, const Argument& dt, const Argument& state, const Argument& covariance,
              const Argument& predicted, const Argument& extent, const Argument& record) {
    HotCall call = call_for("noise", dt);
    call.in = noise_inputs(dt, state, covariance, predicted, extent, record);
    call.out = {output("out", states_of(instance), states_of(instance), Content::covariance)};
    call.invoke = [motion = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_motion_noise args = noise_arguments(v);
        return motion->noise(self, &context, &args);
    };
    return call;
}

HotCall noise_factor(const Instance& instance, const Argument& dt, const Argument& state, const Argument& covariance,
                     const Argument& predicted, const Argument& extent, const Argument& record) {
    const auto* extension = instance.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
    HotCall call = call_for("noise_factor.factor", dt);
    call.in = noise_inputs(dt, state, covariance, predicted, extent, record);
    call.out = {output("out", states_of(instance), extension->columns)};
    call.invoke = [extension, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_motion_noise args = noise_arguments(v);
        return extension->factor(self, &context, &args);
    };
    return call;
}

HotCall blocks(const Instance& instance, double dt) {
    const auto* extension = instance.extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
    HotCall call = make_call("structure.blocks", 1);
    call.is_per_item = false;
    call.takes_pointers = true;
    call.in = {input("dt", 1, 1, 1, [dt](double* out, std::int64_t) { *out = dt; })};
    // F1 as one column: the table takes bare pointers, column-major whatever the strides of views.
    call.out = {output("f1", std::int64_t{extension->block} * extension->block, 1),
                output("q1", extension->block, extension->block, Content::covariance)};
    call.invoke = [extension, self = instance.self()](const plr_call& context, const Views& v) {
        if (v.out[0].count == 0) return plr_status{PLR_OK};
        // Bare pointers tell the plugin no shape that it could refuse.
        if (v.out[0].rows != std::int64_t{extension->block} * extension->block || v.out[1].rows != extension->block)
            return plr_status{PLR_E_ARGUMENT};
        return extension->blocks(self, &context, *v.in[0].data, v.out[0].data, v.out[1].data);
    };
    return call;
}

HotCall init_record(const Instance& instance, const Argument& state, const Argument& covariance) {
    HotCall call = call_for("init_record", state);
    call.in = {weightless(renamed(state, "state")), weightless(renamed(covariance, "covariance"))};
    call.out = {output("out", info(instance).record_size, 1, Content::opaque)};
    call.invoke = [motion = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_motion_record args{sizeof args, 0, {}, v.in[0], v.in[1], {}, v.out[0]};
        return motion->init_record(self, &context, &args);
    };
    return call;
}

HotCall advance_record(const Instance& instance, const Argument& dt, const Argument& state, const Argument& covariance,
                       const Argument& record) {
    HotCall call = call_for("advance_record", state);
    call.in = {weightless(renamed(dt, "dt")), weightless(renamed(state, "state")),
               weightless(renamed(covariance, "covariance")), weightless(renamed(record, "record"))};
    call.out = {output("out", info(instance).record_size, 1, Content::opaque)};
    call.invoke = [motion = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_motion_record args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.in[3], v.out[0]};
        return motion->advance_record(self, &context, &args);
    };
    return call;
}

HotCall to_cartesian(const Instance& instance, const Argument& state) {
    HotCall call = call_for(state.cols == 1 ? "to_cartesian" : "to_cartesian (points)", state);
    call.in = {renamed(state, "in")};
    call.out = {output("out", cartesians_of(instance), state.cols),
                state.cols == 1 ? output("jacobian", cartesians_of(instance), state.rows) : absent("jacobian")};
    call.invoke = [motion = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_motion_convert args{sizeof args, 0, v.in[0], v.out[0], v.out[1]};
        return motion->to_cartesian(self, &context, &args);
    };
    return call;
}

HotCall from_cartesian(const Instance& instance, const Argument& cartesian) {
    HotCall call = call_for(cartesian.cols == 1 ? "from_cartesian" : "from_cartesian (points)", cartesian);
    // Components that the state lacks are ignored.
    call.in = {weightless(renamed(cartesian, "in"), cartesians_of(instance) > states_of(instance))};
    call.out = {output("out", states_of(instance), cartesian.cols),
                cartesian.cols == 1 ? output("jacobian", states_of(instance), cartesian.rows) : absent("jacobian")};
    call.invoke = [motion = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_motion_convert args{sizeof args, 0, v.in[0], v.out[0], v.out[1]};
        return motion->from_cartesian(self, &context, &args);
    };
    return call;
}

Argument initial_records(const Instance& instance, const Argument& state, const Argument& covariance) {
    const std::int64_t size = info(instance).record_size;
    if (size == 0) return absent("record");
    const HotCall call = init_record(instance, state, covariance);
    Argument records = input("record", size, 1, call.count, [](double*, std::int64_t) {});
    if (call.count > 0) records.values = execute_leniently(instance, call).out[0];
    return records;
}

Argument extents(const Instance& instance, Sample& sample, std::int64_t count) {
    if ((info(instance).flags & PLR_MOTION_USES_EXTENT) == 0) return absent("extent");
    const std::int64_t d = axes_of(*info(instance).cartesian);
    return input("extent", d, d, count, [&](double* out, std::int64_t) {
        Eigen::Map<Eigen::MatrixXd>(out, d, d) = sample.covariance(Eigen::VectorXd::Constant(d, 10.0));
    });
}

}  // namespace motion_calls

namespace {

std::vector<HotCall> calls_of(const Instance& instance, Sample sample, std::int64_t count) {
    using namespace motion_calls;
    const plr_motion& motion = table(instance);
    const plr_space& space = *info(instance).state;
    const std::int64_t n = space.size, points = 2 * n + 1;
    const Argument dt = input("dt", 1, 1, count, [&](double* out, std::int64_t) { *out = sample.step(); });
    const Argument state = states("state", space, sample, count);
    const Argument covariance = covariances("covariance", space, sample, count);
    const Argument record = initial_records(instance, state, covariance);
    const Argument extent = extents(instance, sample, count);
    Argument predicted = state;
    if (count > 0)
        predicted.values = execute_leniently(instance, propagate(instance, dt, state, record, absent("mean"))).out[0];
    const Eigen::VectorXd spread = 0.01 * scales_of(space);
    const Argument spread_about = input("state", n, points, count, [&](double* out, std::int64_t i) {
        for (std::int64_t p = 0; p < points; ++p) {
            Eigen::Map<Eigen::VectorXd> point(out + p * n, n);
            point = item(state, i).col(0);
            for (Eigen::Index r = 0; p > 0 && r < n; ++r) point(r) += spread(r) * sample.normal();
        }
    });
    std::vector<HotCall> calls{propagate(instance, dt, state, record, absent("mean")),
                               propagate(instance, dt, spread_about, record, state),
                               jacobian(instance, dt, state, record, absent("mean")),
                               noise(instance, dt, state, covariance, predicted, extent, record)};
    if (motion.init_record != nullptr && info(instance).record_size > 0)
        calls.push_back(init_record(instance, state, covariance));
    if (motion.advance_record != nullptr && info(instance).record_size > 0)
        calls.push_back(advance_record(instance, dt, state, covariance, record));
    if (motion.to_cartesian != nullptr) calls.push_back(to_cartesian(instance, state));
    if (motion.from_cartesian != nullptr)
        calls.push_back(from_cartesian(instance, states("in", *info(instance).cartesian, sample, count)));
    if (instance.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR) != nullptr)
        calls.push_back(noise_factor(instance, dt, state, covariance, predicted, extent, record));
    if (instance.extension<plr_motion_structure>(PLR_MOTION_STRUCTURE) != nullptr)
        calls.push_back(blocks(instance, sample.step()));
    return calls;
}

const detail::KindRegistration registration(PLR_MOTION, &calls_of, [](const Instance& instance) {
    return motion_calls::info(instance).scratch_bytes;
});

}  // namespace

}  // namespace pelorus::conformance
