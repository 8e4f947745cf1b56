// What the filter is made from, and the calls around its step.
#include "schmidt.hpp"

#include <cmath>
#include <cstring>

#include <pelorus/small_matrix.hpp>

namespace schmidt {

using pelorus::NumericError;
using pelorus::ParameterError;
namespace small = pelorus::small;

void Schmidt::describe(pelorus::Describe<Schmidt>& plugin) {
    plugin.title("Consider filter (Schmidt-Kalman)")
        .purpose(
            "A Kalman filter that reckons with constants of its sensors which it knows only roughly and does not "
            "estimate: a bias, the place of a platform. Its covariance and its gain hold their share of the errors, so "
            "that it does not grow sure of what it cannot see. Where the motion or a sensor is not linear, it is "
            "linearised at the newest estimate.")
        .equation(
            "predict: x = f(x), P = F P F' + Q, C = F C. update: S = H P H' + H C N' + N C' H' + N B N' + R, K = (P H' "
            "+ C N') S^-1, x = x + K (z - h(x)), [P C; C' B] by Joseph's form, C = C - K (H C + N B)")
        .source(
            "S. F. Schmidt, Application of state-space methods to navigation problems, Advances in Control Systems 3, "
            "293-340, 1966; G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, Academic Press "
            "1977, chapter VIII (effects of parameters that are not modelled); R. S. Bucy, P. D. Joseph, Filtering for "
            "Stochastic Processes with Applications to Guidance, Wiley 1968 (the form of the update)");
    plugin.slot("motion", "motion", 1, 1, "how the state evolves");
    plugin.slot("sensors", "sensor", 1, -1, "what measures it; a scan meets its sensor by name");
    auto rows = plugin.table("consider", &Schmidt::consider);
    rows.initially("[]")
        .rows(0, max_considered)
        .doc(
            "the inputs of sensors that are uncertain constants, 12 elements at most; none: the extended Kalman "
            "filter");
    rows.column("input", &Row::input).doc("an input of a sensor, as seen from this filter: sensors.radar.bias");
    rows.column("element", &Row::element).min(0).doc("which element of it, counted from 0; all of them if absent");
    rows.column("deviation", &Row::deviation)
        .min(0)
        .doc("standard deviation of its error, in the SI unit of the input");
}

void Schmidt::setup(const pelorus::Setup& setup) {
    setup_filter(setup, gaussian::Form::covariance, info);
    setup_factors();
    read_inputs(setup.raw());
    for (std::size_t row = 0; row < consider.size(); ++row) add_considered(setup.raw(), row);
    q_ = static_cast<std::int64_t>(considered_.size());
    cross_at_ = record_size_;
    record_size_ += n_ * q_;
    info.record_size = record_size_;
    info.record_version = plr_mix_version(3, motion_.info().record_version);
    std::int64_t doubles = linear_doubles();
    for (const SensorInSlot& sensor : sensors_)
        doubles = std::max(doubles, 2 * sensor.m + look_doubles(sensor) + inputs_doubles());
    info.scratch_bytes = scratch_for(doubles);
}

/// The defaults of the inputs of this tree, which count where a call brings none.
void Schmidt::read_inputs(const plr_config& config) {
    input_size_ = config.input_size;
    defaults_.assign(static_cast<std::size_t>(input_size_), 0.0);
    const char* at = reinterpret_cast<const char*>(config.inputs);
    for (std::uint32_t i = 0; i < config.input_count; ++i) {
        const auto& place = *reinterpret_cast<const plr_input_place*>(at);
        std::copy_n(place.defaults, place.size, defaults_.begin() + place.offset);
        at += place.struct_size;
    }
}

/// The sensor whose input it is.
std::size_t Schmidt::sensor_of(const std::string& input, const std::string& where) const {
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
        const std::string name = sensors_[s].part.name(), prefix = name.empty() ? "sensors." : "sensors." + name + ".";
        if (input.compare(0, prefix.size(), prefix) == 0) return s;
    }
    throw ParameterError("consider", where + input + " is not a sensor's; only inputs of sensors can be considered");
}

