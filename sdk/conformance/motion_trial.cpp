#include "motion_trial.hpp"

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

Eigen::VectorXd MotionTrial::drawn_steps(std::int64_t count) {
    Eigen::VectorXd dt(count);
    for (Eigen::Index i = 0; i < count; ++i) dt(i) = sample.step();
    return dt;
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

Eigen::MatrixXd MotionTrial::to_cartesian(const Eigen::MatrixXd& states) const {
    if (table.to_cartesian == nullptr) return states;
    return answered(*instance, motion_calls::to_cartesian(*instance, columns("in", states)));
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

Argument steps(const Eigen::VectorXd& dt) { return columns("dt", dt.transpose()); }

Eigen::MatrixXd states_of(const MotionItems& items) {
    return Eigen::Map<const Eigen::MatrixXd>(items.state.values.data(), items.state.rows, items.count);
}

}  // namespace pelorus::conformance
