// motion.constant_jerk: flight at a jerk that white noise disturbs. See README.md.
#include "../../common/axis_models/acceleration_model.hpp"
#include "constant_jerk_model.hpp"

#include <optional>

#include <pelorus/axis_motion.hpp>

namespace {

using namespace constant_jerk;

enum class Form { continuous, discrete };

struct Parameters {
    int dimension = 3;
    Form form = Form::continuous;
    std::optional<std::vector<double>> density;    // m2/s7
    std::optional<std::vector<double>> deviation;  // m/s3
    double prior_position = 0.0, prior_velocity = 0.0, prior_acceleration = 0.0, prior_jerk = 0.0;
};

template <int D, Form form_> struct Model : pelorus::AxisMotion<Model<D, form_>, 4, D>, Parameters {
    static constexpr bool rank_one = form_ == Form::discrete;
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_BACKWARD |
                                           (rank_one ? 0u : std::uint32_t{PLR_MOTION_EXACT_NOISE});

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) {
        if (rank_one && density)
            throw pelorus::ParameterError("noise", "belongs to form: continuous; form: discrete takes jerk");
        if (!rank_one && deviation)
            throw pelorus::ParameterError("jerk", "belongs to form: discrete; form: continuous takes noise");
        const std::vector<double> one{1.0};
        if (rank_one)
            this->intensity = pelorus::per_axis<D>("jerk", deviation.value_or(one)).cwiseAbs2();
        else
            this->intensity = pelorus::per_axis<D>("noise", density.value_or(one));
    }

    Matrix<4> transition(double dt) const { return constant_jerk::transition(dt); }
    Vector<4> unit_factor(double dt) const { return discrete_factor(dt); }
    Matrix<4> unit_noise(double dt) const {
        if constexpr (!rank_one) return continuous_noise(dt);
        const Vector<4> g = discrete_factor(dt);
        return g * g.transpose();
    }
    std::vector<double> priors() const { return {prior_position, prior_velocity, prior_acceleration, prior_jerk}; }
};

template <int D, Form form_> void Model<D, form_>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Nearly constant jerk")
        .purpose(
            "Motion whose jerk is a Wiener process, on one to three axes alike. For targets whose acceleration changes "
            "steadily over many measurements; it follows noise where these are few.")
        .equation(
            "x = (p, v, a, j); F = [1 T T^2/2 T^3/6; 0 1 T T^2/2; 0 0 1 T; 0 0 0 1] on each axis. continuous: Q = q "
            "times the integral over the step of f(t) f(t)', f the last column of F. discrete: Q = s^2 g g', g = "
            "[T^3/6; "
            "T^2/2; T; 1]. dt < 0: F(dt) Q(-dt) F(dt)'")
        .source(
            "K. Mehrotra, P. R. Mahapatra, A jerk model for tracking highly maneuvering targets, IEEE Transactions on "
            "Aerospace and Electronic Systems 33(4), 1094-1105, 1997, with a jerk that does not fade");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(1).max(3).doc("number of axes: x, y, z");
    plugin.parameter("form", &Parameters::form)
        .initially("continuous")
        .choices({{"continuous", "white noise drives the jerk; takes noise, and steps of any length agree"},
                  {"discrete", "an increment of the jerk at the start of each step; takes jerk"}})
        .doc("how the change of the jerk is modelled");
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s7")
        .min(0.0)
        .rows(1, 3)
        .doc(
            "spectral density of the jerk's change, one value or one an axis; form continuous only, there 1 m2/s7 if "
            "absent");
    plugin.parameter("jerk", &Parameters::deviation)
        .unit("m/s3")
        .min(0.0)
        .rows(1, 3)
        .doc(
            "deviation of the jerk's increment in a step, one value or one an axis; form discrete only, there 1 m/s3 "
            "if absent");
    axis_models::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity,
                                 &Parameters::prior_acceleration);
    plugin.parameter("prior_jerk", &Parameters::prior_jerk)
        .unit("m/s3")
        .initially("1 m/s3")
        .above(0.0)
        .doc("deviation of a jerk component that nothing is known of, about 0");
}

template <int D> using Continuous = Model<D, Form::continuous>;
template <int D> using Discrete = Model<D, Form::discrete>;

/// Chooses the class by form and dimension.
struct ConstantJerk : pelorus::ByDimension<Continuous> {
    static plr_instance create(const pelorus::Setup& setup) {
        Continuous<3> chosen;
        pelorus::Describe<Continuous<3>>::of().bind(chosen, setup.raw());
        return chosen.form == Form::continuous ? pelorus::ByDimension<Continuous>::create(setup)
                                               : pelorus::ByDimension<Discrete>::create(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(ConstantJerk, "motion.constant_jerk");