void Schmidt::add_considered(const plr_config& config, std::size_t row) {
    const Row& wanted = consider[row];
    const std::string where = "row " + std::to_string(row + 1) + ": ";
    std::string known;
    const char* at = reinterpret_cast<const char*>(config.inputs);
    for (std::uint32_t i = 0; i < config.input_count; ++i) {
        const auto& place = *reinterpret_cast<const plr_input_place*>(at);
        at += place.struct_size;
        known += (known.empty() ? "" : ", ") + std::string(place.name);
        if (wanted.input != place.name) continue;
        const auto size = static_cast<int>(place.size);
        if (wanted.element && *wanted.element >= size)
            throw ParameterError("consider", where + "element is " + std::to_string(*wanted.element) +
                                                 ", expected 0 to " + std::to_string(size - 1) + " of " + wanted.input);
        const std::size_t sensor = sensor_of(wanted.input, where);
        const int first = wanted.element.value_or(0), end = wanted.element ? first + 1 : size;
        for (int e = first; e < end; ++e) {
            for (const Considered& other : considered_) {
                if (other.offset == place.offset + e)
                    throw ParameterError("consider", where + "element " + std::to_string(e) + " of " + wanted.input +
                                                         " has been named before");
            }
            considered_.push_back({sensor, place.offset + e, wanted.deviation});
        }
        if (considered_.size() > max_considered)
            throw ParameterError("consider", where + "more than " + std::to_string(max_considered) + " elements");
        return;
    }
    throw ParameterError("consider", where + "no input " + wanted.input +
                                         (known.empty() ? ", none of the parts has inputs" : "; there are " + known));
}

const void* Schmidt::extension(const char* id) const noexcept {
    return std::strcmp(id, PLR_ESTIMATOR_MIX) == 0 ? gaussian::mix_table<Schmidt>() : nullptr;
}

/// A start knows nothing of the considered parameters.
plr_status Schmidt::init(const plr_call& call, const plr_estimator_init& args) const {
    const plr_status started = Filter::init(call, args);
    if (started < 0) return started;
    for (std::int64_t i = 0; i < args.record.count; ++i) std::fill_n(cross(at(args.record, i)), n_ * q_, 0.0);
    return started;
}

/// The cross-covariance stays what it was, but shrinks where the new covariance leaves less room: P - X X' is not negative
/// where no eigenvalue of (L^-1 X)' (L^-1 X) is above 1, P = L L'.
plr_status Schmidt::assign(const plr_call& call, const plr_estimator_assign& args) const {
    using Square = small::Bounded<gaussian::max_state, gaussian::max_state>;
    using Cross = small::Bounded<gaussian::max_state, max_considered>;
    using Considereds = small::Bounded<max_considered, max_considered>;
    using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_considered, 1>;
    const plr_status assigned = Filter::assign(call, args);
    if (assigned < 0 || q_ == 0) return assigned;
    const plr_status followed = for_good_items(call, args.out.count, [&](std::int64_t i) {
        double* const x = cross(at(args.out, i));
        std::copy_n(cross(at(args.record, i)), n_ * q_, x);
        if (!all_finite(x, n_ * q_)) gaussian::require(gaussian::Outcome::not_finite);
        Square factor(n_, n_);
        if (!small::cholesky_semidefinite(Eigen::Map<const Square>(at(args.out, i) + n_, n_, n_), factor))
            gaussian::require(gaussian::Outcome::covariance_indefinite);
        for (std::int64_t r = 0; r < n_; ++r) {  // what is known exactly depends on nothing
            if (factor.data()[r * n_ + r] > 0.0) continue;
            factor.data()[r * n_ + r] = 1.0;
            for (std::int64_t k = 0; k < q_; ++k) x[k * n_ + r] = 0.0;
        }
        Cross white = Eigen::Map<const Cross>(x, n_, q_);
        small::solve_lower(factor, white);
        Cross transposed(q_, n_);
        for (std::int64_t k = 0; k < q_; ++k) {
            for (std::int64_t r = 0; r < n_; ++r) transposed.data()[r * q_ + k] = white.data()[k * n_ + r];
        }
        Considereds share(q_, q_), vectors(q_, q_);
        Values values(q_, 1);
        small::gram(transposed, share);
        if (!small::symmetric_eigen(share, values, vectors)) gaussian::require(gaussian::Outcome::not_finite);
        const double most = values.data()[q_ - 1];
        for (std::int64_t e = 0; most > 1.0 && e < n_ * q_; ++e) x[e] /= std::sqrt(most);
    });
    return followed == PLR_OK ? assigned : followed;
}

/// The parameters are the same in all hypotheses, so that the cross-covariance of the mixture is the mean of theirs.
plr_status Schmidt::mix(const plr_call& call, const plr_estimator_mix_args& args) const {
    const plr_status mixed = Filter::mix(call, args);
    if (mixed < 0) return mixed;
    const plr_status followed = for_good_items(call, args.out.count, [&](std::int64_t i) {
        double* const x = cross(at(args.out, i));
        std::fill_n(x, n_ * q_, 0.0);
        for (std::int64_t k = 0; k < args.weights.rows; ++k) {
            const double weight = at(args.weights, i)[k];
            const double* const from = cross(at(args.records, i) + k * record_size_);
            for (std::int64_t e = 0; e < n_ * q_; ++e) x[e] += weight * from[e];
        }
        if (!all_finite(x, n_ * q_)) gaussian::require(gaussian::Outcome::not_finite);
    });
    return followed == PLR_OK ? mixed : followed;
}

}  // namespace schmidt

PELORUS_PLUGIN(schmidt::Schmidt, "estimator.schmidt");
