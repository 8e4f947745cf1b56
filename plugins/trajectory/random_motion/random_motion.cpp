// trajectory.random_motion: true motion drawn from a motion model. See README.md.
#include "random_motion.hpp"

#include <array>

#include <pelorus/small_matrix.hpp>

namespace random_motion {

namespace {

/// The key's words in halves of 32 bits, which doubles hold exactly.
constexpr int key_halves = 4;

plr_key key_of(const plr_const_view& record) noexcept {
    std::array<std::uint64_t, key_halves> halves{};
    for (int k = 0; k < key_halves; ++k)
        halves[static_cast<std::size_t>(k)] = static_cast<std::uint64_t>(record.data[k * record.row_stride]);
    return {{halves[0] << 32 | halves[1], halves[2] << 32 | halves[3]}};
}

}  // namespace

void RandomMotion::setup(const pelorus::Setup& setup) {
    motion_ = setup.part<pelorus::MotionPart>("motion");
    random_ = &setup.service<plr_random>();
    const plr_motion_info& model = motion_.info();
    native_ = pelorus::Space(*model.state);
    cartesian_ = pelorus::Space(*model.cartesian);
    if (native_.size() > most || cartesian_.size() > most)
        throw pelorus::PartError("motion", "has " + std::to_string(native_.size()) + " components, at most " +
                                               std::to_string(most) + " are possible");
    if (model.record_size > 0 || (model.flags & PLR_MOTION_USES_EXTENT) != 0)
        throw pelorus::PartError("motion",
                                 "its noise depends on what a filter knows (a record, or an extent), which true "
                                 "motion has not");
    find_components();
    begin_life();
    if (!(period_ * 1e9 >= 1)) throw pelorus::ParameterError("period", "is below what a clock of nanoseconds can tell");
    fill_start();
    info.flags = PLR_FLAG_USES_KEYS;
    info.state = space_.c();
    info.objects = 1;
    info.extent_dimension = 0;
    info.record_version = 1;
    info.record_size = key_halves;
    info.scratch_bytes = model.scratch_bytes + 4096;
}

/// The components that a truth tells: positions, velocities, accelerations, as far as the motion has them on all axes.
void RandomMotion::find_components() {
    const pelorus::Space all = pelorus::kinematic_space(3, {1e6, 1e3, 1e2});
    while (axes_ < 3 && cartesian_.index(all[axes_].name) == axes_) ++axes_;
    if (axes_ == 0)
        throw pelorus::PartError("motion", "its components are " + cartesian_.text() + ", expected position.x first");
    std::vector<pelorus::Component> told;
    for (int derivative = 0; derivative < 3; ++derivative) {
        std::vector<int> places;
        for (int axis = 0; axis < axes_; ++axis) {
            const int place = cartesian_.index(all[3 * derivative + axis].name);
            if (place >= 0) places.push_back(place);
        }
        if (static_cast<int>(places.size()) < axes_) break;
        derivatives_ = derivative + 1;
        for (int axis = 0; axis < axes_; ++axis) {
            told_.push_back(places[static_cast<std::size_t>(axis)]);
            told.push_back(all[3 * derivative + axis]);
        }
    }
    if (derivatives_ < 2)
        throw pelorus::PartError(
            "motion", "its components are " + cartesian_.text() + ", expected velocities, too: a truth tells them");
    space_ = pelorus::Space(std::move(told));
}

void RandomMotion::fill_start() {
    for (int c = 0; c < cartesian_.size(); ++c) {
        start_mean_.push_back(cartesian_[c].prior_mean);
        start_sd_.push_back(0);
    }
    const std::vector<double>* const given[] = {&start_, velocity_ ? &*velocity_ : nullptr,
                                                acceleration_ ? &*acceleration_ : nullptr};
    const char* const names[] = {"start", "velocity", "acceleration"};
    for (int derivative = 0; derivative < 3; ++derivative) {
        if (given[derivative] == nullptr) continue;
        if (derivative >= derivatives_)
            throw pelorus::ParameterError(names[derivative], "the motion has no " + std::string(names[derivative]));
        if (static_cast<int>(given[derivative]->size()) != axes_)
            throw pelorus::ParameterError(names[derivative], "has " + std::to_string(given[derivative]->size()) +
                                                                 " elements, the motion has " + std::to_string(axes_) +
                                                                 " axes");
        for (int axis = 0; axis < axes_; ++axis)
            start_mean_[component(derivative, axis)] = (*given[derivative])[static_cast<std::size_t>(axis)];
    }
    for (int derivative = 0; derivative < derivatives_; ++derivative)
        for (int axis = 0; axis < axes_; ++axis) start_sd_[component(derivative, axis)] = start_deviation_(derivative);
}

std::size_t RandomMotion::component(int derivative, int axis) const {
    return static_cast<std::size_t>(told_[static_cast<std::size_t>(derivative * axes_ + axis)]);
}

void RandomMotion::realise(const plr_call& call, const plr_view& record) const {
    pelorus::expect(record, key_halves, 1, 1, "record");
    if (call.keys == nullptr) throw pelorus::ArgumentError("keys: this trajectory draws random numbers, got none");
    for (int k = 0; k < key_halves; ++k) {
        const std::uint64_t word = call.keys[0].word[k / 2];
        const std::uint64_t half = k % 2 == 0 ? word >> 32 : word & 0xffffffffu;
        record.data[k * record.row_stride] = static_cast<double>(half);
    }
}

void RandomMotion::states(const plr_call& call, const plr_trajectory_states& args) const {
    pelorus::expect(args.record, key_halves, 1, 1, "record");
    Walk walk(*this, call, key_of(args.record));
    answer(args, space_.size(), 0, [&](std::int64_t t, double) {
        walk.tell(args.times[t] - birth(), args.states.data + t * args.states.col_stride);
    });
}

// ------------------------------------------------------------------------------------------------------------- the walk

RandomMotion::Walk::Walk(const RandomMotion& owner, const plr_call& call, plr_key key)
    : of_(owner), call_(call), key_(key) {
    // A batch of one, whatever the caller's has: neither its statuses nor its ids are those of steps.
    call_.item_status = nullptr;
    call_.item_ids = nullptr;
    const std::int64_t c = of_.cartesian_.size();
    std::array<double, most> unit{}, start{};
    of_.random_->normal(of_.random_->derive(key_, PLR_STREAM_START, 0, 0), 0, c, unit.data());
    for (std::size_t k = 0; k < static_cast<std::size_t>(c); ++k)
        start[k] = of_.start_mean_[k] + of_.start_sd_[k] * unit[k];
    if (of_.motion_.table().from_cartesian == nullptr) {
        state_ = start;
        return;
    }
    auto args = pelorus::arguments<plr_motion_convert>();
    args.in = pelorus::const_view(start.data(), c, 1, 1);
    args.out = pelorus::view(state_.data(), of_.native_.size(), 1, 1);
    pelorus::require(of_.motion_.call(&plr_motion::from_cartesian, call_, args));
}

/// `age` in ns since birth, not less than the one before.
void RandomMotion::Walk::tell(std::int64_t age, double* out) {
    while (tick(step_ + 1) <= age) step();
    std::array<double, most> now = state_, cartesian{};
    if (age > tick(step_)) propagate(static_cast<double>(age - tick(step_)) * 1e-9, now.data());
    if (of_.motion_.table().to_cartesian == nullptr) {
        cartesian = now;
    } else {
        auto args = pelorus::arguments<plr_motion_convert>();
        args.in = pelorus::const_view(now.data(), of_.native_.size(), 1, 1);
        args.out = pelorus::view(cartesian.data(), of_.cartesian_.size(), 1, 1);
        pelorus::require(of_.motion_.call(&plr_motion::to_cartesian, call_, args));
    }
    for (std::size_t k = 0; k < of_.told_.size(); ++k) out[k] = cartesian[static_cast<std::size_t>(of_.told_[k])];
}

std::int64_t RandomMotion::Walk::tick(std::int64_t step) const {
    return std::llround(static_cast<double>(step) * of_.period_ * 1e9);
}

void RandomMotion::Walk::propagate(double dt, double* out) const {
    auto args = pelorus::arguments<plr_motion_propagate>();
    args.dt = pelorus::const_view(&dt, 1, 1, 1);
    args.state = pelorus::const_view(state_.data(), of_.native_.size(), 1, 1);
    args.out = pelorus::view(out, of_.native_.size(), 1, 1);
    pelorus::require(of_.motion_.call(&plr_motion::propagate, call_, args));
}

/// x_k+1 = f(x_k) + L u with L L' = Q.
void RandomMotion::Walk::step() {
    using Square = pelorus::small::Bounded<most, most>;
    const std::int64_t n = of_.native_.size();
    const double dt = static_cast<double>(tick(step_ + 1) - tick(step_)) * 1e-9;
    std::array<double, most> next{}, unit{};
    Square known = Square::Zero(n, n), noise(n, n);
    propagate(dt, next.data());
    auto args = pelorus::arguments<plr_motion_noise>();
    args.dt = pelorus::const_view(&dt, 1, 1, 1);
    args.state = pelorus::const_view(state_.data(), n, 1, 1);
    args.covariance = pelorus::const_view(known.data(), n, n, 1);  // true motion is known exactly
    args.predicted = pelorus::const_view(next.data(), n, 1, 1);
    args.out = pelorus::view(noise.data(), n, n, 1);
    pelorus::require(of_.motion_.call(&plr_motion::noise, call_, args));
    if (!pelorus::small::cholesky_semidefinite(noise, noise))
        throw pelorus::NumericError("the noise of the motion is not positive semidefinite");
    ++step_;
    of_.random_->normal(of_.random_->derive(key_, PLR_STREAM_TRAJECTORY, static_cast<std::uint64_t>(step_), 0), 0, n,
                        unit.data());
    for (std::int64_t row = 0; row < n; ++row) {
        double sum = next[static_cast<std::size_t>(row)];
        for (std::int64_t col = 0; col <= row; ++col) sum += noise(row, col) * unit[static_cast<std::size_t>(col)];
        state_[static_cast<std::size_t>(row)] = sum;
    }
}

}  // namespace random_motion

PELORUS_PLUGIN(random_motion::RandomMotion, "trajectory.random_motion");
