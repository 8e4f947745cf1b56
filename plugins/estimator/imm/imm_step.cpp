// The filter's step: mixing and prediction, the look of a sensor, update.
#include "imm.hpp"

#include <cmath>
#include <limits>

namespace imm {

using pelorus::NumericError;
using pelorus::Scratch;
using pelorus::slice;

// -------------------------------------------------------------------------------------------------- prediction

plr_status Filter::predict(const plr_call& call, const plr_estimator_predict& args) const {
    expect_packed(args.dt, 1, 1, args.out.count, "dt");
    expect_packed(args.record, record_size_, 1, args.out.count, "record");
    expect_packed(args.out, record_size_, 1, args.out.count, "out");
    return in_runs(
        call, args, [&](const plr_call& here, const plr_estimator_predict& run) { return stand(here, run); },
        [&](const plr_call& here, const plr_estimator_predict& run) { return move(here, run); });
}

/// The filters copy themselves.
plr_status Filter::stand(const plr_call& call, const plr_estimator_predict& args) const {
    predict_models(call, args, args.record);
    return keep_heads(call, args.record, args.out);
}

void Filter::predict_models(const plr_call& call, const plr_estimator_predict& args, const plr_const_view& from) const {
    for (const Model& model : models_) {
        plr_estimator_predict own = args;
        own.record = records_of(model, from);
        own.out = records_of(model, args.out);
        tolerate(model.part.call(&plr_estimator::predict, call, own));
    }
}

plr_status Filter::move(const plr_call& call, const plr_estimator_predict& args) const {
    const Scratch scratch(call, moment_doubles(false));
    return in_blocks(call, args.out.count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        plr_estimator_predict here = args;
        here.dt = slice(args.dt, first, items);
        here.extent = slice(args.extent, first, items);
        here.record = slice(args.record, first, items);
        here.out = slice(args.out, first, items);
        ask_moments(block, here.record, false, scratch.data());
        const plr_status mixed = for_good_items(block, items, [&](std::int64_t i) {
            double weights[max_models];
            const double dt = *at(here.dt, i), *const before = weights_of(here.record, i);
            mix(dt, before, scratch.data(), i, weights);
            if (warm_up_) at(here.out, i)[count()] = before[count()] + dt;
            std::copy_n(weights, count(), at(here.out, i));
        });
        if (mixed < 0) return mixed;
        assign_models(block, here, scratch.data());
        predict_models(block, here, pelorus::as_const(here.out));
        return for_good_items(block, items, [](std::int64_t) {});
    });
}

/// Each model starts from a mixture of all, in the place of its own moments; `after` gets how likely the models are then. `head` is
/// that of the record before.
void Filter::mix(double dt, const double* head, double* memory, std::int64_t item, double* after) const {
    const Transitions chain = chain_.step(dt, warm_up_ ? head[count()] : 0.0, head[0] > 0);
    Gaussian<max_state> models[max_models];
    load(state_, false, memory, item, models);
    for (int j = 0; j < count(); ++j) {
        double weights[max_models];
        after[j] = 0;
        for (int i = 0; i < count(); ++i) after[j] += weights[i] = chain.from_to[i][j] * head[i];
        // A model that nobody comes to goes on by itself; one that has no part yet, or none any more, goes with the others.
        for (int i = 0; i < count(); ++i)
            weights[i] = after[j] > 0 ? weights[i] / after[j] : warm_up_ ? head[i] : static_cast<double>(i == j);
        const Gaussian<max_state> mixed = mixture(models, weights, count(), state_.angles);
        const std::int64_t n = models_[static_cast<std::size_t>(j)].n;
        state_.places[static_cast<std::size_t>(j)].narrowed(mixed, memory + item * n,
                                                            memory + block_size * n + item * n * n);
        memory += block_size * (n + n * n);
    }
}

void Filter::assign_models(const plr_call& block, const plr_estimator_predict& args, double* memory) const {
    for (const Model& model : models_) {
        const std::int64_t n = model.n;
        auto own = pelorus::arguments<plr_estimator_assign>();
        own.record = records_of(model, args.record);
        own.mean = pelorus::const_view(memory, n, 1, args.out.count);
        own.covariance = pelorus::const_view(memory + block_size * n, n, n, args.out.count);
        own.out = records_of(model, args.out);
        tolerate(model.part.call(&plr_estimator::assign, block, own));
        memory += block_size * (n + n * n);
    }
}

// ------------------------------------------------------------------------------------------------ measurements

/// `memory` gets, for one model after the other, block_size measurements and block_size covariances H P H'.
void Filter::look(const plr_call& block, std::int32_t index, const plr_const_view& records, double* memory,
                  const Crosses& crosses) const {
    const std::int64_t m = sensor(index).m;
    for (std::size_t j = 0; j < models_.size(); ++j) {
        const Model& model = models_[j];
        auto ask = pelorus::arguments<plr_estimator_project>();
        ask.sensor = model.sensors[static_cast<std::size_t>(index)];
        ask.record = records_of(model, records);
        ask.measurement = pelorus::view(memory, m, 1, records.count);
        ask.covariance = pelorus::view(memory + block_size * m, m, m, records.count);
        if (crosses.state != nullptr)
            ask.cross = pelorus::view(crosses.of(crosses.state, j, m), model.n, m, records.count);
        if (crosses.cartesian != nullptr)
            ask.cartesian_cross = pelorus::view(crosses.of(crosses.cartesian, j, m), model.c, m, records.count);
        tolerate(model.part.call(&plr_estimator::project, block, ask));
        memory += block_size * (m + m * m);
    }
}

