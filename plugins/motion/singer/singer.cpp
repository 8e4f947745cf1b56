// motion.singer: flight under accelerations that last for a while and fade. See README.md.
#include "../../common/axis_models/singer.hpp"

#include <optional>

#include <pelorus/axis_motion.hpp>

namespace {

using namespace singer;

enum class Form { exact, truncated };

struct Parameters {
    int dimension = 3;
    Form form = Form::exact;
    double rate = 0.0;              // 1/s
    std::vector<double> deviation;  // m/s2
    double prior_position = 0.0, prior_velocity = 0.0;
    std::optional<double> prior_acceleration;
};

template <int D, Form form_> struct Model : pelorus::AxisMotion<Model<D, form_>, 3, D>, Parameters {
    static constexpr bool rank_one = form_ == Form::truncated;
    static constexpr std::uint32_t flags =
        PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE |
        (rank_one ? 0u : PLR_MOTION_TIME_INVARIANT | PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD);

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) {
        this->intensity = pelorus::per_axis<D>("acceleration", deviation).cwiseAbs2();
        if (!prior_acceleration) prior_acceleration = std::sqrt(this->intensity.maxCoeff());
        if (!(*prior_acceleration > 0.0))
            throw pelorus::ParameterError("prior_acceleration", "is needed where acceleration is 0");
    }

    Matrix<3> transition(double dt) const {
        return rank_one ? truncated_transition(rate, dt) : exact_transition(rate, dt);
    }
    Vector<3> unit_factor(double dt) const { return truncated_factor(dt); }
    Matrix<3> unit_noise(double dt) const {
        if constexpr (!rank_one) return exact_noise(rate, dt);
        const Vector<3> g = truncated_factor(dt);
        return g * g.transpose();
    }
    std::vector<double> priors() const { return {prior_position, prior_velocity, *prior_acceleration}; }
};

template <int D, Form form_> void Model<D, form_>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Singer manoeuvre model")
        .purpose(
            "Motion whose acceleration is a first-order Markov process: manoeuvres begin at any time and fade with a "
            "time constant of 1/maneuver_rate, on one to three axes alike.")
        .equation(
            "x = (p, v, a), r = maneuver_rate, s = acceleration. exact: F = [1 T (rT - 1 + e^-rT)/r^2; 0 1 (1 - "
            "e^-rT)/r; 0 0 e^-rT], Q = 2 r s^2 times the integral over the step of F(t) e e' F(t)', e = (0, 0, 1). "
            "truncated: F = [1 T T^2/2; 0 1 T; 0 0 e^-rT], Q = s^2 g g', g = [T^2/2; T; 1]")
        .source(
            "R. A. Singer, Estimating optimal tracking filter performance for manned maneuvering targets, IEEE "
            "Transactions on Aerospace and Electronic Systems AES-6(4), 473-483, 1970");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(1).max(3).doc("number of axes: x, y, z");
    plugin.parameter("form", &Parameters::form)
        .initially("exact")
        .choices({{"exact", "the process itself, sampled: steps of any length agree with each other"},
                  {"truncated",
                   "position and velocity as for a constant acceleration, which then fades; forward in time only"}})
        .doc("how the process is brought to discrete time");
    plugin.parameter("maneuver_rate", &Parameters::rate)
        .unit("1/s")
        .initially("0.1 1/s")
        .above(0.0)
        .doc("reciprocal of the manoeuvres' time constant");
    plugin.parameter("acceleration", &Parameters::deviation)
        .unit("m/s2")
        .initially("1 m/s2")
        .min(0.0)
        .rows(1, 3)
        .doc(
            "stationary deviation of the acceleration (truncated: of its increment in a step), one value or one an "
            "axis");
    pelorus::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity);
    plugin.parameter("prior_acceleration", &Parameters::prior_acceleration)
        .unit("m/s2")
        .above(0.0)
        .doc(
            "deviation of an acceleration component that nothing is known of, about 0; the largest acceleration if "
            "absent");
}

template <int D> using Exact = Model<D, Form::exact>;
template <int D> using Truncated = Model<D, Form::truncated>;

/// Chooses the class by form and dimension.
struct Singer : pelorus::ByDimension<Exact> {
    static plr_instance create(const pelorus::Setup& setup) {
        Exact<3> chosen;
        pelorus::Describe<Exact<3>>::of().bind(chosen, setup.raw());
        return chosen.form == Form::exact ? pelorus::ByDimension<Exact>::create(setup)
                                          : pelorus::ByDimension<Truncated>::create(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(Singer, "motion.singer");
