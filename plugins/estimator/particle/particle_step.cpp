// The filter's step: prediction, the look of a sensor, weights, drawing anew.
#include <cmath>

#include "cloud.hpp"
#include "particle.hpp"

namespace particle {

using batches::at;
using batches::block_size;
using batches::expect_packed;
using pelorus::NumericError;
using pelorus::Scratch;
namespace small = pelorus::small;

namespace {

constexpr double least_log_weight = -1e6;

}  // namespace

// -------------------------------------------------------------------------------------------------- prediction

plr_status Particle::predict(const plr_call& call, const plr_estimator_predict& args) const {
    expect_packed(args.dt, 1, 1, args.out.count, "dt");
    expect_packed(args.record, info.record_size, 1, args.out.count, "record");
    expect_packed(args.out, info.record_size, 1, args.out.count, "out");
    const Scratch scratch(call, memory_doubles());
    return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
        expect_sound(at(args.record, i));
        if (args.out.data != args.record.data) std::copy_n(at(args.record, i), info.record_size, at(args.out, i));
        const double dt = at(args.dt, i)[0];
        if (dt < 0) throw pelorus::UnsupportedError("dt is below 0; noise that has been drawn is not taken back");
        if (dt != 0.0) move_item(call, args, i, memory(scratch.data()));
    });
}

void Particle::move_item(const plr_call& call, const plr_estimator_predict& args, std::int64_t item,
                         const Memory& memory) const {
    const Cloud<double> own = cloud(at(args.out, item));
    const PartCall part(call, item);
    Step step{at(args.dt, item)[0], args.extent, draw(call, item, own.draws)};
    if (step.extent.data != nullptr) {
        step.extent.data += item * step.extent.item_stride;
        step.extent.item_stride = 0;
    }
    Shared shared;
    share_noise(part, step, own, memory, shared);
    propagate(part, step.dt, own.points, size_, own.motion, memory.moved);
    add_noise(part, step, own, shared, memory);
    if (motion_record_ > 0) {
        auto advance = pelorus::arguments<plr_motion_record>();
        advance.dt = pelorus::const_view(&step.dt, 1, 1, 1);
        advance.state = pelorus::const_view(shared.mean);
        advance.covariance = pelorus::const_view(shared.covariance);
        advance.record = pelorus::const_view(own.motion, motion_record_, 1, 1);
        advance.out = pelorus::view(own.motion, motion_record_, 1, 1);
        part.require(motion_.call(&plr_motion::advance_record, part.call, advance));
    }
    std::copy_n(memory.moved, n_ * size_, own.points);
    if (!batches::all_finite(own.points, n_ * size_)) throw NumericError("a predicted particle is not finite");
}

void Particle::propagate(const PartCall& part, double dt, const double* points, std::int64_t count,
                         const double* record, double* out) const {
    auto move = pelorus::arguments<plr_motion_propagate>();
    move.dt = pelorus::common_view(&dt, 1, 1, count);
    move.state = pelorus::const_view(points, n_, 1, count);
    move.record = pelorus::common_view(record, motion_record_, 1, count);
    move.out = pelorus::view(out, n_, 1, count);
    part.require(motion_.call(&plr_motion::propagate, part.call, move));
}

/// The process noise's covariance (n x n), or its factor (n x columns) where the motion has one, of as many states as are given.
void Particle::ask_noise(const PartCall& part, const Step& step, const plr_const_view& state,
                         const plr_const_view& covariance, const plr_const_view& predicted, const double* record,
                         double* out) const {
    auto ask = pelorus::arguments<plr_motion_noise>();
    ask.dt = pelorus::common_view(&step.dt, 1, 1, state.count);
    ask.state = state;
    ask.covariance = covariance;
    ask.predicted = predicted;
    ask.extent = step.extent;
    if (ask.extent.data != nullptr) ask.extent.count = state.count;
    ask.record = pelorus::common_view(record, motion_record_, 1, state.count);
    ask.out = pelorus::view(out, n_, drawn_, state.count);
    part.require(factor_ != nullptr ? factor_->factor(motion_.self(), &part.call, &ask)
                                    : motion_.call(&plr_motion::noise, part.call, ask));
}

/// G of Q = G G' from what ask_noise told of one state.
void Particle::factorise(const double* noise, Square& factor) const {
    factor.resize(n_, drawn_);
    const Eigen::Map<const Square> told(noise, n_, drawn_);
    if (factor_ != nullptr)
        factor = told;
    else if (!small::cholesky_semidefinite(told, factor))
        throw NumericError("the process noise is not positive semidefinite");
}

