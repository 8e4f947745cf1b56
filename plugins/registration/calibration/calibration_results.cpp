// What the stage tells of the biases: values while it runs, tables and scalars.
#include <algorithm>
#include <cmath>

#include "calibration_stage.hpp"

namespace calibration {

namespace {

constexpr std::size_t most_times = 256;  ///< of the table `biases`

}  // namespace

void CalibrationStage::publish_values(std::int64_t time) {
    pelorus::ValuesBuilder values;
    const BiasVector& b = biases_.estimate().value;
    const auto is_active = [&](int first, int last) {
        return std::any_of(biases_.active().begin(), biases_.active().end(),
                           [&](int bias) { return bias >= first && bias <= last; });
    };
    const std::string prefix = sensor_.name() + ".";
    const bool is_plane = sensor_.dimension() == 2;
    if (is_active(range_bias, range_bias)) {
        Eigen::VectorXd addends = Eigen::VectorXd::Zero(sensor_.space().size());
        addends(sensor_.space().index("range")) = b(range_bias);
        values.add("", prefix + "bias", bias_units_, addends);
    }
    if (is_active(roll, yaw))
        values.add("", prefix + "attitude_error", "rad",
                   Eigen::VectorXd(is_plane ? b.segment(yaw, 1) : b.segment(roll, 3)));
    if (is_active(offset_x, offset_z))
        values.add("", prefix + "platform_position", "m", Eigen::VectorXd(b.segment(offset_x, is_plane ? 2 : 3)));
    if (is_active(clock_offset, clock_offset)) values.add("", prefix + "clock_offset", "s", b.segment<1>(clock_offset));
    publish(values_out, values.message(time));
}

CalibrationStage::Row CalibrationStage::row_at(std::int64_t time) const {
    const Estimate& estimate = biases_.estimate();
    Row row{time, estimate.value, estimate.covariance.diagonal().cwiseMax(0.0).cwiseSqrt(), estimate.presence,
            BiasVector::Zero()};
    for (const int bias : biases_.active()) row.observable(bias) = is_observable(bias) ? 1 : 0;
    return row;
}

void CalibrationStage::note_observable(std::int64_t time) {
    for (const int bias : biases_.active())
        if (is_observable(bias) && std::isnan(observable_since_(bias)))
            observable_since_(bias) = static_cast<double>(time) * 1e-9;
}

/// At whole multiples of the spacing, so that the rows of several runs meet.
void CalibrationStage::add_rows(std::int64_t time) {
    if (time < next_row_) return;
    const std::int64_t multiple = time / row_spacing_ * row_spacing_;
    rows_.push_back(row_at(multiple));
    next_row_ = multiple + row_spacing_;
    if (rows_.size() < most_times) return;
    row_spacing_ *= 2;
    rows_.erase(
        std::remove_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.time % row_spacing_ != 0; }),
        rows_.end());
    next_row_ = (next_row_ + row_spacing_ - 1) / row_spacing_ * row_spacing_;
}

void CalibrationStage::publish_directions(std::int64_t time) {
    pelorus::ResultBuilder result("directions");
    result.column("rank", "", PLR_REDUCE_KEY);
    result.column("ratio", "", PLR_REDUCE_MEAN);
    for (const int bias : biases_.active())
        result.column(bias_names[static_cast<std::size_t>(bias)].name, "", PLR_REDUCE_MEAN);
    double rank = 0;
    for (const Direction& direction : biases_.directions()) {
        std::vector<double> row{++rank, direction.ratio};
        for (const int bias : biases_.active()) row.push_back(direction.share(bias));
        result.row(row);
    }
    publish(biases_out, result.message(time));
}

void CalibrationStage::finish(const pelorus::Event& event) {
    pelorus::ResultBuilder result("biases");
    std::vector<std::string> names;
    for (const int bias : biases_.active()) names.emplace_back(bias_names[static_cast<std::size_t>(bias)].name);
    if (names.empty()) return;
    result.column("time", "s", PLR_REDUCE_KEY);
    result.text_column("bias", PLR_REDUCE_KEY, names);
    result.column("value", "", PLR_REDUCE_MEAN);
    result.column("deviation", "", PLR_REDUCE_ROOT_MEAN_SQUARE);
    result.column("presence", "", PLR_REDUCE_MEAN);
    result.column("observable", "", PLR_REDUCE_MEAN);
    for (const Row& row : rows_)
        for (std::size_t k = 0; k < names.size(); ++k) {
            const int bias = biases_.active()[k];
            result.row({static_cast<double>(row.time) * 1e-9, static_cast<double>(k), row.value(bias),
                        row.deviation(bias), row.presence(bias), row.observable(bias)});
        }
    const Row last = row_at(event.time);
    for (std::size_t k = 0; k < names.size(); ++k) {
        const int bias = biases_.active()[k];
        const char* const unit = bias_names[static_cast<std::size_t>(bias)].unit;
        result.scalar(names[k], unit, PLR_REDUCE_MEAN, last.value(bias));
        result.scalar(names[k] + "_deviation", unit, PLR_REDUCE_ROOT_MEAN_SQUARE, last.deviation(bias));
        result.scalar(names[k] + "_observable", "", PLR_REDUCE_MEAN, last.observable(bias));
        result.scalar(names[k] + "_observable_since", "s", PLR_REDUCE_MEAN, observable_since_(bias));
    }
    publish(biases_out, result.message(event.time));
    publish_directions(event.time);
    if (pairs_ == 0 && log_ != nullptr && PLR_LOG_WARNING >= log_->level)
        log_->write(log_->context, PLR_LOG_WARNING,
                    ("nothing was learnt of sensor " + sensor_.name() + ": no fix of " + reference_.name() +
                     " has three frames around it within `window`")
                        .c_str());
}

}  // namespace calibration
