#include "plugin_filter.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <pelorus/matrix.hpp>

namespace pelorus::bench {

namespace {

constexpr std::size_t scratch_bytes = std::size_t{1} << 20;
constexpr std::int64_t doubles_of_measurement = sizeof(plain::Measurement) / sizeof(double);

graph::Graph build(host::Catalog& catalog, int states, const std::string& estimator, const std::string& form) {
    const std::string folder = PELORUS_SOURCE_DIR "/bench/configs/";
    std::vector<graph::Override> overrides{{"tracker.estimator.use", estimator}};
    if (!form.empty()) overrides.push_back({"tracker.estimator.form", form});
    const graph::Document document =
        graph::Document::load(folder + (states == 9 ? "filter.yaml" : "filter_6_states.yaml"), overrides);
    return graph::Graph::build(document, catalog, {});
}

EstimatorPart estimator_of(const graph::Graph& graph, std::vector<plr_part>& models) {
    models = graph.models();
    for (const plr_part& model : models)
        if (std::strcmp(model.table_id, PLR_ESTIMATOR) == 0) return EstimatorPart(model);
    throw std::logic_error("no estimator in the filter's config");
}

}  // namespace

PluginFilter::PluginFilter(std::size_t count, int states, const std::string& estimator, const std::string& form)
    : catalog_({PELORUS_PLUGIN_DIR}),
      graph_(build(catalog_, states, estimator, form)),
      estimator_(estimator_of(graph_, models_)),
      count_(count),
      memory_(new unsigned char[scratch_bytes + 64]),
      inputs_(static_cast<std::size_t>(graph_.nodes().back().config->input_size), 0.0),
      status_(count, PLR_OK) {
    if (estimator_.info().record_size != states + states * states || estimator_.info().sensor_count != 2)
        throw std::logic_error("the filter's config does not give " + std::to_string(states) +
                               " states and two sensors");
    const auto address = reinterpret_cast<std::uintptr_t>(memory_.get());
    scratch_ = {memory_.get() + (64 - address % 64) % 64, scratch_bytes, 0};
    error_.struct_size = sizeof error_;
    call_.struct_size = sizeof call_;
    call_.inputs = inputs_.empty() ? nullptr : inputs_.data();
    call_.scratch = &scratch_;
    call_.error = &error_;
    call_.item_status = status_.data();
}

const plr_call& PluginFilter::begin() {
    std::fill(status_.begin(), status_.end(), PLR_OK);
    error_.code = PLR_OK;
    scratch_.used = 0;
    return call_;
}

plr_const_view PluginFilter::records(const double* tracks) const {
    return const_view(tracks, estimator_.info().record_size, 1, static_cast<std::int64_t>(count_));
}
plr_view PluginFilter::records(double* tracks) const {
    return view(tracks, estimator_.info().record_size, 1, static_cast<std::int64_t>(count_));
}

bool PluginFilter::assign(const double* moments, double* to) {
    const std::int64_t n = estimator_.info().state->size, size = n + n * n, count = static_cast<std::int64_t>(count_);
    auto args = arguments<plr_estimator_assign>();
    args.record = records(moments);
    args.mean = {moments, n, 1, count, 1, n, size};
    args.covariance = {moments + n, n, n, count, 1, n, size};
    args.out = records(to);
    return estimator_.call(&plr_estimator::assign, begin(), args) == PLR_OK;
}

bool PluginFilter::predict(const double* from, double* to, double dt) {
    auto args = arguments<plr_estimator_predict>();
    args.dt = common_view(&dt, 1, 1, static_cast<std::int64_t>(count_));
    args.record = records(from);
    args.out = records(to);
    return estimator_.call(&plr_estimator::predict, begin(), args) == PLR_OK;
}

bool PluginFilter::update(plain::Sensor sensor, const double* from, const plain::Measurement* measurements, double* to,
                          double* log_likelihood) {
    const auto count = static_cast<std::int64_t>(count_);
    auto args = arguments<plr_estimator_update>();
    args.sensor = sensor == plain::Sensor::position ? 0 : 1;
    args.record = records(from);
    args.measurement = {measurements->value.data(), 3, 1, count, 1, 3, doubles_of_measurement};
    args.noise = {measurements->noise.data(), 3, 3, count, 1, 3, doubles_of_measurement};
    args.out = records(to);
    args.log_likelihood = view(log_likelihood, 1, 1, count);
    return estimator_.call(&plr_estimator::update, begin(), args) == PLR_OK;
}

std::string PluginFilter::failure() const { return error_.message; }

}  // namespace pelorus::bench
