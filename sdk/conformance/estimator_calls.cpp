#include "estimator_calls.hpp"

#include <algorithm>
#include <numeric>

namespace pelorus::conformance {

namespace {

std::int64_t items_in(const Argument& argument) {
    return static_cast<std::int64_t>(argument.values.size()) / std::max<std::int64_t>(1, argument.rows * argument.cols);
}

std::vector<std::int32_t> first_components(std::int64_t count) {
    std::vector<std::int32_t> components(static_cast<std::size_t>(count));
    std::iota(components.begin(), components.end(), 0);
    return components;
}

}  // namespace

HotCall EstimatorCalls::init(const std::vector<std::int32_t>& components, const Argument& mean,
                             const Argument& covariance) const {
    HotCall call = make_call(static_cast<std::int64_t>(components.size()) == c ? "init" : "init (some components)",
                             items_in(mean));
    call.in = {mean, covariance};
    call.out = {output("record", info.record_size, 1, Content::opaque)};
    call.invoke = [own = &table, self = instance.self(), components](const plr_call& context, const Views& v) {
        const plr_estimator_init args{
            sizeof args, static_cast<std::uint32_t>(components.size()), components.data(), v.in[0], v.in[1], v.out[0]};
        return own->init(self, &context, &args);
    };
    return call;
}

HotCall EstimatorCalls::predict(const Argument& dt, const Argument& record) const {
    HotCall call = make_call("predict", items_in(record));
    const bool uses_extent = (info.flags & PLR_ESTIMATOR_USES_EXTENT) != 0;
    call.in = {dt, uses_extent ? extent(call.count) : absent("extent"), record};
    call.out = {output("out", info.record_size, 1, Content::opaque)};
    call.invoke = [own = &table, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_estimator_predict args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.out[0]};
        return own->predict(self, &context, &args);
    };
    return call;
}

HotCall EstimatorCalls::project(std::int32_t sensor, const Argument& record) const {
    const std::int64_t m = measured(sensor);
    HotCall call = make_call("project", items_in(record));
    call.in = {record};
    call.out = {output("measurement", m, 1), output("covariance", m, m, Content::covariance), output("cross", n, m),
                output("cartesian_cross", c, m)};
    call.invoke = [own = &table, self = instance.self(), sensor](const plr_call& context, const Views& v) {
        const plr_estimator_project args{sizeof args, sensor, v.in[0], v.out[0], v.out[1], v.out[2], v.out[3]};
        return own->project(self, &context, &args);
    };
    return call;
}

HotCall EstimatorCalls::update(std::int32_t sensor, const Argument& record, const Argument& measurement,
                               const Argument& noise) const {
    const std::int64_t m = measured(sensor);
    HotCall call = make_call("update", items_in(record));
    call.in = {record, measurement, noise};
    call.out = {output("out", info.record_size, 1, Content::opaque), output("log_likelihood", 1, 1),
                output("innovation", m, 1), output("innovation_covariance", m, m, Content::covariance)};
    call.invoke = [own = &table, self = instance.self(), sensor](const plr_call& context, const Views& v) {
        const plr_estimator_update args{sizeof args, sensor,   v.in[0],  v.in[1], v.in[2],
                                        v.out[0],    v.out[1], v.out[2], v.out[3]};
        return own->update(self, &context, &args);
    };
    return call;
}

HotCall EstimatorCalls::moments_call(const char* name, MomentsFunction function, std::int64_t size,
                                     const Argument& record) const {
    HotCall call = make_call(name, items_in(record));
    call.in = {record};
    call.out = {output("mean", size, 1), output("covariance", size, size, Content::covariance)};
    call.invoke = [function, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_estimator_moments args{sizeof args, 0, v.in[0], v.out[0], v.out[1]};
        return function(self, &context, &args);
    };
    return call;
}

HotCall EstimatorCalls::assign(const Argument& record, const Argument& mean, const Argument& covariance) const {
    HotCall call = make_call("assign", items_in(record));
    call.in = {record, mean, covariance};
    call.out = {output("out", info.record_size, 1, Content::opaque)};
    call.invoke = [own = &table, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_estimator_assign args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.out[0]};
        return own->assign(self, &context, &args);
    };
    return call;
}

