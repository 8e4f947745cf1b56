// What a point filter is made from, and its prediction.
#include "point_filter.hpp"

namespace gaussian {

using pelorus::as_const;
using pelorus::Scratch;
using pelorus::slice;

namespace {

/// Items of a block, so that its points fit into some 100 kB.
std::int64_t items_of(const PointRule& rule) noexcept {
    return std::clamp<std::int64_t>(512 / rule.count(), 1, block_size);
}

}  // namespace

void PointFilter::setup_points(const PointRule& rule, plr_estimator_info& info) {
    rule_ = rule;
    items_ = items_of(rule);
    setup_factors();
    for (std::int64_t r = 0; r < n_; ++r) all_rows_.push_back(r);

    std::int64_t doubles = linear_doubles();
    doubles = std::max(doubles, items_ * (step_doubles() + 2 * n_ * rule.count() + n_ * n_ + n_) / block_size + 1);
    for (const SensorInSlot& sensor : sensors_) {
        Looker looker;
        const std::int64_t last = *std::max_element(sensor.index.begin(), sensor.index.end());
        looker.rule = leading_rule(rule, state_is_cartesian_ ? last + 1 : n_);
        looker.items = items_of(looker.rule);
        looker.kernel = update_kernel(form_, static_cast<int>(n_), static_cast<int>(sensor.m));
        looker.is_linear = state_is_cartesian_ && (sensor.part.info().flags & PLR_SENSOR_LINEAR) != 0;
        const pelorus::Space measurement(*sensor.part.info().measurement);
        for (int r = 0; r < measurement.size(); ++r) {
            if (measurement[r].angle) looker.angles.push_back(r);
        }
        lookers_.push_back(std::move(looker));
        const std::size_t here = lookers_.size() - 1;
        doubles = std::max(doubles, lookers_[here].items * look_doubles(here) / block_size + 1);
    }
    info.scratch_bytes = scratch_for(doubles);
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

plr_status PointFilter::predict_points(const plr_call& call, const plr_estimator_predict& args) const {
    const std::int64_t p = rule_.count(), own_doubles = 2 * n_ * p + n_ * n_ + n_;
    const Scratch scratch(call, items_ * (step_doubles() + own_doubles));
    const auto body = [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        plr_estimator_predict part = args;
        part.dt = slice(args.dt, first, items);
        part.extent = slice(args.extent, first, items);
        part.record = slice(args.record, first, items);
        double* const memory = scratch.data();
        const plr_view points = pelorus::view(memory, n_, p, items);
        const plr_view moved = pelorus::view(memory + items * n_ * p, n_, p, items);
        double* const slopes = memory + 2 * items * n_ * p;
        double* const downdates = slopes + items * n_ * n_;
        const Step told = step(memory + items * own_doubles, items, false);
        const plr_const_view roots = factors(block, part.record, slopes);  // which are made later
        for (std::int64_t i = 0; i < items; ++i)
            place_points(rule_, at(part.record, i), at(roots, i), n_, all_rows_, at(points, i));
        auto propagate = pelorus::arguments<plr_motion_propagate>();
        propagate.dt = part.dt;
        propagate.state = as_const(points);
        propagate.record = motion_record(part.record);
        propagate.out = moved;
        propagate.mean = mean(part.record);
        tolerate(motion_.call(&plr_motion::propagate, block, propagate));

        std::array<Image, block_size> images;
        for (std::int64_t i = 0; i < items; ++i) {
            double* const values = at(moved, i);
            double* const predicted = at(told.predicted, i);
            std::copy_n(values, n_, predicted);
            for (std::int64_t k = 1; k < p; ++k) {
                for (std::int64_t r = 0; r < n_; ++r) values[k * n_ + r] -= predicted[r];
                wrap(values + k * n_);
            }
            double shift[max_state];
            images[static_cast<std::size_t>(i)] =
                regress(rule_, n_, n_, values, shift, slopes + i * n_ * n_, downdates + i * n_);
            for (std::int64_t r = 0; r < n_; ++r) predicted[r] += shift[r];
            wrap(predicted);
        }
        noise_and_record(block, part, told);
        return for_good_items(block, items, [&](std::int64_t i) {
            finish(told, images[static_cast<std::size_t>(i)], i, at(args.out, first + i));
        });
    };
    return in_blocks(call, args.out.count, body, items_);
}

}  // namespace gaussian
