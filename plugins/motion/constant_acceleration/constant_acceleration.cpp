// motion.constant_acceleration: flight at an acceleration that white jerk disturbs. See README.md.
#include "../../common/axis_models/constant_acceleration.hpp"
#include "../../common/axis_models/acceleration_model.hpp"

#include <optional>

#include <pelorus/axis_motion.hpp>

namespace {

using namespace constant_acceleration;

enum class Form { continuous, discrete };

struct Parameters {
    int dimension = 3;
    Form form = Form::continuous;
    std::optional<std::vector<double>> density;    // m2/s5
    std::optional<std::vector<double>> deviation;  // m/s2
    double prior_position = 0.0, prior_velocity = 0.0, prior_acceleration = 0.0;
};

template <int D, Form form_> struct Model : pelorus::AxisMotion<Model<D, form_>, 3, D>, Parameters {
    static constexpr bool rank_one = form_ == Form::discrete;
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_BACKWARD |
                                           (rank_one ? 0u : std::uint32_t{PLR_MOTION_EXACT_NOISE});

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) {
        const auto& unused = rank_one ? density : deviation;
        if (unused)
            throw pelorus::ParameterError(rank_one ? "noise" : "acceleration",
                                          rank_one ? "belongs to form: continuous; form: discrete takes acceleration"
                                                   : "belongs to form: discrete; form: continuous takes noise");
        if (rank_one)
            this->intensity =
                pelorus::per_axis<D>("acceleration", deviation.value_or(std::vector<double>{1.0})).cwiseAbs2();
        else
            this->intensity = pelorus::per_axis<D>("noise", density.value_or(std::vector<double>{1.0}));
    }

    Matrix<3> transition(double dt) const { return constant_acceleration::transition(dt); }
    Vector<3> unit_factor(double dt) const { return discrete_factor(dt); }
    Matrix<3> unit_noise(double dt) const {
        if constexpr (!rank_one) return continuous_noise(dt);
        const Vector<3> g = discrete_factor(dt);
        return g * g.transpose();
    }
    std::vector<double> priors() const { return {prior_position, prior_velocity, prior_acceleration}; }
};

template <int D, Form form_> void Model<D, form_>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Nearly constant acceleration")
        .purpose(
            "Motion whose acceleration is disturbed by white jerk (a Wiener process), on one to three axes alike. For "
            "targets that manoeuvre for longer than the time between measurements.")
        .equation(
            "x = (p, v, a); F = [1 T T^2/2; 0 1 T; 0 0 1] on each axis. continuous: Q = q [T^5/20 T^4/8 T^3/6; T^4/8 "
            "T^3/3 T^2/2; T^3/6 T^2/2 T]. discrete: Q = s^2 g g', g = [T^2/2; T; 1]. dt < 0: F(dt) Q(-dt) F(dt)'")
        .source(
            "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley "
            "2001, 6.2.3 and 6.3.3");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(1).max(3).doc("number of axes: x, y, z");
    plugin.parameter("form", &Parameters::form)
        .initially("continuous")
        .choices({{"continuous", "white jerk; takes noise, and steps of any length agree with each other"},
                  {"discrete", "an increment of the acceleration at the start of each step; takes acceleration"}})
        .doc("how the change of the acceleration is modelled");
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s5")
        .min(0.0)
        .rows(1, 3)
        .doc("spectral density of the jerk, one value or one an axis; form continuous only, there 1 m2/s5 if absent");
    plugin.parameter("acceleration", &Parameters::deviation)
        .unit("m/s2")
        .min(0.0)
        .rows(1, 3)
        .doc(
            "deviation of the increment of the acceleration in a step, one value or one an axis; form discrete only, "
            "there 1 m/s2 if absent");
    axis_models::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity,
                                 &Parameters::prior_acceleration);
}

template <int D> using Continuous = Model<D, Form::continuous>;
template <int D> using Discrete = Model<D, Form::discrete>;

/// Chooses the class by form and dimension.
struct ConstantAcceleration : pelorus::ByDimension<Continuous> {
    static plr_instance create(const pelorus::Setup& setup) {
        Continuous<3> chosen;
        pelorus::Describe<Continuous<3>>::of().bind(chosen, setup.raw());
        return chosen.form == Form::continuous ? pelorus::ByDimension<Continuous>::create(setup)
                                               : pelorus::ByDimension<Discrete>::create(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(ConstantAcceleration, "motion.constant_acceleration");
