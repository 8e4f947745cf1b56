// What the filter is made from, and the calls around its step: start, moments, assignment.
#include "kalman.hpp"

#include <cstring>

#include <pelorus/abi/record.h>

namespace kalman {

using pelorus::PartError;
using pelorus::Scratch;

void Kalman::describe(pelorus::Describe<Kalman>& plugin) {
    plugin.title("Kalman filter, linear and extended")
        .purpose(
            "Mean and covariance of a track, predicted by one motion and updated by any number of sensors. Where the "
            "motion or a sensor is not linear, it is linearised at the newest estimate.")
        .equation(
            "predict: x = f(x), P = F P F' + Q. update: S = H P H' + R, K = P H' S^-1, x = x + K (z - h(x)), P = (I - "
            "K H) P (I - K H)' + K R K'")
        .source(
            "R. E. Kalman, A new approach to linear filtering and prediction problems, Journal of Basic Engineering "
            "82, 35-45, 1960; R. S. Bucy, P. D. Joseph, Filtering for Stochastic Processes with Applications to "
            "Guidance, Wiley 1968 (the form of the update); Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with "
            "Applications to Tracking and Navigation, Wiley 2001, 10.3 (extended)");
    plugin.slot("motion", "motion", 1, 1, "how the state evolves");
    plugin.slot("sensors", "sensor", 1, -1, "what measures it; a scan meets its sensor by name");
}

void Kalman::setup(const pelorus::Setup& setup) {
    motion_ = setup.part<pelorus::MotionPart>("motion");
    const plr_motion_info& motion = motion_.info();
    state_ = pelorus::Space(*motion.state);
    cartesian_ = pelorus::Space(*motion.cartesian);
    n_ = state_.size();
    c_ = cartesian_.size();
    motion_record_ = motion.record_size;
    state_is_cartesian_ = motion_.table().to_cartesian == nullptr;
    if (n_ > max_state || c_ > max_state)
        throw PartError("motion", motion_.id() + " has " + std::to_string(std::max(n_, c_)) + " components, at most " +
                                      std::to_string(max_state) + " fit this filter");
    if (state_is_cartesian_ && !state_.same(cartesian_))
        throw PartError("motion", motion_.id() + " does not convert its state (" + state_.text() +
                                      ") to its Cartesian components (" + cartesian_.text() + ")");
    for (int i = 0; i < state_.size(); ++i) {
        if (state_[i].angle) angles_.push_back(i);
    }
    if ((motion.flags & PLR_MOTION_CONSTANT_NOISE) != 0 && motion_record_ == 0)
        structure_ = motion_.extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
    if (structure_ != nullptr && structure_->block * structure_->dimension != n_)
        throw PartError("motion", motion_.id() + " offers a structure that does not fit its state");
    if (structure_ != nullptr) by_blocks_ = blocks_kernel(structure_->block, structure_->dimension);
    fully_ = full_kernel(static_cast<int>(n_));

    const auto parts = setup.parts<pelorus::SensorPart>("sensors");
    for (const auto& part : parts) add_sensor(part);
    if (sensors_.empty()) throw PartError("sensors", "slot sensors is empty, one sensor at least is needed");

    info.flags = PLR_ESTIMATOR_ASSIGNABLE;
    if ((motion.flags & PLR_MOTION_BACKWARD) != 0) info.flags |= PLR_ESTIMATOR_BACKWARD;
    if ((motion.flags & PLR_MOTION_USES_EXTENT) != 0) info.flags |= PLR_ESTIMATOR_USES_EXTENT;
    info.state = state_.c();
    info.cartesian = cartesian_.c();
    info.record_size = n_ + n_ * n_ + motion_record_;
    info.record_version = plr_mix_version(1, motion.record_version);
    info.sensor_count = static_cast<std::uint32_t>(sensors_.size());
    info.sensors = &parts.front().raw();
    info.scratch_bytes = scratch_needed();
}

void Kalman::add_sensor(const pelorus::SensorPart& part) {
    SensorInSlot sensor;
    sensor.part = part;
    const pelorus::Space looks_at(*part.info().cartesian);
    sensor.m = part.info().measurement->size;
    sensor.c = looks_at.size();
    if (sensor.m > max_measurement)
        throw PartError("sensors", part.id() + " measures " + std::to_string(sensor.m) + " components, at most " +
                                       std::to_string(max_measurement) + " fit this filter");
    for (const pelorus::Component& component : looks_at.components()) {
        const int index = cartesian_.index(component.name);
        if (index < 0 || cartesian_[index].unit != component.unit)
            throw PartError("sensors", part.id() + " looks at " + component.name + " [" + component.unit + "], which " +
                                           motion_.id() + " does not have: " + cartesian_.text());
        sensor.index.push_back(index);
    }
    sensor.kernels = measurement_kernels(static_cast<int>(n_), static_cast<int>(sensor.m));
    sensors_.push_back(std::move(sensor));
}

std::int64_t Kalman::look_doubles(const SensorInSlot& sensor) const {
    const std::int64_t converted = state_is_cartesian_ ? 0 : c_ + c_ * n_;
    return sensor.c + sensor.m * sensor.c + converted;
}

/// The largest need of any call of ours, and of a part called meanwhile.
std::uint64_t Kalman::scratch_needed() const {
    std::int64_t doubles = n_ + 2 * n_ * n_ + motion_record_;                       // predict
    if (!state_is_cartesian_) doubles = std::max(doubles, c_ + c_ * c_ + n_ * c_);  // init, summary
    std::uint64_t parts = motion_.info().scratch_bytes;
    for (const SensorInSlot& sensor : sensors_) {
        doubles = std::max(doubles, 2 * sensor.m + sensor.m * n_ + look_doubles(sensor));
        parts = std::max(parts, sensor.part.info().scratch_bytes);
    }
    return static_cast<std::uint64_t>(block_size * doubles) * sizeof(double) + parts + 2 * 64;
}

const SensorInSlot& Kalman::sensor(std::int32_t index) const {
    if (index < 0 || static_cast<std::size_t>(index) >= sensors_.size())
        throw pelorus::ArgumentError("sensor: is " + std::to_string(index) + ", expected 0 to " +
                                     std::to_string(sensors_.size() - 1));
    return sensors_[static_cast<std::size_t>(index)];
}

plr_status Kalman::init(const plr_call& call, const plr_estimator_init& args) const {
    const std::int64_t known = args.known, count = args.record.count;
    for (std::int64_t k = 0; k < known; ++k) {
        if (args.components[k] < (k == 0 ? 0 : args.components[k - 1] + 1) || args.components[k] >= c_)
            throw pelorus::ArgumentError("components: are not ascending indices below " + std::to_string(c_));
    }
    expect_packed(args.mean, known, 1, count, "mean");
    expect_packed(args.covariance, known, known, count, "covariance");
    expect_packed(args.record, info.record_size, 1, count, "record");

    const std::int64_t doubles = state_is_cartesian_ ? 0 : c_ + c_ * c_ + n_ * c_;
    const Scratch scratch(call, block_size * doubles);
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_view records = pelorus::slice(args.record, first, items);
        // Cartesian moments: those of the record where the state is Cartesian, else of their own.
        double* const memory = scratch.data();
        const plr_view means = state_is_cartesian_ ? field(records, 0, c_, 1) : pelorus::view(memory, c_, 1, items);
        const plr_view covariances =
            state_is_cartesian_ ? field(records, n_, c_, c_) : pelorus::view(memory + block_size * c_, c_, c_, items);
        const plr_status started = for_good_items(
            block, items, [&](std::int64_t i) { start_item(args, first + i, at(means, i), at(covariances, i)); });
        if (started < 0) return started;
        if (!state_is_cartesian_)
            from_cartesian(block, pelorus::as_const(means), pelorus::as_const(covariances), records,
                           memory + block_size * (c_ + c_ * c_));
        if (motion_record_ > 0) {
            auto start = pelorus::arguments<plr_motion_record>();
            start.state = mean(pelorus::as_const(records));
            start.covariance = covariance(pelorus::as_const(records));
            start.out = motion_record(records);
            tolerate(motion_.call(&plr_motion::init_record, block, start));
        }
        return for_good_items(block, items, [](std::int64_t) {});
    });
}