/// One noise serves all particles where it is constant, or where the motion adapts it to the moments of a filter, which are
/// those of the cloud. Else each particle has that of its own state.
void Particle::share_noise(const PartCall& part, const Step& step, const Cloud<double>& of, const Memory& memory,
                           Shared& shared) const {
    shared.is_shared = noise_is_constant_ || motion_record_ > 0;
    if (!shared.is_shared) return;
    shared.mean.resize(n_, 1);
    shared.covariance.resize(n_, n_);
    Column predicted(n_, 1);
    if (noise_is_constant_ && motion_record_ == 0) {
        shared.mean = predicted = Eigen::Map<const Column>(of.points, n_, 1);
        shared.covariance.setZero();
    } else {
        for (std::int64_t i = 0; i < size_; ++i) memory.weights[i] = std::exp(of.log_weights[i]);
        moments_of(of.points, n_, memory.weights, size_, state_angles_, shared.mean.data(), shared.covariance.data());
        propagate(part, step.dt, shared.mean.data(), 1, of.motion, predicted.data());
    }
    ask_noise(part, step, pelorus::const_view(shared.mean), pelorus::const_view(shared.covariance),
              pelorus::const_view(predicted), of.motion, memory.block);
    factorise(memory.block, shared.factor);
}

void Particle::add_noise(const PartCall& part, const Step& step, const Cloud<double>& of, const Shared& shared,
                         const Memory& memory) const {
    double* const normals = memory.block + block_size * n_ * n_;
    const Square known = Square::Zero(n_, n_);  // a particle's state is
    Square factor(n_, drawn_);
    if (shared.is_shared) factor = shared.factor;
    for (std::int64_t first = 0; first < size_; first += block_size) {
        const std::int64_t count = std::min(block_size, size_ - first);
        double* const moved = memory.moved + first * n_;
        random_->normal(step.key, static_cast<std::uint64_t>(first * drawn_), count * drawn_, normals);
        if (!shared.is_shared)
            ask_noise(part, step, pelorus::const_view(of.points + first * n_, n_, 1, count),
                      pelorus::common_view(known.data(), n_, n_, count), pelorus::const_view(moved, n_, 1, count),
                      of.motion, memory.block);
        for (std::int64_t i = 0; i < count; ++i) {
            if (!shared.is_shared) factorise(memory.block + i * n_ * drawn_, factor);
            const double* const normal = normals + i * drawn_;
            double* const point = moved + i * n_;
            for (std::int64_t g = 0; g < drawn_; ++g)
                for (std::int64_t k = 0; k < n_; ++k) point[k] += factor(k, g) * normal[g];
            for (const int k : state_angles_) point[k] = pelorus::wrap_angle(point[k]);
        }
    }
}

// ------------------------------------------------------------------------------------------------ measurements

/// memory.seen: what the sensor would measure of each particle.
void Particle::look(const PartCall& part, const SensorInSlot& by, const double* points, const Memory& memory) const {
    const double* const cartesian = to_cartesian(part, points, memory);
    for (std::int64_t first = 0; first < size_; first += block_size) {
        const std::int64_t count = std::min(block_size, size_ - first);
        for (std::int64_t i = 0; i < count; ++i)
            for (std::int64_t k = 0; k < by.c; ++k)
                memory.block[i * by.c + k] = cartesian[(first + i) * c_ + by.index[static_cast<std::size_t>(k)]];
        auto measure = pelorus::arguments<plr_sensor_measure>();
        measure.cartesian = pelorus::const_view(memory.block, by.c, 1, count);
        measure.out = pelorus::view(memory.seen + first * by.m, by.m, 1, count);
        part.require(by.part.call(&plr_sensor::measure, part.call, measure));
    }
}

void Particle::differences(const PartCall& part, const SensorInSlot& by, const plr_const_view& measurement,
                           const plr_const_view& reference, double* out) const {
    auto compare = pelorus::arguments<plr_sensor_residual>();
    compare.measurement = measurement;
    compare.reference = reference;
    compare.out = pelorus::view(out, by.m, 1, measurement.count);
    part.require(by.part.call(&plr_sensor::residual, part.call, compare));
}

/// Mean and covariance (without R) of what is seen; memory.apart gets the deviations from the mean.
void Particle::tell_seen(const PartCall& part, const SensorInSlot& by, const Memory& memory, double* mean,
                         double* covariance) const {
    mean_of(memory.seen, by.m, memory.weights, size_, by.angles, mean);
    differences(part, by, pelorus::const_view(memory.seen, by.m, 1, size_), pelorus::common_view(mean, by.m, 1, size_),
                memory.apart);
    std::fill_n(covariance, by.m * by.m, 0.0);
    for (std::int64_t i = 0; i < size_; ++i) {
        const double* const apart = memory.apart + i * by.m;
        add_outer(memory.weights[i], apart, by.m, apart, by.m, covariance);
    }
}

