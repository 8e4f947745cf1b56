// What a point filter is made from, and its prediction.
#include "point_filter.hpp"

#include "blocks.hpp"

namespace gaussian {

using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;

namespace {

/// Items of a block, so that its points fit into some 100 kB.
std::int64_t items_of_block(const PointRule& rule) noexcept {
    return std::clamp<std::int64_t>(512 / rule.count(), 1, block_size);
}

/// The axis that a component belongs to, or nothing: what follows the dot in position.x.
std::string axis_of(const pelorus::Component& component) {
    const std::size_t dot = component.name.rfind('.');
    return dot == std::string::npos ? std::string() : component.name.substr(dot + 1);
}

/// The indices of a space's components, axis by axis.
std::vector<int> by_axes(const pelorus::Space& space) {
    std::vector<std::string> axes;
    for (const pelorus::Component& component : space.components()) {
        const std::string axis = axis_of(component);
        if (!axis.empty() && std::find(axes.begin(), axes.end(), axis) == axes.end()) axes.push_back(axis);
    }
    axes.emplace_back();
    std::vector<int> order;
    for (const std::string& axis : axes) {
        for (int i = 0; i < space.size(); ++i) {
            if (axis_of(space[i]) == axis) order.push_back(i);
        }
    }
    return order;
}

}  // namespace

void PointFilter::setup_points(const PointRule& rule, ComponentOrder order, plr_estimator_info& info) {
    rule_ = rule;
    items_ = items_of_block(rule);
    setup_factors();
    const int n = static_cast<int>(n_);
    for (int r = 0; r < n; ++r) all_rows_.push_back(r);
    if (order == ComponentOrder::axes) order_ = by_axes(state_);
    if (order_ == all_rows_) order_.clear();
    regress_ = factor_kernels_by_items([&](const FactorKernels& all) { return all.regression(n); });

    const std::int64_t kept = kept_items(items_) * (image_doubles(n, n) + n_ * n_);
    std::int64_t doubles = linear_doubles();
    doubles = std::max(doubles, (kept + items_ * (step_doubles() + 2 * n_ * rule.count())) / block_size + 1);
    for (const SensorInSlot& sensor : sensors_) {
        lookers_.push_back(looker_of(sensor));
        doubles = std::max(doubles, look_doubles(lookers_.size() - 1) / block_size + 1);
    }
    info.scratch_bytes = scratch_for(doubles);
}

PointFilter::Looker PointFilter::looker_of(const SensorInSlot& sensor) const {
    const int n = static_cast<int>(n_), m = static_cast<int>(sensor.m);
    Looker looker;
    looker.rows = all_rows_;
    std::int64_t leading = n_;
    if (state_is_cartesian_) {
        looker.rows.assign(sensor.index.begin(), sensor.index.end());
        leading = 0;
        for (const int row : looker.rows) {
            const auto place = order_.empty() ? row : std::find(order_.begin(), order_.end(), row) - order_.begin();
            leading = std::max<std::int64_t>(leading, place + 1);
        }
    }
    looker.rule = leading_rule(rule_, leading);
    looker.items = items_of_block(looker.rule);
    looker.regress = factor_kernels_by_items([&](const FactorKernels& all) { return all.regression(m); });
    looker.look = factor_kernels_by_items([&](const FactorKernels& all) { return all.look(n, m); });
    looker.is_linear = state_is_cartesian_ && (sensor.part.info().flags & PLR_SENSOR_LINEAR) != 0;
    const pelorus::Space measurement(*sensor.part.info().measurement);
    for (int r = 0; r < measurement.size(); ++r) {
        if (measurement[r].angle) looker.angles.push_back(r);
    }
    return looker;
}

plr_status PointFilter::predict(const plr_call& call, const plr_estimator_predict& args) const {
    check_predict(args);
    const bool is_linear = (motion_.info().flags & PLR_MOTION_LINEAR) != 0;
    return in_runs(
        call, args, [&](const plr_call& here, const plr_estimator_predict& run) { return copy_records(here, run); },
        [&](const plr_call& here, const plr_estimator_predict& run) {
            if (structure_ != nullptr) return predict_structured(here, run);
            return is_linear ? predict_linearised(here, run) : predict_points(here, run);
        });
}

void PointFilter::place(const plr_call& call, const PointRule& rule, const std::vector<int>& rows,
                        const plr_const_view& records, double* factors, const plr_view& out) const {
    const std::int64_t items = records.count;
    const Points points = points_of(rule);
    Outcomes outcomes = still_good(call, items);
    state_kernels_(items).place({static_cast<int>(n_), static_cast<int>(items), is_root(),
                                 order_.empty() ? nullptr : order_.data(), items_of(records), factors, &points,
                                 rows.data(), static_cast<int>(rows.size()), items_of(out), outcomes.data()});
    tolerate(settled(call, items, outcomes));
}

plr_status PointFilter::predict_points(const plr_call& call, const plr_estimator_predict& args) const {
    const int n = static_cast<int>(n_);
    const std::int64_t p = rule_.count(), room = kept_items(items_);
    const std::int64_t kept = room * (image_doubles(n, n) + n_ * n_);
    const Scratch scratch(call, kept + items_ * (step_doubles() + 2 * n_ * p));
    const Points points = points_of(rule_);
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_estimator_predict part = part_of(args, first, items);
        const Image image = image_of(points, n, false, scratch.data());
        double* const memory = scratch.data() + kept;
        const plr_view placed = pelorus::view(memory, n_, p, items);
        const plr_view moved = pelorus::view(memory + items * n_ * p, n_, p, items);
        const Step told = step(memory + 2 * items * n_ * p, items, false);
        place(block, rule_, all_rows_, part.record, scratch.data() + room * image_doubles(n, n), placed);
        auto propagate = pelorus::arguments<plr_motion_propagate>();
        propagate.dt = part.dt;
        propagate.state = as_const(placed);
        propagate.record = motion_record(part.record);
        propagate.out = moved;
        propagate.mean = mean(part.record);
        tolerate(motion_.call(&plr_motion::propagate, block, propagate));

        for (std::int64_t i = 0; i < items; ++i) {
            double* const values = at(moved, i);  // become differences from the centre's, which stays
            for (std::int64_t k = 1; k < p; ++k) {
                for (std::int64_t r = 0; r < n_; ++r) values[k * n_ + r] -= values[r];
                wrap(values + k * n_);
            }
        }
        Outcomes outcomes = still_good(block, items);
        const ItemsIn values = items_of(as_const(moved));
        regress_(items)({n, n, static_cast<int>(items), &points, values, values, items_of(told.predicted), image.kept,
                         outcomes.data()});
        for (std::int64_t i = 0; i < items; ++i) wrap(at(told.predicted, i));
        noise_and_record(block, part, told);
        return finish(block, told, image, part.out);
    };
    return in_blocks(call, args.out.count, body, items_);
}

}  // namespace gaussian