HotCall EstimatorCalls::mix(const Argument& weights, const Argument& records) const {
    HotCall call = make_call("mix", items_in(weights));
    call.in = {weights, records};
    call.out = {output("out", info.record_size, 1, Content::opaque)};
    const auto* const extension = instance.extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX);
    call.invoke = [extension, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_estimator_mix_args args{sizeof args, 0, v.in[0], v.in[1], v.out[0]};
        return extension->mix(self, &context, &args);
    };
    return call;
}

HotCall EstimatorCalls::probabilities(const Argument& record) const {
    const auto* const extension = instance.extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
    HotCall call = make_call("probabilities", items_in(record));
    call.in = {record};
    call.out = {output("probabilities", extension->mode_count, 1)};
    call.invoke = [extension, self = instance.self()](const plr_call& context, const Views& v) {
        return extension->probabilities(self, &context, &v.in[0], &v.out[0]);
    };
    return call;
}

HotCall EstimatorCalls::smoothed(const Argument& record) const {
    const auto* const extension = instance.extension<plr_estimator_smoothed>(PLR_ESTIMATOR_SMOOTHED);
    const std::int64_t most = extension->most;
    HotCall call = make_call("smoothed", items_in(record));
    call.in = {record};
    call.out = {output("known", 1, 1), output("age", most, 1), output("mean", c, most),
                output("covariance", c, c * most)};
    call.invoke = [extension, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_estimator_smoothed_args args{sizeof args, 0, v.in[0], v.out[0], v.out[1], v.out[2], v.out[3]};
        return extension->smoothed(self, &context, &args);
    };
    return call;
}

const plr_sensor_info& EstimatorCalls::sensor_info(std::int32_t sensor) const {
    const auto* const at = reinterpret_cast<const unsigned char*>(info.sensors) +
                           std::size_t{info.sensors->struct_size} * static_cast<std::size_t>(sensor);
    const plr_instance& part = reinterpret_cast<const plr_part*>(at)->instance;
    return *reinterpret_cast<const plr_sensor*>(part.table)->info(part.self);
}

Argument EstimatorCalls::argument(const HotCall& call, const Execution& done, std::size_t output,
                                  const std::string& name) {
    Argument as_input = call.out[output];
    as_input.name = name;
    as_input.values = done.out[output];
    return as_input;
}

Argument EstimatorCalls::extent(std::int64_t count) const {
    return input("extent", axes, axes, count, [&](double* out, std::int64_t) {
        Eigen::Map<Eigen::MatrixXd>(out, axes, axes) = 25.0 * Eigen::MatrixXd::Identity(axes, axes);
    });
}

Measured measured_near(const EstimatorCalls& calls, std::int32_t sensor, const Argument& record, Sample& sample) {
    const plr_space& space = *calls.sensor_info(sensor).measurement;
    const HotCall project = calls.project(sensor, record);
    const Execution seen = execute_leniently(calls.instance, project);
    // Some 10 m, some milliradians.
    const Eigen::VectorXd deviations = 1e-3 * scales_of(space);
    Measured measured;
    measured.noise = input("noise", space.size, space.size, project.count, [&](double* out, std::int64_t) {
        Eigen::Map<Eigen::MatrixXd>(out, space.size, space.size) = sample.covariance(deviations);
    });
    measured.measurement = EstimatorCalls::argument(project, seen, 0, "measurement");
    Eigen::Map<Eigen::MatrixXd> z(measured.measurement.values.data(), space.size, project.count);
    for (Eigen::Index i = 0; i < z.cols(); ++i)
        for (Eigen::Index r = 0; r < z.rows(); ++r) z(r, i) += deviations(r) * sample.normal();
    return measured;
}