plr_status Particle::project(const plr_call& call, const plr_estimator_project& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const std::int64_t count = args.measurement.count;
    expect_packed(args.record, info.record_size, 1, count, "record");
    expect_packed(args.measurement, by.m, 1, count, "measurement");
    expect_packed(args.covariance, by.m, by.m, count, "covariance");
    if (args.cross.data != nullptr) expect_packed(args.cross, n_, by.m, count, "cross");
    if (args.cartesian_cross.data != nullptr) expect_packed(args.cartesian_cross, c_, by.m, count, "cartesian_cross");
    const Scratch scratch(call, memory_doubles());
    return pelorus::for_items(call, count,
                              [&](std::int64_t i) { project_item(call, args, i, memory(scratch.data())); });
}

void Particle::project_item(const plr_call& call, const plr_estimator_project& args, std::int64_t item,
                            const Memory& memory) const {
    const SensorInSlot& by = sensor(args.sensor);
    expect_sound(at(args.record, item));
    const auto own = cloud(at(args.record, item));
    const PartCall part(call, item);
    for (std::int64_t i = 0; i < size_; ++i) memory.weights[i] = std::exp(own.log_weights[i]);
    look(part, by, own.points, memory);
    tell_seen(part, by, memory, at(args.measurement, item), at(args.covariance, item));
    const auto tell_cross = [&](const double* points, std::int64_t size, const std::vector<int>& angles, double* out) {
        Column mean(size, 1), apart(size, 1);
        mean_of(points, size, memory.weights, size_, angles, mean.data());
        std::fill_n(out, size * by.m, 0.0);
        for (std::int64_t i = 0; i < size_; ++i) {
            deviation(points + i * size, mean.data(), size, angles, apart.data());
            add_outer(memory.weights[i], apart.data(), size, memory.apart + i * by.m, by.m, out);
        }
        if (!batches::all_finite(out, size * by.m)) throw NumericError("the cross-covariance is not finite");
    };
    if (args.cross.data != nullptr) tell_cross(own.points, n_, state_angles_, at(args.cross, item));
    if (args.cartesian_cross.data != nullptr)
        tell_cross(state_is_cartesian_ ? own.points : memory.cartesian, c_, cartesian_angles_,
                   at(args.cartesian_cross, item));
    if (!batches::all_finite(at(args.measurement, item), by.m) ||
        !batches::all_finite(at(args.covariance, item), by.m * by.m))
        throw NumericError("what the particles would measure is not finite");
}

plr_status Particle::update(const plr_call& call, const plr_estimator_update& args) const {
    const SensorInSlot& by = sensor(args.sensor);
    const std::int64_t count = args.out.count, m = by.m;
    expect_packed(args.record, info.record_size, 1, count, "record");
    expect_packed(args.measurement, m, 1, count, "measurement");
    expect_packed(args.noise, m, m, count, "noise");
    expect_packed(args.out, info.record_size, 1, count, "out");
    if (args.log_likelihood.data != nullptr) expect_packed(args.log_likelihood, 1, 1, count, "log_likelihood");
    if (args.innovation.data != nullptr) expect_packed(args.innovation, m, 1, count, "innovation");
    if (args.innovation_covariance.data != nullptr)
        expect_packed(args.innovation_covariance, m, m, count, "innovation_covariance");
    const Scratch scratch(call, memory_doubles());
    return pelorus::for_items(call, count, [&](std::int64_t i) {
        expect_sound(at(args.record, i));
        if (args.out.data != args.record.data) std::copy_n(at(args.record, i), info.record_size, at(args.out, i));
        update_item(call, args, i, memory(scratch.data()));
    });
}

void Particle::update_item(const plr_call& call, const plr_estimator_update& args, std::int64_t item,
                           const Memory& memory) const {
    const SensorInSlot& by = sensor(args.sensor);
    const Cloud<double> own = cloud(at(args.out, item));
    const PartCall part(call, item);
    if (!batches::all_finite(at(args.measurement, item), by.m) ||
        !batches::all_finite(at(args.noise, item), by.m * by.m))
        throw NumericError("the measurement or its noise is not finite");
    look(part, by, own.points, memory);
    if (args.innovation.data != nullptr || args.innovation_covariance.data != nullptr) {
        for (std::int64_t i = 0; i < size_; ++i) memory.weights[i] = std::exp(own.log_weights[i]);
        tell_innovation(part, by, args, item, memory);
    }
    const double told = weigh(part, by, at(args.measurement, item), at(args.noise, item), own, memory);
    if (args.log_likelihood.data != nullptr) at(args.log_likelihood, item)[0] = told;
    if (effective_size(own) >= resample_below_ * static_cast<double>(size_)) return;
    resample(draw(call, item, own.draws), own, memory);
    if (roughening_ > 0) roughen(draw(call, item, own.draws), own);
}