void Filter::load_looks(const SeenBy& by, const double* memory, std::int64_t item,
                        Gaussian<max_measurement>* out) const {
    for (int j = 0; j < count(); ++j) {
        out[j].mean = Eigen::Map<const Column<max_measurement>>(memory + item * by.m, by.m, 1);
        out[j].covariance =
            Eigen::Map<const Square<max_measurement>>(memory + block_size * by.m + item * by.m * by.m, by.m, by.m);
        memory += block_size * (by.m + by.m * by.m);
    }
}

plr_status Filter::project(const plr_call& call, const plr_estimator_project& args) const {
    const SeenBy& by = sensor(args.sensor);
    const std::int64_t total = args.measurement.count, m = by.m;
    expect_packed(args.record, record_size_, 1, total, "record");
    expect_packed(args.measurement, m, 1, total, "measurement");
    expect_packed(args.covariance, m, m, total, "covariance");
    const bool in_state = args.cross.data != nullptr, in_cartesian = args.cartesian_cross.data != nullptr;
    if (in_state) expect_packed(args.cross, state_.size(), m, total, "cross");
    if (in_cartesian) expect_packed(args.cartesian_cross, cartesian_.size(), m, total, "cartesian_cross");
    const Scratch looks(call, block_size * count() * (m + m * m));
    const std::int64_t crossed = block_size * count() * max_state * m;
    const Scratch crosses(call, in_state || in_cartesian ? crossed : 0);
    const Scratch states(call, in_state || in_cartesian ? moment_doubles(in_cartesian) : 0);
    return in_blocks(call, total, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = slice(args.record, first, items);
        const auto tell = [&](bool is_cartesian, const plr_view& cross) {
            Crosses wanted;
            (is_cartesian ? wanted.cartesian : wanted.state) = crosses.data();
            look(block, args.sensor, records, looks.data(), wanted);
            ask_moments(block, records, is_cartesian, states.data());
            tolerate(for_good_items(block, items, [&](std::int64_t i) {
                tell_cross(by, is_cartesian, {looks.data(), crosses.data(), states.data()}, weights_of(records, i), i,
                           at(cross, first + i));
            }));
        };
        if (in_state) tell(false, args.cross);
        if (in_cartesian) tell(true, args.cartesian_cross);
        if (!in_state && !in_cartesian) look(block, args.sensor, records, looks.data(), {});
        return for_good_items(block, items, [&](std::int64_t i) {
            Gaussian<max_measurement> each[max_models];
            load_looks(by, looks.data(), i, each);
            const auto mixed = mixture(each, weights_of(records, i), count(), by.angles);
            if (!pelorus::small::all_finite(mixed.mean) || !pelorus::small::all_finite(mixed.covariance))
                throw NumericError("the mixture of the models is not finite");
            std::copy_n(mixed.mean.data(), m, at(args.measurement, first + i));
            std::copy_n(mixed.covariance.data(), m * m, at(args.covariance, first + i));
        });
    });
}

/// sum mu_j (P_j H' + (x_j - x)(z_j - z)'); a component that a model has not does not vary with what it measures.
void Filter::tell_cross(const SeenBy& by, bool is_cartesian, const Looked& looked, const double* weights,
                        std::int64_t item, double* out) const {
    const JoinedSpace& joined = is_cartesian ? cartesian_ : state_;
    Gaussian<max_measurement> each[max_models];
    load_looks(by, looked.looks, item, each);
    Gaussian<max_state> models[max_models];
    load(joined, is_cartesian, looked.states, item, models);
    const auto seen = offsets_of(each, weights, count(), by.angles);
    const auto apart = offsets_of(models, weights, count(), joined.angles);
    const int n = joined.size();
    std::fill_n(out, n * by.m, 0.0);
    for (std::size_t j = 0; j < models_.size(); ++j) {
        const std::int64_t k = is_cartesian ? models_[j].c : models_[j].n;
        const double* const own = Crosses::of(looked.crosses, j, by.m) + item * k * by.m;
        for (int col = 0; col < static_cast<int>(by.m); ++col) {
            for (int row = 0; row < n; ++row) out[col * n + row] += weights[j] * apart.of[j](row) * seen.of[j](col);
            for (int row = 0; row < static_cast<int>(k); ++row)
                out[col * n + joined.places[j].at(row)] += weights[j] * own[col * k + row];
        }
    }
    if (!all_finite(out, n * by.m)) throw NumericError("the cross-covariance of the models is not finite");
}

