#include "estimator_bench.hpp"

#include <cstring>

#include "machine/check.hpp"

namespace pelorus::conformance {

namespace {

Eigen::MatrixXd matrix(const HotCall& call, const Execution& done, std::size_t output) {
    return Eigen::Map<const Eigen::MatrixXd>(done.out[output].data(), call.out[output].rows, call.out[output].cols);
}
/// Who writes where it should not is found by the checks of all models; here there are many calls.
ExecuteOptions plain_memory() {
    ExecuteOptions options;
    options.is_guarded = false;
    return options;
}
std::vector<std::int32_t> components_up_to(std::int64_t count) {
    std::vector<std::int32_t> components;
    for (std::int32_t k = 0; k < count; ++k) components.push_back(k);
    return components;
}

}  // namespace

Argument given(const std::string& name, const Eigen::MatrixXd& value) {
    return input(name, value.rows(), value.cols(), 1,
                 [&](double* out, std::int64_t) { std::copy_n(value.data(), value.size(), out); });
}

std::string component_name(const plr_space& space, std::int64_t index) {
    const auto* const at = reinterpret_cast<const unsigned char*>(space.components) +
                           static_cast<std::size_t>(index) * space.components->struct_size;
    return reinterpret_cast<const plr_component*>(at)->name;
}

EstimatorBench::EstimatorBench(const Instance& instance_) : EstimatorCalls(instance_) {
    const auto motions = parts(PLR_MOTION);
    if (motions.size() == 1 && parts(PLR_ESTIMATOR).empty()) motion_ = motions.front();
}

std::vector<const plr_part*> EstimatorBench::parts(const char* table_id) const {
    std::vector<const plr_part*> found;
    const plr_config& config = instance.config();
    const auto* at = reinterpret_cast<const unsigned char*>(config.parts);
    for (std::uint32_t i = 0; i < config.part_count; ++i) {
        const auto* const part = reinterpret_cast<const plr_part*>(at);
        if (std::strcmp(part->table_id, table_id) == 0) found.push_back(part);
        at += part->struct_size;
    }
    return found;
}

std::string EstimatorBench::state_name(std::int64_t index) const { return component_name(*info.state, index); }

Argument EstimatorBench::run(const HotCall& call) const {
    return argument(call, execute_well(instance, call, plain_memory()), 0, "record");
}

Argument EstimatorBench::start(const Gaussian& cartesian) const {
    return run(init(components_up_to(c), given("mean", cartesian.mean), given("covariance", cartesian.covariance)));
}

Argument EstimatorBench::step(const Argument& record, double dt) const {
    Argument common = given("dt", Eigen::MatrixXd::Constant(1, 1, dt));
    common.is_common = true;
    return run(predict(common, record));
}

Argument EstimatorBench::item_of(const Argument& record, std::int64_t index) {
    Argument one = record;
    one.values = HotCall::item_of(record, record.values, index);
    return one;
}

Gaussian EstimatorBench::gaussian(const HotCall& call) const {
    const Execution done = execute_well(instance, call, plain_memory());
    return {matrix(call, done, 0), matrix(call, done, 1)};
}

EstimatorBench::Projection EstimatorBench::project_of(std::int32_t sensor, const Argument& record) const {
    const HotCall call = project(sensor, record);
    const Execution done = execute_well(instance, call, plain_memory());
    return {matrix(call, done, 0), matrix(call, done, 1), matrix(call, done, 2), matrix(call, done, 3)};
}

EstimatorBench::Updated EstimatorBench::update_of(std::int32_t sensor, const Argument& record,
                                                  const Eigen::VectorXd& measurement,
                                                  const Eigen::MatrixXd& noise) const {
    const HotCall call = update(sensor, record, given("measurement", measurement), given("noise", noise));
    const Execution done = execute_well(instance, call, plain_memory());
    return {argument(call, done, 0, "record"), done.out[1][0], matrix(call, done, 2), matrix(call, done, 3)};
}

void EstimatorBench::wants_linear_motion() const {
    if (motion_ == nullptr) skip("has several motions, or nested estimators");
    const auto& own = *reinterpret_cast<const plr_motion*>(motion_->instance.table);
    const plr_motion_info& told = *own.info(motion_->instance.self);
    constexpr std::uint32_t linear = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE;
    if ((told.flags & linear) != linear || told.record_size != 0 || own.to_cartesian != nullptr)
        skip("the motion is not linear, or its noise is not constant");
    if ((info.flags & PLR_ESTIMATOR_ASSIGNABLE) == 0) skip("the filter is not one of two moments");
}

std::vector<std::int32_t> EstimatorBench::linear_sensors() const {
    std::vector<std::int32_t> linear;
    for (std::int32_t sensor = 0; sensor < static_cast<std::int32_t>(info.sensor_count); ++sensor)
        if ((sensor_info(sensor).flags & PLR_SENSOR_LINEAR) != 0) linear.push_back(sensor);
    if (linear.empty()) skip("no sensor is linear");
    if (motion_ == nullptr) skip("has several motions, or nested estimators");
    if (reinterpret_cast<const plr_motion*>(motion_->instance.table)->to_cartesian != nullptr)
        skip("the state is not Cartesian");
    if ((info.flags & PLR_ESTIMATOR_ASSIGNABLE) == 0) skip("the filter is not one of two moments");
    return linear;
}

EstimatorBench::Step EstimatorBench::motion_step(double dt, const Gaussian& state) const {
    const auto* const own = reinterpret_cast<const plr_motion*>(motion_->instance.table);
    HotCall call = make_call("the motion's propagate, jacobian and noise", 1);
    call.in = {given("dt", Eigen::MatrixXd::Constant(1, 1, dt)), given("state", state.mean),
               given("covariance", state.covariance), absent("nothing")};
    call.out = {output("predicted", n, 1), output("jacobian", n, n), output("noise", n, n)};
    call.invoke = [own, self = motion_->instance.self](const plr_call& context, const Views& v) {
        const plr_const_view none = v.in[3];
        const plr_motion_propagate moving{sizeof moving, 0, v.in[0], v.in[1], none, none, v.out[0]};
        plr_status status = own->propagate(self, &context, &moving);
        if (status != PLR_OK) return status;
        const plr_motion_jacobian deriving{sizeof deriving, 0, v.in[0], v.in[1], none, none, v.out[1]};
        status = own->jacobian(self, &context, &deriving);
        if (status != PLR_OK) return status;
        const plr_view& p = v.out[0];
        const plr_const_view predicted{p.data, p.rows, p.cols, p.count, p.row_stride, p.col_stride, p.item_stride};
        const plr_motion_noise adding{sizeof adding, 0, v.in[0], v.in[1], v.in[2], predicted, none, none, v.out[2]};
        return own->noise(self, &context, &adding);
    };
    const Execution done = execute_well(instance, call, plain_memory());
    return {matrix(call, done, 1), matrix(call, done, 2)};
}

Eigen::MatrixXd EstimatorBench::sensor_jacobian(std::int32_t sensor, const Eigen::VectorXd& cartesian) const {
    const auto* const at = reinterpret_cast<const unsigned char*>(info.sensors) +
                           std::size_t{info.sensors->struct_size} * static_cast<std::size_t>(sensor);
    const plr_instance& part = reinterpret_cast<const plr_part*>(at)->instance;
    const plr_space& looks_at = *sensor_info(sensor).cartesian;
    const std::int64_t m = measured(sensor);
    std::vector<std::int64_t> where;
    for (std::int64_t k = 0; k < looks_at.size; ++k)
        for (std::int64_t s = 0; s < c; ++s)
            if (component_name(looks_at, k) == component_name(*info.cartesian, s)) where.push_back(s);
    Eigen::VectorXd seen(looks_at.size);
    for (std::int64_t k = 0; k < seen.size(); ++k) seen(k) = cartesian(where[static_cast<std::size_t>(k)]);
    HotCall call = make_call("the sensor's jacobian", 1);
    call.in = {given("cartesian", seen)};
    call.out = {output("out", m, seen.size())};
    call.invoke = [own = reinterpret_cast<const plr_sensor*>(part.table), self = part.self](const plr_call& context,
                                                                                            const Views& v) {
        const plr_sensor_jacobian args{sizeof args, 0, v.in[0], v.out[0]};
        return own->jacobian(self, &context, &args);
    };
    const Eigen::MatrixXd derivative = matrix(call, execute_well(instance, call), 0);
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(m, c);
    for (std::int64_t k = 0; k < seen.size(); ++k) h.col(where[static_cast<std::size_t>(k)]) = derivative.col(k);
    return h;
}

}  // namespace pelorus::conformance
