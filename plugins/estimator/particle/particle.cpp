// What the filter is made from; how a track starts, and what it tells of itself.
#include "particle.hpp"

#include <cmath>

#include <pelorus/abi/record.h>

#include "cloud.hpp"

namespace particle {

using batches::at;
using batches::block_size;
using batches::expect_packed;
using pelorus::PartError;
using pelorus::Scratch;
namespace small = pelorus::small;

void Particle::describe(pelorus::Describe<Particle>& plugin) {
    plugin.title("Particle filter, bootstrap")
        .purpose(
            "A cloud of weighted points, moved by one motion with noise drawn for each and weighted by how well each "
            "explains what is measured. For posteriors that no Gaussian is like: several places at once, rings, "
            "barriers.")
        .equation(
            "predict: x_i = f(x_i) + G u, u ~ N(0, I). update: w_i = w_i N(z - h(x_i); 0, R), normalised; below an "
            "effective size 1 / sum w_i^2 the points are drawn anew, systematically")
        .source(
            "N. J. Gordon, D. J. Salmond, A. F. M. Smith, Novel approach to nonlinear/non-Gaussian Bayesian state "
            "estimation, IEE Proceedings F 140(2), 107-113, 1993; G. Kitagawa, Monte Carlo filter and smoother for "
            "non-Gaussian nonlinear state space models, Journal of Computational and Graphical Statistics 5(1), 1-25, "
            "1996 (systematic resampling); R. Douc, O. Cappe, Comparison of resampling schemes for particle filtering, "
            "ISPA 2005, 64-69");
    plugin.slot("motion", "motion", 1, 1, "how the state evolves");
    plugin.slot("sensors", "sensor", 1, -1, "what measures it; a scan meets its sensor by name");
    plugin.parameter("particles", &Particle::particles_)
        .initially("1000")
        .min(2)
        .max(max_particles)
        .doc("N: points a track");
    plugin.parameter("resample_below", &Particle::resample_below_)
        .initially("0.5")
        .min(0.0)
        .max(1.0)
        .doc("points are drawn anew when the effective sample size is below this share of N");
    plugin.parameter("roughening", &Particle::roughening_)
        .initially("0")
        .min(0.0)
        .doc(
            "K: after drawing anew, each component is moved by normal noise with a deviation of K times its range, "
            "times N^(-1/n); 0: not (Gordon et al. 1993, section 3.3)");
}

void Particle::setup(const pelorus::Setup& setup) {
    random_ = &setup.service<plr_random>();
    motion_ = setup.part<pelorus::MotionPart>("motion");
    const plr_motion_info& motion = motion_.info();
    state_ = pelorus::Space(*motion.state);
    cartesian_ = pelorus::Space(*motion.cartesian);
    n_ = state_.size();
    c_ = cartesian_.size();
    size_ = particles_;
    motion_record_ = motion.record_size;
    state_is_cartesian_ = motion_.table().to_cartesian == nullptr;
    noise_is_constant_ = (motion.flags & PLR_MOTION_CONSTANT_NOISE) != 0;
    if (n_ > max_state || c_ > max_state)
        throw PartError("motion", motion_.id() + " has " + std::to_string(std::max(n_, c_)) + " components, at most " +
                                      std::to_string(max_state) + " fit this filter");
    if (state_is_cartesian_ && !state_.same(cartesian_))
        throw PartError("motion", motion_.id() + " does not convert its state (" + state_.text() +
                                      ") to its Cartesian components (" + cartesian_.text() + ")");
    for (int k = 0; k < state_.size(); ++k)
        if (state_[k].angle) state_angles_.push_back(k);
    for (int k = 0; k < cartesian_.size(); ++k)
        if (cartesian_[k].angle) cartesian_angles_.push_back(k);
    factor_ = motion_.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
    if (factor_ != nullptr && (factor_->columns < 1 || factor_->columns > n_)) factor_ = nullptr;
    drawn_ = factor_ == nullptr ? n_ : factor_->columns;

    const auto parts = setup.parts<pelorus::SensorPart>("sensors");
    for (const auto& part : parts) add_sensor(part);
    if (sensors_.empty()) throw PartError("sensors", "slot sensors is empty, one sensor at least is needed");
    std::uint64_t scratch = motion.scratch_bytes;
    for (const SensorInSlot& sensor : sensors_) scratch = std::max(scratch, sensor.part.info().scratch_bytes);

    info.flags = PLR_FLAG_USES_KEYS;
    if ((motion.flags & PLR_MOTION_USES_EXTENT) != 0) info.flags |= PLR_ESTIMATOR_USES_EXTENT;
    info.state = state_.c();
    info.cartesian = cartesian_.c();
    info.record_size = 1 + size_ + n_ * size_ + motion_record_;
    info.record_version = plr_mix_version(1, motion.record_version);
    info.sensor_count = static_cast<std::uint32_t>(sensors_.size());
    info.sensors = &parts.front().raw();
    info.scratch_bytes = static_cast<std::uint64_t>(memory_doubles()) * sizeof(double) + scratch + 2 * 64;
}

void Particle::add_sensor(const pelorus::SensorPart& part) {
    SensorInSlot sensor;
    sensor.part = part;
    const pelorus::Space looks_at(*part.info().cartesian), measured(*part.info().measurement);
    sensor.m = measured.size();
    sensor.c = looks_at.size();
    if (sensor.m > max_measurement)
        throw PartError("sensors", part.id() + " measures " + std::to_string(sensor.m) + " components, at most " +
                                       std::to_string(max_measurement) + " fit this filter");
    for (int k = 0; k < measured.size(); ++k)
        if (measured[k].angle) sensor.angles.push_back(k);
    for (const pelorus::Component& component : looks_at.components()) {
        const int index = cartesian_.index(component.name);
        if (index < 0 || cartesian_[index].unit != component.unit)
            throw PartError("sensors", part.id() + " looks at " + component.name + " [" + component.unit + "], which " +
                                           motion_.id() + " does not have: " + cartesian_.text());
        sensor.index.push_back(index);
    }
    most_measured_ = std::max(most_measured_, sensor.m);
    most_seen_ = std::max(most_seen_, sensor.c);
    sensors_.push_back(std::move(sensor));
}

const SensorInSlot& Particle::sensor(std::int32_t index) const {
    if (index < 0 || static_cast<std::size_t>(index) >= sensors_.size())
        throw pelorus::ArgumentError("sensor: is " + std::to_string(index) + ", expected 0 to " +
                                     std::to_string(sensors_.size() - 1));
    return sensors_[static_cast<std::size_t>(index)];
}

std::int64_t Particle::memory_doubles() const noexcept {
    const std::int64_t block = std::max({c_, n_ * n_ + drawn_, most_seen_});
    return size_ * (1 + c_ + 2 * most_measured_ + n_) + block_size * block;
}

Particle::Memory Particle::memory(double* data) const noexcept {
    Memory own{};
    own.weights = data;
    own.cartesian = own.weights + size_;
    own.seen = own.cartesian + size_ * c_;
    own.apart = own.seen + size_ * most_measured_;
    own.moved = own.apart + size_ * most_measured_;
    own.block = own.moved + size_ * n_;
    return own;
}

Particle::PartCall::PartCall(const plr_call& whole, std::int64_t item) : call(pelorus::slice(whole, item)) {
    error_.struct_size = sizeof error_;
    error_.item = -1;
    call.item_offset = 0;
    call.item_ids = nullptr;
    call.keys = nullptr;
    call.input_stride = 0;
    call.error = &error_;
    call.item_status = nullptr;
}

void Particle::PartCall::require(plr_status status) const {
    if (status == PLR_OK) return;
    throw pelorus::Failure(error_.code == PLR_OK ? status : error_.code,
                           error_.message[0] == 0 ? "a part failed without a message" : error_.message, error_.where);
}

/// Throws NumericError unless it is a record that can be worked with: it comes from a file, too.
void Particle::expect_sound(const double* record) const {
    constexpr double most_draws = 9e15;  // whole numbers are exact
    if (!batches::all_finite(record, info.record_size) || !(record[0] >= 0 && record[0] < most_draws))
        throw pelorus::NumericError("the record is not finite, or not one of this estimator");
}

/// The key of one drawing for one track: each drawing of a track has its own, although its caller gives one a step.
plr_key Particle::draw(const plr_call& call, std::int64_t item, double* draws) const {
    if (call.keys == nullptr) throw pelorus::ArgumentError("keys: are missing; this filter draws random numbers");
    *draws += 1;
    return random_->derive(call.keys[item], PLR_STREAM_PARTICLES, static_cast<std::uint64_t>(*draws), 0);
}

plr_status Particle::init(const plr_call& call, const plr_estimator_init& args) const {
    const std::int64_t known = args.known, count = args.record.count;
    for (std::int64_t k = 0; k < known; ++k)
        if (args.components[k] < (k == 0 ? 0 : args.components[k - 1] + 1) || args.components[k] >= c_)
            throw pelorus::ArgumentError("components: are not ascending indices below " + std::to_string(c_));
    expect_packed(args.mean, known, 1, count, "mean");
    expect_packed(args.covariance, known, known, count, "covariance");
    expect_packed(args.record, info.record_size, 1, count, "record");
    const Scratch scratch(call, memory_doubles());
    return pelorus::for_items(call, count,
                              [&](std::int64_t i) { start_item(call, args, i, memory(scratch.data()).block); });
}

/// Draws from the Gaussian in Cartesian components; those that are not given have their prior.
void Particle::start_item(const plr_call& call, const plr_estimator_init& args, std::int64_t item,
                          double* block) const {
    Column mean(c_, 1);
    Square covariance = Square::Zero(c_, c_), root(c_, c_);
    for (int k = 0; k < cartesian_.size(); ++k) {
        mean(k) = cartesian_[k].prior_mean;
        covariance(k, k) = cartesian_[k].prior_deviation * cartesian_[k].prior_deviation;
    }
    const std::int64_t known = args.known;
    const double* const given = at(args.mean, item);
    const double* const spread = at(args.covariance, item);
    for (std::int64_t a = 0; a < known; ++a) {
        mean(args.components[a]) = given[a];
        for (std::int64_t b = 0; b < known; ++b)
            covariance(args.components[a], args.components[b]) = 0.5 * (spread[b * known + a] + spread[a * known + b]);
    }
    if (!small::all_finite(mean) || !small::cholesky_semidefinite(covariance, root))
        throw pelorus::NumericError("the mean or covariance to start from is not finite, or is not positive");

    const Cloud<double> to = cloud(at(args.record, item));
    *to.draws = 0;
    const plr_key key = draw(call, item, to.draws);
    const PartCall part(call, item);
    std::fill_n(to.log_weights, size_, -std::log(static_cast<double>(size_)));
    for (std::int64_t first = 0; first < size_; first += block_size) {
        const std::int64_t count = std::min(block_size, size_ - first);
        double* const points = state_is_cartesian_ ? to.points + first * n_ : block;
        for (std::int64_t i = 0; i < count; ++i) {
            Column normal(c_, 1), point(c_, 1);
            random_->normal(key, static_cast<std::uint64_t>((first + i) * c_), c_, normal.data());
            small::multiply(root, normal, point);
            point += mean;
            std::copy_n(point.data(), c_, points + i * c_);
        }
        if (state_is_cartesian_) continue;
        auto convert = pelorus::arguments<plr_motion_convert>();
        convert.in = pelorus::const_view(points, c_, 1, count);
        convert.out = pelorus::view(to.points + first * n_, n_, 1, count);
        part.require(motion_.call(&plr_motion::from_cartesian, part.call, convert));
    }
    if (motion_record_ > 0) start_motion(part, to);
    if (!batches::all_finite(to.points, n_ * size_))
        throw pelorus::NumericError("a particle to start from is not finite");
}

/// The motion remembers the cloud's moments, as those of any filter.
void Particle::start_motion(const PartCall& part, const Cloud<double>& to) const {
    Column mean(n_, 1);
    Square covariance(n_, n_);
    double equal[max_particles];
    std::fill_n(equal, size_, 1.0 / static_cast<double>(size_));
    moments_of(to.points, n_, equal, size_, state_angles_, mean.data(), covariance.data());
    auto start = pelorus::arguments<plr_motion_record>();
    start.state = pelorus::const_view(mean);
    start.covariance = pelorus::const_view(covariance);
    start.out = pelorus::view(to.motion, motion_record_, 1, 1);
    part.require(motion_.call(&plr_motion::init_record, part.call, start));
}

plr_status Particle::summary(const plr_call& call, const plr_estimator_moments& args) const {
    return tell(call, args, true);
}
plr_status Particle::moments(const plr_call& call, const plr_estimator_moments& args) const {
    return tell(call, args, false);
}

plr_status Particle::tell(const plr_call& call, const plr_estimator_moments& args, bool is_cartesian) const {
    const std::int64_t count = args.mean.count, size = is_cartesian ? c_ : n_;
    expect_packed(args.record, info.record_size, 1, count, "record");
    expect_packed(args.mean, size, 1, count, "mean");
    if (args.covariance.data != nullptr) expect_packed(args.covariance, size, size, count, "covariance");
    const Scratch scratch(call, memory_doubles());
    return pelorus::for_items(call, count,
                              [&](std::int64_t i) { tell_item(call, args, i, is_cartesian, memory(scratch.data())); });
}

void Particle::tell_item(const plr_call& call, const plr_estimator_moments& args, std::int64_t item, bool is_cartesian,
                         const Memory& memory) const {
    expect_sound(at(args.record, item));
    const auto from = cloud(at(args.record, item));
    const std::int64_t size = is_cartesian ? c_ : n_;
    const std::vector<int>& angles = is_cartesian ? cartesian_angles_ : state_angles_;
    for (std::int64_t i = 0; i < size_; ++i) memory.weights[i] = std::exp(from.log_weights[i]);
    const PartCall part(call, item);
    const double* const points = is_cartesian ? to_cartesian(part, from.points, memory) : from.points;
    double* const mean = at(args.mean, item);
    const bool is_wanted = args.covariance.data != nullptr;
    if (is_wanted)
        moments_of(points, size, memory.weights, size_, angles, mean, at(args.covariance, item));
    else
        mean_of(points, size, memory.weights, size_, angles, mean);
    if (!batches::all_finite(mean, size) || (is_wanted && !batches::all_finite(at(args.covariance, item), size * size)))
        throw pelorus::NumericError("the mean or covariance of the particles is not finite");
}

/// The particles in Cartesian components (c x N): themselves where the state is Cartesian.
const double* Particle::to_cartesian(const PartCall& part, const double* points, const Memory& memory) const {
    if (state_is_cartesian_) return points;
    auto convert = pelorus::arguments<plr_motion_convert>();
    convert.in = pelorus::const_view(points, n_, 1, size_);
    convert.out = pelorus::view(memory.cartesian, c_, 1, size_);
    part.require(motion_.call(&plr_motion::to_cartesian, part.call, convert));
    return memory.cartesian;
}

}  // namespace particle

PELORUS_PLUGIN(particle::Particle, "estimator.particle");
