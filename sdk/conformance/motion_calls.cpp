// The calls of a motion, with plausible arguments.
#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance {

namespace {

struct MotionCalls {
    MotionCalls(const Instance& instance_, Sample sample_, std::int64_t count_)
        : instance(instance_),
          table(instance_.table<plr_motion>()),
          info(*table.info(instance_.self())),
          sample(sample_),
          count(count_),
          n(info.state->size),
          c(info.cartesian->size),
          dt(input("dt", 1, 1, count, [&](double* out, std::int64_t) { *out = sample.step(); })),
          state(states("state", *info.state, sample, count)),
          covariance(covariances("covariance", *info.state, sample, count)),
          record(info.record_size == 0 ? absent("record") : initial_record()) {}

    std::vector<HotCall> all() {
        std::vector<HotCall> calls{propagate("propagate", 1), propagate("propagate (points)", 2 * n + 1), jacobian(),
                                   noise()};
        if (info.record_size > 0) {
            calls.push_back(init_record());
            calls.push_back(advance_record());
        }
        if (table.to_cartesian != nullptr) calls.push_back(to_cartesian());
        if (table.from_cartesian != nullptr) calls.push_back(from_cartesian());
        return calls;
    }

private:
    HotCall propagate(const char* name, std::int64_t points) {
        HotCall call = make_call(name, count);
        Argument spread = input("state", n, points, count, [&](double* out, std::int64_t i) {
            for (std::int64_t p = 0; p < points; ++p) {
                Eigen::Map<Eigen::VectorXd> point(out + p * n, n);
                point = item(state, i).col(0);
                if (p > 0) point += 0.01 * scales_of(*info.state) * sample.normal();
            }
        });
        call.in = {dt, spread, record, points == 1 ? absent("mean") : renamed(state, "mean")};
        call.out = {output("out", n, points)};
        call.invoke = [this_table = &table, self = instance.self()](const plr_call& context, const Views& v) {
            const plr_motion_propagate args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.out[0], v.in[3]};
            return this_table->propagate(self, &context, &args);
        };
        return call;
    }
    HotCall jacobian() {
        HotCall call = make_call("jacobian", count);
        call.in = {dt, state, record};
        call.out = {output("out", n, n)};
        call.invoke = [this_table = &table, self = instance.self()](const plr_call& context, const Views& v) {
            const plr_motion_jacobian args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.out[0], {}};
            return this_table->jacobian(self, &context, &args);
        };
        return call;
    }
    HotCall noise() {
        HotCall call = make_call("noise", count);
        const bool uses_extent = (info.flags & PLR_MOTION_USES_EXTENT) != 0;
        const std::int64_t d = axes_of(*info.cartesian);
        Argument extent = absent("extent");
        if (uses_extent)
            extent = input("extent", d, d, count, [&](double* out, std::int64_t) {
                Eigen::Map<Eigen::MatrixXd>(out, d, d) = sample.covariance(Eigen::VectorXd::Constant(d, 10.0));
            });
        call.in = {dt, state, covariance, renamed(state, "predicted"), extent, record};
        call.out = {output("out", n, n, Content::covariance)};
        call.invoke = [this_table = &table, self = instance.self()](const plr_call& context, const Views& v) {
            const plr_motion_noise args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.in[3], v.in[4], v.in[5], v.out[0]};
            return this_table->noise(self, &context, &args);
        };
        return call;
    }
    HotCall init_record() {
        HotCall call = make_call("init_record", count);
        call.in = {state, covariance};
        call.out = {output("out", info.record_size, 1, Content::opaque)};
        call.invoke = [this_table = &table, self = instance.self()](const plr_call& context, const Views& v) {
            const plr_motion_record args{sizeof args, 0, {}, v.in[0], v.in[1], {}, v.out[0]};
            return this_table->init_record(self, &context, &args);
        };
        return call;
    }
    HotCall advance_record() {
        HotCall call = make_call("advance_record", count);
        call.in = {dt, state, covariance, record};
        call.out = {output("out", info.record_size, 1, Content::opaque)};
        call.invoke = [this_table = &table, self = instance.self()](const plr_call& context, const Views& v) {
            const plr_motion_record args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.in[3], v.out[0]};
            return this_table->advance_record(self, &context, &args);
        };
        return call;
    }
    HotCall to_cartesian() {
        HotCall call = make_call("to_cartesian", count);
        call.in = {renamed(state, "in")};
        call.out = {output("out", c, 1), output("jacobian", c, n)};
        call.invoke = [this_table = &table, self = instance.self()](const plr_call& context, const Views& v) {
            const plr_motion_convert args{sizeof args, 0, v.in[0], v.out[0], v.out[1]};
            return this_table->to_cartesian(self, &context, &args);
        };
        return call;
    }
    HotCall from_cartesian() {
        HotCall call = make_call("from_cartesian", count);
        call.in = {states("in", *info.cartesian, sample, count)};
        call.out = {output("out", n, 1), output("jacobian", n, c)};
        call.invoke = [this_table = &table, self = instance.self()](const plr_call& context, const Views& v) {
            const plr_motion_convert args{sizeof args, 0, v.in[0], v.out[0], v.out[1]};
            return this_table->from_cartesian(self, &context, &args);
        };
        return call;
    }
    Argument initial_record() {
        Argument filled = input("record", info.record_size, 1, count, [](double*, std::int64_t) {});
        filled.values = execute_well(instance, init_record()).out[0];
        return filled;
    }

    const Instance& instance;
    const plr_motion& table;
    const plr_motion_info& info;
    Sample sample;
    std::int64_t count, n, c;
    Argument dt, state, covariance, record;
};

const detail::KindRegistration registration(
    PLR_MOTION,
    [](const Instance& instance, Sample sample, std::int64_t count) {
        return MotionCalls(instance, sample, count).all();
    },
    [](const Instance& instance) { return instance.table<plr_motion>().info(instance.self())->scratch_bytes; });

}  // namespace

}  // namespace pelorus::conformance