Argument estimator_records(const EstimatorCalls& calls, Sample& sample, std::int64_t count) {
    const Argument mean = states("mean", *calls.info.cartesian, sample, count);
    const Argument covariance = covariances("covariance", *calls.info.cartesian, sample, count);
    HotCall call = calls.init(first_components(calls.c), mean, covariance);
    Argument record = EstimatorCalls::argument(call, execute_leniently(calls.instance, call), 0, "record");
    const Argument dt = input("dt", 1, 1, count, [&](double* out, std::int64_t) { *out = sample.uniform(0.05, 2.0); });
    call = calls.predict(dt, record);
    record = EstimatorCalls::argument(call, execute_leniently(calls.instance, call), 0, "record");
    if (calls.info.sensor_count == 0) return record;
    const Measured measured = measured_near(calls, 0, record, sample);
    call = calls.update(0, record, measured.measurement, measured.noise);
    return EstimatorCalls::argument(call, execute_leniently(calls.instance, call), 0, "record");
}

namespace {

HotCall named(HotCall call, const std::string& function) {
    call.function = function;
    return call;
}

std::vector<HotCall> all_calls(const Instance& instance, Sample sample, std::int64_t count) {
    const EstimatorCalls calls(instance);
    const Argument record = estimator_records(calls, sample, count);
    const Argument dt = input("dt", 1, 1, count, [&](double* out, std::int64_t) { *out = sample.step(); });
    std::vector<HotCall> all{calls.init(first_components(calls.c), states("mean", *calls.info.cartesian, sample, count),
                                        covariances("covariance", *calls.info.cartesian, sample, count)),
                             calls.init(first_components(calls.axes),
                                        input("mean", calls.axes, 1, count,
                                              [&](double* out, std::int64_t) {
                                                  for (std::int64_t k = 0; k < calls.axes; ++k)
                                                      out[k] = sample.uniform(-2e4, 2e4);
                                              }),
                                        input("covariance", calls.axes, calls.axes, count,
                                              [&](double* out, std::int64_t) {
                                                  Eigen::Map<Eigen::MatrixXd>(out, calls.axes, calls.axes) =
                                                      sample.covariance(Eigen::VectorXd::Constant(calls.axes, 30.0));
                                              })),
                             calls.predict(dt, record)};
    const auto sensors = static_cast<std::int32_t>(calls.info.sensor_count);
    for (std::int32_t s = 0; s < std::min(sensors, 3); ++s) {
        const std::string which = s == 0 ? "" : " (sensor " + std::to_string(s) + ")";
        const Measured measured = measured_near(calls, s, record, sample);
        all.push_back(named(calls.project(s, record), "project" + which));
        all.push_back(named(calls.update(s, record, measured.measurement, measured.noise), "update" + which));
    }
    all.push_back(calls.summary(record));
    all.push_back(calls.moments(record));
    if (calls.table.assign != nullptr) {
        // Its own moments of another track: plausible for any state space.
        const Execution told = execute_leniently(instance, all.back());
        Argument mean = EstimatorCalls::argument(all.back(), told, 0, "mean");
        Argument covariance = EstimatorCalls::argument(all.back(), told, 1, "covariance");
        std::rotate(mean.values.begin(), mean.values.begin() + calls.n, mean.values.end());
        std::rotate(covariance.values.begin(), covariance.values.begin() + calls.n * calls.n, covariance.values.end());
        all.push_back(calls.assign(record, mean, covariance));
    }
    if (instance.extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX) != nullptr) {
        const Argument other = estimator_records(calls, sample, count);
        const std::int64_t r = calls.info.record_size;
        all.push_back(calls.mix(input("weights", 2, 1, count,
                                      [&](double* out, std::int64_t) {
                                          out[0] = sample.uniform();
                                          out[1] = 1 - out[0];
                                      }),
                                input("records", r, 2, count, [&](double* out, std::int64_t i) {
                                    std::copy_n(record.values.data() + i * r, r, out);
                                    std::copy_n(other.values.data() + i * r, r, out + r);
                                })));
    }
    if (instance.extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES) != nullptr)
        all.push_back(calls.probabilities(record));
    if (instance.extension<plr_estimator_smoothed>(PLR_ESTIMATOR_SMOOTHED) != nullptr)
        all.push_back(calls.smoothed(record));
    return all;
}

const detail::KindRegistration registration(PLR_ESTIMATOR, all_calls, [](const Instance& instance) {
    return instance.table<plr_estimator>().info(instance.self())->scratch_bytes;
});

}  // namespace

}  // namespace pelorus::conformance