plr_status Filter::update(const plr_call& call, const plr_estimator_update& args) const {
    const SeenBy& by = sensor(args.sensor);
    const std::int64_t total = args.out.count, m = by.m;
    expect_packed(args.record, record_size_, 1, total, "record");
    expect_packed(args.measurement, m, 1, total, "measurement");
    expect_packed(args.noise, m, m, total, "noise");
    expect_packed(args.out, record_size_, 1, total, "out");
    if (args.log_likelihood.data != nullptr) expect_packed(args.log_likelihood, 1, 1, total, "log_likelihood");
    if (args.innovation.data != nullptr) expect_packed(args.innovation, m, 1, total, "innovation");
    if (args.innovation_covariance.data != nullptr)
        expect_packed(args.innovation_covariance, m, m, total, "innovation_covariance");
    const Scratch scratch(call, block_size * (count() * (m + m * m + 1) + m));
    return in_blocks(call, total, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        plr_estimator_update here = args;
        here.record = slice(args.record, first, items);
        here.measurement = slice(args.measurement, first, items);
        here.noise = slice(args.noise, first, items);
        here.out = slice(args.out, first, items);
        here.innovation = slice(args.innovation, first, items);
        here.innovation_covariance = slice(args.innovation_covariance, first, items);
        double* const likelihoods = scratch.data();
        if (args.innovation.data != nullptr || args.innovation_covariance.data != nullptr)
            tell_innovation(block, here, likelihoods + block_size * count());
        update_models(block, here, likelihoods);
        return for_good_items(block, items, [&](std::int64_t i) {
            double each[max_models], after[max_models], log_likelihood = 0;
            for (int j = 0; j < count(); ++j) each[j] = likelihoods[j * block_size + i];
            weigh(weights_of(here.record, i), each, after, log_likelihood);
            if (warm_up_) at(here.out, i)[count()] = at(here.record, i)[count()];
            std::copy_n(after, count(), at(here.out, i));
            if (args.log_likelihood.data != nullptr) *at(args.log_likelihood, first + i) = log_likelihood;
        });
    });
}

void Filter::update_models(const plr_call& block, const plr_estimator_update& args, double* likelihoods) const {
    for (const Model& model : models_) {
        plr_estimator_update own = args;
        own.sensor = model.sensors[static_cast<std::size_t>(args.sensor)];
        own.record = records_of(model, args.record);
        own.out = records_of(model, args.out);
        own.log_likelihood = pelorus::view(likelihoods, 1, 1, args.out.count);
        own.innovation = own.innovation_covariance = pelorus::absent_output();
        tolerate(model.part.call(&plr_estimator::update, block, own));
        likelihoods += block_size;
    }
}

/// mu_j = c_j L_j / sum c_k L_k, and ln of that sum; relative to the largest term, which may be as small as it likes.
void Filter::weigh(const double* before, const double* log_likelihoods, double* after, double& told) const {
    double largest = -std::numeric_limits<double>::infinity(), sum = 0;
    for (int j = 0; j < count(); ++j)
        if (before[j] > 0) largest = std::max(largest, log_likelihoods[j]);
    if (!std::isfinite(largest)) throw NumericError("no model explains the measurement");
    for (int j = 0; j < count(); ++j)
        sum += after[j] = before[j] > 0 ? before[j] * std::exp(log_likelihoods[j] - largest) : 0.0;
    for (int j = 0; j < count(); ++j) after[j] /= sum;
    told = largest + std::log(sum);
    if (!std::isfinite(told)) throw NumericError("the likelihood of the models is not finite");
}

/// The innovation and its covariance are those of the mixture.
void Filter::tell_innovation(const plr_call& block, const plr_estimator_update& args, double* memory) const {
    const SeenBy& by = sensor(args.sensor);
    const std::int64_t m = by.m, items = args.out.count;
    double* const predicted = memory + block_size * count() * (m + m * m);
    look(block, args.sensor, args.record, memory, {});
    tolerate(for_good_items(block, items, [&](std::int64_t i) {
        Gaussian<max_measurement> each[max_models];
        load_looks(by, memory, i, each);
        const auto mixed = mixture(each, weights_of(args.record, i), count(), by.angles);
        std::copy_n(mixed.mean.data(), m, predicted + i * m);
        if (args.innovation_covariance.data == nullptr) return;
        double* const s = at(args.innovation_covariance, i);
        const double* const noise = at(args.noise, i);
        for (std::int64_t col = 0; col < m; ++col)
            for (std::int64_t row = 0; row < m; ++row)
                s[col * m + row] =
                    mixed.covariance.data()[col * m + row] + 0.5 * (noise[col * m + row] + noise[row * m + col]);
        if (!all_finite(s, m * m)) throw NumericError("the innovation covariance is not finite");
    }));
    if (args.innovation.data == nullptr) return;
    auto compare = pelorus::arguments<plr_sensor_residual>();
    compare.measurement = args.measurement;
    compare.reference = pelorus::const_view(predicted, m, 1, items);
    compare.out = args.innovation;
    tolerate(by.part.call(&plr_sensor::residual, block, compare));
}

}  // namespace imm
