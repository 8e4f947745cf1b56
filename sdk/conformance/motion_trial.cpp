#include "motion_trial.hpp"

#include <cmath>

#include <fmt/format.h>

#include "differences.hpp"

namespace pelorus::conformance {

namespace {

Argument copies_of(const Argument& argument, std::int64_t item, std::int64_t times) {
    if (argument.is_absent) return argument;
    Argument copied = argument;
    copied.values.clear();
    const std::vector<double> one = HotCall::item_of(argument, argument.values, item);
    for (std::int64_t k = 0; k < times; ++k) copied.values.insert(copied.values.end(), one.begin(), one.end());
    return copied;
}

ExecuteOptions unguarded() {
    ExecuteOptions options;
    options.is_guarded = false;
    return options;
}

}  // namespace

MotionItems MotionItems::copies(std::int64_t item, std::int64_t times) const {
    return {copies_of(state, item, times), copies_of(covariance, item, times), copies_of(record, item, times),
            copies_of(extent, item, times), times};
}

MotionTrial::MotionTrial(const Bench& bench, std::uint64_t stream)
    : instance(bench.make()),
      table(motion_calls::table(*instance)),
      info(motion_calls::info(*instance)),
      state(*info.state),
      cartesian(*info.cartesian),
      scales(scales_of(*info.state)),
      cartesian_scales(scales_of(*info.cartesian)),
      sample(bench.sample(stream)),
      n(info.state->size) {}

MotionItems MotionTrial::draw(std::int64_t count) {
    Eigen::MatrixXd drawn(n, count);
    for (Eigen::Index i = 0; i < count; ++i) drawn.col(i) = sample.state(*info.state);
    return items_at(drawn);
}

MotionItems MotionTrial::items_at(const Eigen::MatrixXd& at) {
    MotionItems items;
    items.count = at.cols();
    items.state = columns("state", at);
    items.covariance = covariances("covariance", *info.state, sample, at.cols());
    items.record = motion_calls::initial_records(*instance, items.state, items.covariance);
    items.extent = motion_calls::extents(*instance, sample, at.cols());
    return items;
}

Eigen::MatrixXd MotionTrial::propagate(const Eigen::VectorXd& dt, const MotionItems& items) const {
    return answered(*instance,
                    motion_calls::propagate(*instance, steps(dt), items.state, items.record, absent("mean")));
}

Eigen::MatrixXd MotionTrial::propagate(const Eigen::VectorXd& dt, const Eigen::MatrixXd& states,
                                       const MotionItems& items) const {
    return answered(*instance, motion_calls::propagate(*instance, steps(dt), columns("state", states), items.record,
                                                       absent("mean")));
}

std::vector<Eigen::MatrixXd> MotionTrial::jacobian(const Eigen::VectorXd& dt, const MotionItems& items) const {
    return jacobian(dt, states_of(items), items);
}

std::vector<Eigen::MatrixXd> MotionTrial::jacobian(const Eigen::VectorXd& dt, const Eigen::MatrixXd& states,
                                                   const MotionItems& items) const {
    return answered_matrices(*instance, motion_calls::jacobian(*instance, steps(dt), columns("state", states),
                                                               items.record, absent("mean")));
}

HotCall MotionTrial::noise_call(const Eigen::VectorXd& dt, const MotionItems& items) const {
    const Argument predicted = columns("predicted", propagate(dt, items));
    return motion_calls::noise(*instance, steps(dt), items.state, items.covariance, predicted, items.extent,
                               items.record);
}

std::vector<Eigen::MatrixXd> MotionTrial::noise(const Eigen::VectorXd& dt, const MotionItems& items) const {
    return answered_matrices(*instance, noise_call(dt, items));
}

Argument columns(const std::string& name, const Eigen::MatrixXd& matrix) {
    return input(name, matrix.rows(), 1, matrix.cols(),
                 [&](double* out, std::int64_t i) { Eigen::Map<Eigen::VectorXd>(out, matrix.rows()) = matrix.col(i); });
}

Argument steps(const Eigen::VectorXd& dt) { return columns("dt", dt.transpose()); }

Eigen::MatrixXd states_of(const MotionItems& items) {
    return Eigen::Map<const Eigen::MatrixXd>(items.state.values.data(), items.state.rows, items.count);
}

Eigen::MatrixXd answered(const Instance& instance, const HotCall& call) {
    const Execution done = execute_well(instance, call, unguarded());
    return Eigen::Map<const Eigen::MatrixXd>(done.out[0].data(), call.out[0].rows, call.out[0].cols * call.count);
}

std::vector<Eigen::MatrixXd> answered_matrices(const Instance& instance, const HotCall& call, std::size_t output) {
    const Execution done = execute_well(instance, call, unguarded());
    std::vector<Eigen::MatrixXd> matrices;
    const std::int64_t size = call.out[output].rows * call.out[output].cols;
    for (std::int64_t i = 0; i < call.count; ++i)
        matrices.emplace_back(Eigen::Map<const Eigen::MatrixXd>(done.out[output].data() + i * size,
                                                                call.out[output].rows, call.out[output].cols));
    return matrices;
}

std::string first_difference(const Eigen::MatrixXd& got, const Eigen::MatrixXd& expected,
                             const Eigen::MatrixXd& allowed, const Space& rows, const Space& cols) {
    double worst = 1;
    std::string text;
    for (Eigen::Index c = 0; c < got.cols(); ++c)
        for (Eigen::Index r = 0; r < got.rows(); ++r) {
            const double off = std::fabs(got(r, c) - expected(r, c));
            if (off <= worst * allowed(r, c)) continue;
            worst = allowed(r, c) > 0 ? off / allowed(r, c) : HUGE_VAL;
            text = fmt::format("element ({}, {}) is {:.12g}, expected {:.12g}", rows[static_cast<int>(r)].name,
                               cols[static_cast<int>(c)].name, got(r, c), expected(r, c));
        }
    return text;
}

std::string first_difference(const Eigen::VectorXd& got, const Eigen::VectorXd& expected,
                             const Eigen::VectorXd& allowed, const Space& rows) {
    double worst = 1;
    std::string text;
    const Eigen::VectorXd off = difference_in(rows, got, expected);
    for (Eigen::Index r = 0; r < got.size(); ++r) {
        if (std::fabs(off(r)) <= worst * allowed(r)) continue;
        worst = allowed(r) > 0 ? std::fabs(off(r)) / allowed(r) : HUGE_VAL;
        text = fmt::format("{} is {:.12g}, expected {:.12g}", rows[static_cast<int>(r)].name, got(r), expected(r));
    }
    return text;
}

Eigen::MatrixXd element_scales(const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd deviations = covariance.diagonal().cwiseAbs().cwiseSqrt();
    return deviations * deviations.transpose();
}

}  // namespace pelorus::conformance