void Particle::tell_innovation(const PartCall& part, const SensorInSlot& by, const plr_estimator_update& args,
                               std::int64_t item, const Memory& memory) const {
    double mean[max_measurement], covariance[max_measurement * max_measurement], innovation[max_measurement];
    tell_seen(part, by, memory, mean, covariance);
    differences(part, by, pelorus::const_view(at(args.measurement, item), by.m, 1, 1),
                pelorus::const_view(mean, by.m, 1, 1), innovation);
    if (!batches::all_finite(innovation, by.m) || !batches::all_finite(covariance, by.m * by.m))
        throw NumericError("the innovation is not finite");
    if (args.innovation.data != nullptr) std::copy_n(innovation, by.m, at(args.innovation, item));
    if (args.innovation_covariance.data == nullptr) return;
    const double* const noise = at(args.noise, item);
    double* const out = at(args.innovation_covariance, item);
    for (std::int64_t k = 0; k < by.m * by.m; ++k) out[k] = covariance[k] + noise[k];
}

/// New weights by Bayes' rule, and the logarithm of the measurement's density.
double Particle::weigh(const PartCall& part, const SensorInSlot& by, const double* measurement, const double* noise,
                       const Cloud<double>& of, const Memory& memory) const {
    using Noise = small::Bounded<max_measurement, max_measurement>;
    Noise root(by.m, by.m);
    if (!small::cholesky(Eigen::Map<const Noise>(noise, by.m, by.m), root))
        throw NumericError(
            "the measurement's noise is not positive definite; particles explain no measurement without noise");
    differences(part, by, pelorus::common_view(measurement, by.m, 1, size_),
                pelorus::const_view(memory.seen, by.m, 1, size_), memory.apart);
    const double scale =
        -0.5 * (static_cast<double>(by.m) * std::log(2 * 3.14159265358979323846) + small::log_determinant(root));
    double greatest = -std::numeric_limits<double>::infinity();
    for (std::int64_t i = 0; i < size_; ++i) {
        using Difference = small::Bounded<max_measurement, 1>;
        const Eigen::Map<const Difference> e(memory.apart + i * by.m, by.m, 1);
        of.log_weights[i] += scale - 0.5 * small::inverse_quadratic(root, e);
        greatest = std::max(greatest, of.log_weights[i]);
    }
    double sum = 0;
    for (std::int64_t i = 0; i < size_; ++i) sum += std::exp(of.log_weights[i] - greatest);
    const double total = greatest + std::log(sum);
    if (!std::isfinite(total)) throw NumericError("no particle explains the measurement");
    // What is as good as no weight stays a finite number.
    for (std::int64_t i = 0; i < size_; ++i) of.log_weights[i] = std::max(of.log_weights[i] - total, least_log_weight);
    return total;
}

/// 1 / sum w^2 (J. S. Liu, R. Chen 1995).
double Particle::effective_size(const Cloud<double>& of) const noexcept {
    double squares = 0;
    for (std::int64_t i = 0; i < size_; ++i) squares += std::exp(2 * of.log_weights[i]);
    return 1 / squares;
}

/// Systematic: particle i is taken for each k with sum of weights before i <= (k + u) / N < sum with i.
void Particle::resample(plr_key key, const Cloud<double>& of, const Memory& memory) const {
    double u = 0;
    random_->uniform(key, 0, 1, &u);
    const auto number = static_cast<double>(size_);
    std::int64_t taken = 0;
    double sum = std::exp(of.log_weights[0]);
    for (std::int64_t k = 0; k < size_; ++k) {
        const double mark = (static_cast<double>(k) + u) / number;
        while (mark >= sum && taken < size_ - 1) sum += std::exp(of.log_weights[++taken]);
        std::copy_n(of.points + taken * n_, n_, memory.moved + k * n_);
    }
    std::copy_n(memory.moved, n_ * size_, of.points);
    std::fill_n(of.log_weights, size_, -std::log(number));
}

void Particle::roughen(plr_key key, const Cloud<double>& of) const {
    const double share = roughening_ * std::pow(static_cast<double>(size_), -1.0 / static_cast<double>(n_));
    Column least(n_, 1), greatest(n_, 1), normal(n_, 1);
    const Eigen::Map<const Column> first(of.points, n_, 1);
    least = greatest = first;
    for (std::int64_t i = 1; i < size_; ++i) {
        const Eigen::Map<const Column> point(of.points + i * n_, n_, 1);
        least = least.cwiseMin(point).eval();
        greatest = greatest.cwiseMax(point).eval();
    }
    for (std::int64_t i = 0; i < size_; ++i) {
        random_->normal(key, static_cast<std::uint64_t>(i * n_), n_, normal.data());
        for (std::int64_t k = 0; k < n_; ++k) of.points[i * n_ + k] += share * (greatest(k) - least(k)) * normal(k);
        for (const int k : state_angles_) of.points[i * n_ + k] = pelorus::wrap_angle(of.points[i * n_ + k]);
    }
}

}  // namespace particle