/// Cartesian moments of one item: what is given, and priors for the rest.
void Kalman::start_item(const plr_estimator_init& args, std::int64_t item, double* x, double* p) const {
    const std::int64_t known = args.known;
    std::fill_n(p, c_ * c_, 0.0);
    for (int k = 0; k < cartesian_.size(); ++k) {
        x[k] = cartesian_[k].prior_mean;
        p[k * c_ + k] = cartesian_[k].prior_deviation * cartesian_[k].prior_deviation;
    }
    const double* const given = at(args.mean, item);
    const double* const spread = at(args.covariance, item);
    for (std::int64_t a = 0; a < known; ++a) {
        x[args.components[a]] = given[a];
        for (std::int64_t b = 0; b < known; ++b)
            p[args.components[b] * c_ + args.components[a]] = 0.5 * (spread[b * known + a] + spread[a * known + b]);
    }
    if (!all_finite(x, c_) || !all_finite(p, c_ * c_))
        throw pelorus::NumericError("the mean or covariance to start from is not finite");
}

/// Moments of the state from Cartesian ones. A component of the state that no Cartesian one tells of (a turn rate, say) enters
/// with its prior deviation.
void Kalman::from_cartesian(const plr_call& call, const plr_const_view& means, const plr_const_view& covariances,
                            const plr_view& records, double* jacobian) const {
    auto convert = pelorus::arguments<plr_motion_convert>();
    convert.in = means;
    convert.out = mean(records);
    convert.jacobian = pelorus::view(jacobian, n_, c_, records.count);
    tolerate(motion_.call(&plr_motion::from_cartesian, call, convert));
    tolerate(for_good_items(call, records.count, [&](std::int64_t i) {
        using Convert = small::Bounded<max_state, max_state>;
        const Eigen::Map<const Convert> j(at(convert.jacobian, i), n_, c_);
        Eigen::Map<Convert> p(at(covariance(records), i), n_, n_);
        small::symmetric_product(j, Eigen::Map<const Convert>(at(covariances, i), c_, c_), p);
        for (int r = 0; r < state_.size(); ++r) {
            bool told = false;
            for (std::int64_t k = 0; k < c_; ++k) told = told || j.data()[k * n_ + r] != 0.0;
            if (!told) p.data()[r * n_ + r] = state_[r].prior_deviation * state_[r].prior_deviation;
        }
        if (!small::all_finite(p)) throw pelorus::NumericError(text(Outcome::not_finite));
    }));
}

plr_status Kalman::summary(const plr_call& call, const plr_estimator_moments& args) const {
    if (state_is_cartesian_) return moments(call, args);
    const std::int64_t count = args.mean.count;
    const bool wanted = args.covariance.data != nullptr;
    expect_packed(args.record, info.record_size, 1, count, "record");
    expect_packed(args.mean, c_, 1, count, "mean");
    if (wanted) expect_packed(args.covariance, c_, c_, count, "covariance");
    const Scratch scratch(call, block_size * c_ * n_);
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = pelorus::slice(args.record, first, items);
        auto convert = pelorus::arguments<plr_motion_convert>();
        convert.in = mean(records);
        convert.out = pelorus::slice(args.mean, first, items);
        if (wanted) convert.jacobian = pelorus::view(scratch.data(), c_, n_, items);
        tolerate(motion_.call(&plr_motion::to_cartesian, block, convert));
        return for_good_items(block, items, [&](std::int64_t i) {
            if (!wanted) return;
            using Convert = small::Bounded<max_state, max_state>;
            Eigen::Map<Convert> out(at(args.covariance, first + i), c_, c_);
            small::symmetric_product(Eigen::Map<const Convert>(at(convert.jacobian, i), c_, n_),
                                     Eigen::Map<const Convert>(at(covariance(records), i), n_, n_), out);
            if (!small::all_finite(out)) throw pelorus::NumericError(text(Outcome::not_finite));
        });
    });
}

plr_status Kalman::moments(const plr_call& call, const plr_estimator_moments& args) const {
    const std::int64_t count = args.mean.count;
    expect_packed(args.record, info.record_size, 1, count, "record");
    expect_packed(args.mean, n_, 1, count, "mean");
    if (args.covariance.data != nullptr) expect_packed(args.covariance, n_, n_, count, "covariance");
    return pelorus::for_items(call, count, [&](std::int64_t i) {
        const Moments from = moments_of(at(args.record, i));
        std::copy_n(from.mean, n_, at(args.mean, i));
        bool is_finite = small::all_finite(Eigen::Map<const Eigen::VectorXd>(from.mean, n_));
        if (args.covariance.data != nullptr) {
            std::copy_n(from.covariance, n_ * n_, at(args.covariance, i));
            is_finite = is_finite && small::all_finite(Eigen::Map<const Eigen::VectorXd>(from.covariance, n_ * n_));
        }
        if (!is_finite) throw pelorus::NumericError(text(Outcome::not_finite));
    });
}

plr_status Kalman::assign(const plr_call& call, const plr_estimator_assign& args) const {
    const std::int64_t count = args.out.count;
    expect_packed(args.record, info.record_size, 1, count, "record");
    expect_packed(args.mean, n_, 1, count, "mean");
    expect_packed(args.covariance, n_, n_, count, "covariance");
    expect_packed(args.out, info.record_size, 1, count, "out");
    return pelorus::for_items(call, count, [&](std::int64_t i) {
        StateMatrix<Eigen::Dynamic> p = Eigen::Map<const StateMatrix<Eigen::Dynamic>>(at(args.covariance, i), n_, n_);
        const StateVector<Eigen::Dynamic> x = Eigen::Map<const StateVector<Eigen::Dynamic>>(at(args.mean, i), n_, 1);
        small::symmetrise(p);
        if (store(x, p, moments_of(at(args.out, i))) != Outcome::done)
            throw pelorus::NumericError("the mean or covariance to assign is not finite");
        std::copy_n(at(args.record, i) + n_ + n_ * n_, motion_record_, at(args.out, i) + n_ + n_ * n_);
    });
}

const void* Kalman::extension(const char* id) const noexcept {
    static constexpr plr_estimator_mix mix_table{
        sizeof(plr_estimator_mix), 0, &pelorus::detail::forward<Kalman, plr_estimator_mix_args, &Kalman::mix>};
    return std::strcmp(id, PLR_ESTIMATOR_MIX) == 0 ? &mix_table : nullptr;
}

}  // namespace kalman

PELORUS_PLUGIN(kalman::Kalman, "estimator.kalman");
